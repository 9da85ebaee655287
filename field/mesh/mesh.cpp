#include "field/mesh/mesh.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "base/file_bytes.h"
#include "field/mesh/edges.h"
#include "field/mesh/formats.h"
#include "field/mesh/repair.h"
#include "field/mesh/triangulate.h"

namespace kelpie {

namespace {

std::string lower_extension(const std::string& path) {
  std::string e = std::filesystem::path(path).extension().string();
  for (char& c : e) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return e;
}

} // namespace

PolygonSoup read_polygons(std::string_view bytes, const std::string& path, Diagnostics& diagnostics) {
  if (bytes.substr(0, 3) == "\xef\xbb\xbf") bytes.remove_prefix(3); // a byte order mark
  if (bytes.empty()) throw Error(ExitStatus::bad_data, "the file is empty", {path, 0, 0});
  const std::string extension = lower_extension(path);
  if (bytes.substr(0, 3) == "ply") return read_ply_mesh(bytes, path);
  const std::string_view first = bytes.substr(0, std::min(bytes.find_first_of(" \t\r\n"), size_t{16}));
  if (first.size() >= 3 && first.substr(first.size() - 3) == "OFF") return read_off(bytes, path);
  if (is_binary_stl(bytes) || (first == "solid" && bytes.find("facet") != std::string_view::npos)) return read_stl(bytes, path);
  if (extension == ".ply") return read_ply_mesh(bytes, path);
  if (extension == ".off") return read_off(bytes, path);
  if (extension == ".stl") return read_stl(bytes, path);
  if (extension == ".obj" || first == "v" || first == "o" || first == "g" || first == "mtllib" || first[0] == '#')
    return read_obj(bytes, path, diagnostics);
  throw Error(ExitStatus::bad_data, "neither OBJ, PLY, OFF nor STL", {path, 0, 0});
}

void append_face(PolygonSoup& soup, const std::vector<uint32_t>& corners, int line, const std::string& file) {
  if (soup.face_count() >= k_most_faces)
    throw Error(ExitStatus::bad_data, fmt::format("more faces than the limit of {}", k_most_faces), {file, line, 0});
  soup.corners.insert(soup.corners.end(), corners.begin(), corners.end());
  soup.face_ends.push_back(soup.corners.size());
  if (line) soup.lines.push_back(line);
}

void read_triangles(std::string_view bytes, const std::string& path, Diagnostics& diagnostics, std::vector<Vec3d>& positions,
                    std::vector<Triangle>& triangles) {
  PolygonSoup soup = read_polygons(bytes, path, diagnostics);
  if (soup.face_count() == 0) throw Error(ExitStatus::bad_data, "the mesh has no faces", {path, 0, 0});
  std::vector<uint32_t> corners;
  for (size_t f = 0; f < soup.face_count(); ++f) {
    corners.assign(soup.corners.begin() + static_cast<std::ptrdiff_t>(soup.face_begin(f)),
                   soup.corners.begin() + static_cast<std::ptrdiff_t>(soup.face_ends[f]));
    triangulate(soup.positions, corners, triangles);
    if (triangles.size() > k_most_faces)
      throw Error(ExitStatus::bad_data, fmt::format("more triangles than the limit of {}", k_most_faces), {path, 0, 0});
  }
  positions = std::move(soup.positions);
}

Mesh parse_mesh(std::string_view bytes, const std::string& path, Diagnostics& diagnostics) {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  read_triangles(bytes, path, diagnostics, positions, triangles);
  return repair_mesh(std::move(positions), std::move(triangles), path, diagnostics);
}

Mesh load_mesh(const std::string& path, Diagnostics& diagnostics) { return parse_mesh(read_file_bytes(path), path, diagnostics); }

Box3d bounding_box(const Mesh& mesh) {
  Box3d box;
  for (const Vec3d& p : mesh.positions) box.extend(p);
  return box;
}

double surface_area(const Mesh& mesh) {
  double twice = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d& a = mesh.positions[t[0]];
    twice += glm::length(glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a));
  }
  return twice / 2;
}

double signed_volume(const Mesh& mesh) {
  double six = 0;
  for (const Triangle& t : mesh.triangles) six += glm::dot(mesh.positions[t[0]], glm::cross(mesh.positions[t[1]], mesh.positions[t[2]]));
  return six / 6;
}

bool is_closed(const Mesh& mesh) {
  bool closed = true;
  for_each_edge(sorted_half_edges(mesh.triangles), [&](const HalfEdge* first, const HalfEdge* last) {
    closed = closed && last - first == 2 && first[0].is_reversed != first[1].is_reversed;
  });
  return closed;
}

std::vector<HalfEdge> sorted_half_edges(const std::vector<Triangle>& triangles) {
  std::vector<HalfEdge> halves;
  halves.reserve(3 * triangles.size());
  for (uint32_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      halves.push_back({std::min(a, b), std::max(a, b), t, a > b});
    }
  std::sort(halves.begin(), halves.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
  });
  return halves;
}

} // namespace kelpie
