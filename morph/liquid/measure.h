// How far a sum of blobs is from the mesh it stands for.
#pragma once

#include <vector>

#include "field/mesh/triangle_tree.h"
#include "morph/liquid/ellipsoid.h"
#include "morph/liquid/surface_samples.h"

namespace kelpie {

/// Distances from random points of the mesh to {f = 1}, in units of the mesh (of diagonal 1).
struct FitErrors {
  double rms = 0, max = 0;
  double normals = 0; ///< degrees, rms: between the field's normal and the mesh's smooth one, where it has one
  double lost = 0;    ///< share of points without a surface within 0.05
  double spurs = 0;   ///< share of points 0.02 outside the mesh (where nothing of it is near) with f > 1
};

/// The distance of a point is the nearer of the first crossings on two lines, along the mesh's normal and along the field's
/// gradient: an upper bound of the true one. (The normal alone misses a rounded rim that passes close by.) If there is none within 0.05,
/// it is the way to the nearest crossing that belongs to another point; 1 where no point has any.
/// `tree` is that of the mesh.
FitErrors measure_fit(const std::vector<Ellipsoid>& blobs, const Mesh& unit, const TriangleTree& tree, uint64_t seed);

} // namespace kelpie
