// A mesh as the level surface of a sum of blobs.
#pragma once

#include <functional>
#include <string>

#include "field/mesh/mesh.h"
#include "field/potential/blob.h"

namespace kelpie {

/// `round`: balls, as Jin et al. 2005 have them; `free`: ellipsoids, whose normals are smooth.
enum class FitShape { round, free };

/// Larger fits are refused.
inline constexpr size_t k_most_fitted_blobs = 20'000;

struct FitOptions {
  size_t blobs = 500;
  bool may_use_fewer = true; ///< where fewer are as good: every blob costs time in each frame
  double weld = 0;           ///< of a mesh file: as in MeshOptions
  FitShape shape = FitShape::free;
  /// Goals: the rms distance, as a share of the diagonal and as a length, and the rms angle of the normals in degrees; 0: none. With any of
  /// them a fit takes as many blobs as it needs, up to `blobs`.
  double error_share = 0, error_length = 0, normals = 0;
  /// Called with the share of the work that is done, from 0 to 1, now and then.
  std::function<void(double)> progress = [](double) {};

  bool has_goal() const { return error_share > 0 || error_length > 0 || normals > 0; }
};

/// What came of it. Distances are fractions of the mesh's bounding-box diagonal, measured (measure.h) from points of
/// the mesh that took no part in the fit.
struct FitResult {
  BlobCloud blobs;          ///< in the file's coordinates (the mesh's origin added)
  double sphere_tree_s = 0; ///< CPU seconds for samples and, of round blobs, the sphere tree
  double fit_s = 0;         ///< for fitting
  double rms = 0;           ///< root mean square distance
  double max = 0;           ///< the largest
  double normals = 0;       ///< root mean square angle between the normals and the mesh's smooth ones, in degrees
  double lost = 0;          ///< share of points that have no surface within 5 % of the diagonal
  double spurs = 0;         ///< share of points 2 % of the diagonal outside the mesh (where there is room) that are inside the field
  bool is_cached = false;   ///< taken from the cache; the seconds are those of the run that made it
};

/// Fits about `blobs` blobs, on one thread: the sums of several would come in any order. Round ones: sphere tree, then least squares over
/// centres, radii and weights (methods.md section 1, steps 1 and 2). Ellipsoids: Gaussians of what lies below the surface, then least
/// squares over places, shapes and weights. Throws Error, bad_data, where the mesh encloses nothing, is too thin for so many blobs (no
/// surface near some of it), or a goal is out of reach. `name` is for messages.
FitResult fit_blobs(const Mesh&, const FitOptions&, const std::string& name);

} // namespace kelpie
