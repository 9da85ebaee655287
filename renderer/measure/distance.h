// How far two surfaces are from each other.
#pragma once

#include "field/mesh/triangle_tree.h"

namespace kelpie {

/// A mesh that is asked for distances, many times.
struct MeasuredMesh {
  explicit MeasuredMesh(Mesh m) : mesh(std::move(m)), tree(mesh) {}

  Mesh mesh;
  TriangleTree tree;
};

/// Scene units.
struct SurfaceDistance {
  double rms = 0;
  double largest = 0; ///< the Hausdorff distance
};

/// From vertices of each, some thousand of them, to the other's triangles: both ways, which weigh the same. Neither may be empty. Runs in
/// the current TBB arena.
SurfaceDistance distance_between(const MeasuredMesh&, const MeasuredMesh&);

} // namespace kelpie
