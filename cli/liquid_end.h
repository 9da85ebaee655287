// An end of a passage of a liquid: a mesh, the blobs fitted to it, and where they stand in the scene.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "base/affine.h"
#include "base/box.h"
#include "field/mesh/mesh.h"
#include "field/potential/blob.h"

namespace kelpie {

/// The directions that may be up in a mesh.
inline constexpr const char* k_up_axes[] = {"+x", "-x", "+y", "-y", "+z", "-z"};

/// How a mesh is brought into the scene: turned so that what is up in it is +y, turned about the vertical, then moved and scaled.
struct Placement {
  std::string up = "+y"; ///< one of k_up_axes
  double turn = 0;       ///< degrees about +y, counter-clockwise seen from above
  Vec3d foot{0};         ///< what comes to stand in the origin, turned
  double scale = 1;

  glm::dmat3 turning() const;
  Affine map() const { return {scale * turning(), -scale * foot}; }
  BlobCloud placed(BlobCloud) const;
  /// `field`, a field of a scene file that lives in the mesh's coordinates, in its place.
  std::string placed_text(std::string field) const;
};

struct LiquidEnd {
  std::string path; ///< of the mesh's file
  std::string name; ///< for names of files
  double weld = 0;  ///< as in MeshOptions
  Mesh mesh;        ///< in its coordinates, as the fit
  BlobCloud fit;
  Placement placement; ///< `up` is given, the rest is found by place_together
};

/// Brings all ends to the volume of the first (as far as their sizes stay within a factor of 1.5 of its own), the largest one 3 units
/// across, centred above the origin, standing on y = 0. Meshes are measured as they are, not their fits. All but the first are turned about
/// the vertical by `turn` degrees or, where that is not said, each so that it lies best in the one before it, if that is much better than
/// as it stands.
void place_together(std::span<LiquidEnd> ends, std::optional<double> turn);

} // namespace kelpie
