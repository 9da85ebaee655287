#include "field/mesh/mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/file_bytes.h"
#include "field/mesh/edges.h"
#include "field/mesh/formats.h"
#include "field/mesh/repair.h"

namespace kelpie {

Mesh parse_mesh(std::string_view bytes, const std::string& path, Diagnostics& diagnostics, const MeshOptions& options) {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
  read_triangles(bytes, path, diagnostics, positions, triangles);
  return repair_mesh(std::move(positions), std::move(triangles), options, path, diagnostics);
}

Mesh load_mesh(const std::string& path, Diagnostics& diagnostics, const MeshOptions& options) {
  return parse_mesh(read_file_bytes(path), path, diagnostics, options);
}

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
  // First by their low vertex, by counting; each has a few, which are sorted.
  std::vector<size_t> ends;
  for (const Triangle& t : triangles)
    for (size_t k = 0; k < 3; ++k) {
      const size_t low = std::min(t[k], t[(k + 1) % 3]);
      if (low >= ends.size()) ends.resize(std::max(low + 1, 2 * ends.size()), 0);
      ++ends[low];
    }
  std::exclusive_scan(ends.begin(), ends.end(), ends.begin(), size_t{0});
  std::vector<HalfEdge> halves(3 * triangles.size());
  for (uint32_t t = 0; t < triangles.size(); ++t)
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      halves[ends[std::min(a, b)]++] = {std::min(a, b), std::max(a, b), t, a > b};
    }
  for (size_t low = 0, first = 0; low < ends.size(); first = ends[low++])
    std::sort(halves.begin() + static_cast<std::ptrdiff_t>(first), halves.begin() + static_cast<std::ptrdiff_t>(ends[low]),
              [](const HalfEdge& a, const HalfEdge& b) { return a.high != b.high ? a.high < b.high : a.triangle < b.triangle; });
  return halves;
}

} // namespace kelpie
