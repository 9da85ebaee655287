// Triangle meshes: what users bring in.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/box.h"
#include "base/error.h"

namespace kelpie {

using Triangle = std::array<uint32_t, 3>;

/// Triangles seen counter-clockwise from outside. Positions are relative to `origin`, so that a mesh far
/// from the file's origin keeps its shape in float: file position = origin + position, in file units.
struct Mesh {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  Vec3d origin{0};
};

/// The faces of a file as they stand there: polygons of any size.
struct PolygonSoup {
  std::vector<Vec3d> positions;
  std::vector<uint32_t> corners; ///< indices of all faces, one after the other
  std::vector<size_t> face_ends; ///< where each face ends in `corners`
  std::vector<int> lines;        ///< the line of each face; empty where the file is not text
  /// Positions that are not finite or too far away, and where the file has them: nothing is wrong unless a face uses them.
  std::vector<std::pair<uint32_t, SourcePosition>> unusable;
  size_t face_count() const { return face_ends.size(); }
  size_t face_begin(size_t face) const { return face ? face_ends[face - 1] : 0; }
};

/// Larger meshes are refused.
constexpr size_t k_most_faces = 10'000'000;

/// Of the parameter `weld`, as users read it.
inline constexpr std::string_view k_weld_doc =
    "vertices on open borders that are nearer to each other than this are one; 0: a 10,000th of the mesh's diagonal, or a quarter of the "
    "shortest edge at either";

/// How a mesh is mended.
struct MeshOptions {
  double weld = 0;          ///< vertices on open borders that are nearer to each other are one; 0: chosen by size and density (weld.h)
  bool closes_holes = true; ///< triangulates the outlines of holes
};

/// Reads OBJ, PLY, OFF or STL (ASCII and binary), told apart by content, then by name; triangulates,
/// and mends what can be mended (`repair_mesh`), saying so in warnings. Throws Error: missing_input, or
/// bad_data with the position in the file. A mesh that is open or encloses nothing is loaded with a
/// warning; one without any face is refused.
Mesh load_mesh(const std::string& path, Diagnostics&, const MeshOptions& = {});

/// The same for a file whose bytes are at hand; `path` names it in messages.
Mesh parse_mesh(std::string_view bytes, const std::string& path, Diagnostics&, const MeshOptions& = {});

/// The box of the positions (relative to `origin`).
Box3d bounding_box(const Mesh&);

double surface_area(const Mesh&);

/// The enclosed volume, positive where triangles face outward; cavities are subtracted.
double signed_volume(const Mesh&);

/// Whether every edge has two triangles that run along it in opposite directions.
bool is_closed(const Mesh&);

} // namespace kelpie
