// A mesh as the level surface of a sum of blobs.
#pragma once

#include <functional>
#include <string>

#include "field/mesh/mesh.h"
#include "field/potential/blob.h"

namespace kelpie {

struct FitOptions {
  size_t blobs = 500;
  bool may_use_fewer = true; ///< where fewer are as good: every blob costs time in each frame
  double weld = 0;           ///< of a mesh file: as in MeshOptions
  /// Called with the share of the work that is done, from 0 to 1, now and then.
  std::function<void(double)> progress = [](double) {};
};

/// What came of it. Distances are fractions of the mesh's bounding-box diagonal, measured (measure.h) from points of
/// the mesh that took no part in the fit.
struct FitResult {
  BlobCloud blobs;          ///< in the file's coordinates (the mesh's origin added)
  double sphere_tree_s = 0; ///< CPU seconds for samples and sphere tree
  double fit_s = 0;         ///< for fitting
  double rms = 0;           ///< root mean square distance
  double max = 0;           ///< the largest
  double lost = 0;          ///< share of points that have no surface within 5 % of the diagonal (they count as 5 %)
  double spurs = 0;         ///< share of points 2 % of the diagonal outside the mesh (where there is room) that are inside the field
  bool is_cached = false;   ///< taken from the cache; the seconds are those of the run that made it
};

/// Fits about `blobs` blobs: sphere tree, then least squares over centres, radii and weights (methods.md section
/// 1, steps 1 and 2), on one thread: the sums of several would come in any order. Throws Error, bad_data, where the mesh encloses nothing,
/// or is too thin for so many blobs (no surface near most of it). `name` is for messages.
FitResult fit_blobs(const Mesh&, const FitOptions&, const std::string& name);

} // namespace kelpie
