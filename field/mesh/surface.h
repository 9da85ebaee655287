// Triangle meshes as they are looked at: set dressing, whose inside nobody asks for.
#pragma once

#include <compare>

#include "field/mesh/mesh.h"

namespace kelpie {

/// A mesh with normals, ready to be placed and traced.
struct SurfaceMesh {
  std::vector<Vec3d> positions; ///< relative to `origin`, in file units
  std::vector<Triangle> triangles;
  /// Unit normals of the corners of each triangle: mean normals of the triangles around the vertex, weighted by
  /// their angles there, as far as they are smooth with this one. Seen from outside where the file says so (corners
  /// counter-clockwise).
  std::vector<std::array<Vec3, 3>> normals;
  Vec3d origin{0};
};

/// How a mesh is made ready.
struct SurfaceOptions {
  double crease = 30; ///< degrees: triangles that meet at more keep an edge between them
  double weld = 0;    ///< as in MeshOptions
  auto operator<=>(const SurfaceOptions&) const = default;
};

/// Reads OBJ, PLY, OFF or STL, as load_mesh does; but holes stay open and nothing is turned. Vertices at the same place
/// are one, and those of seams (weld.h); triangles without an area are left out. (Normals of the file are not used: two of the formats
/// have none, and many files wrong ones.)
/// Throws Error: missing_input, or bad_data with the position in the file.
SurfaceMesh load_surface_mesh(const std::string& path, const SurfaceOptions&, Diagnostics&);

/// The same for faces at hand; `file` names them in messages.
SurfaceMesh make_surface_mesh(std::vector<Vec3d> positions, std::vector<Triangle> triangles, const SurfaceOptions&, const std::string& file,
                              Diagnostics&);

} // namespace kelpie
