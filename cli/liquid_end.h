// One end of a liquid morph: a mesh, the blobs fitted to it, and where they stand in the scene.
#pragma once

#include <optional>
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
  double weld = 0;  ///< as in MeshOptions
  Mesh mesh;        ///< in its coordinates, as the fit
  BlobCloud fit;
  Placement placement; ///< `up` is given, the rest is found by place_together
};

/// Brings both ends to one volume (as far as their sizes stay within a factor of 1.5), the larger one 3 units across, centred above the
/// origin, standing on y = 0. Meshes are measured as they are, not their fits. The second one is turned about the vertical by `turn`
/// degrees or, where that is not said, so that both lie in one another best, if that is much better than as it stands.
void place_together(LiquidEnd& from, LiquidEnd& to, std::optional<double> turn);

} // namespace kelpie
