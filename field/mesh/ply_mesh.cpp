#include <cmath>

#include <fmt/format.h>

#include "field/files/ply.h"
#include "field/mesh/formats.h"

namespace kelpie {

namespace {

struct Columns {
  int x, y, z, corners;
};

Columns find_columns(const PlyHeader& header, const std::string& file) {
  Columns c{-1, -1, -1, -1};
  for (const PlyElement& e : header.elements) {
    if (e.name == "vertex") c.x = e.column("x"), c.y = e.column("y"), c.z = e.column("z");
    if (e.name == "face") {
      c.corners = std::max(e.column("vertex_indices"), e.column("vertex_index"));
      if (c.corners >= 0 && !e.properties[c.corners].is_list) c.corners = -1;
      if (e.count > k_most_faces)
        throw Error(ExitStatus::bad_data, fmt::format("{} faces are more than the limit of {}", e.count, k_most_faces), {file, e.line, 0});
    }
  }
  if (c.x < 0 || c.y < 0 || c.z < 0) throw Error(ExitStatus::bad_data, "the PLY file has no vertices with x, y and z", {file, 0, 0});
  if (c.corners < 0) throw Error(ExitStatus::bad_data, "the PLY file has no faces with a list vertex_indices", {file, 0, 0});
  return c;
}

} // namespace

PolygonSoup read_ply_mesh(std::string_view bytes, const std::string& file) {
  const PlyHeader header = read_ply_header(bytes, file);
  const Columns columns = find_columns(header, file);
  PolygonSoup soup;
  std::vector<uint32_t> corners;
  read_ply_rows(bytes, file, header, [&](const PlyElement& e, const PlyRow& row) {
    if (e.name == "vertex") soup.positions.push_back({row.scalars[columns.x], row.scalars[columns.y], row.scalars[columns.z]});
    if (e.name != "face") return;
    corners.clear();
    for (const double index : row.lists[columns.corners]) {
      if (!(index >= 0 && index < static_cast<double>(UINT32_MAX) && index == std::floor(index)))
        throw Error(ExitStatus::bad_data, fmt::format("face {}: there is no vertex {}", soup.face_count(), index), {file, 0, 0});
      corners.push_back(static_cast<uint32_t>(index));
    }
    append_face(soup, corners, 0, file);
  });
  for (const uint32_t c : soup.corners) // faces may come before vertices
    if (c >= soup.positions.size())
      throw Error(ExitStatus::bad_data, fmt::format("there is no vertex {}: the file has {}", c, soup.positions.size()), {file, 0, 0});
  return soup;
}

} // namespace kelpie
