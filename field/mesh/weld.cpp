#include "field/mesh/weld.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include <fmt/format.h>
#include <nanoflann.hpp>

#include "field/mesh/edges.h"

namespace kelpie {

namespace {

constexpr double k_tolerance_of_diagonal = 1e-4, k_tolerance_of_edge = 0.25;

/// Vertices that are ends of an edge of one triangle, ascending.
std::vector<uint32_t> border_vertices(const std::vector<Triangle>& triangles) {
  std::vector<uint32_t> border;
  for_each_edge(sorted_half_edges(triangles), [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first == 1 && first->low != first->high) border.insert(border.end(), {first->low, first->high});
  });
  std::sort(border.begin(), border.end());
  border.erase(std::unique(border.begin(), border.end()), border.end());
  return border;
}

/// How far from each vertex another may be to be the same.
std::vector<double> reaches(const std::vector<Vec3d>& positions, const std::vector<Triangle>& triangles, double tolerance) {
  if (tolerance > 0) return std::vector<double>(positions.size(), tolerance);
  Box3d box;
  for (const Triangle& t : triangles)
    for (const uint32_t v : t) box.extend(positions[v]);
  std::vector<double> reach(positions.size(), k_tolerance_of_diagonal * box.diagonal());
  for (const Triangle& t : triangles)
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3];
      if (a == b) continue;
      const double most = k_tolerance_of_edge * glm::distance(positions[a], positions[b]);
      reach[a] = std::min(reach[a], most), reach[b] = std::min(reach[b], most);
    }
  return reach;
}

/// The border's vertices, for nanoflann.
struct BorderPoints {
  const std::vector<Vec3d>& positions;
  const std::vector<uint32_t>& vertices;
  size_t kdtree_get_point_count() const { return vertices.size(); }
  double kdtree_get_pt(size_t i, size_t axis) const { return positions[vertices[i]][axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

} // namespace

std::vector<uint32_t> first_at_same_place(const std::vector<Vec3d>& positions) {
  std::vector<uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](uint32_t i) { return std::tuple(positions[i].x, positions[i].y, positions[i].z, i); };
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
  for (size_t i = 0; i < order.size(); ++i) {
    const bool is_same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    first[order[i]] = is_same ? first[order[i - 1]] : order[i];
  }
  return first;
}

Weld weld_borders(const std::vector<Vec3d>& positions, std::vector<Triangle>& triangles, double tolerance) {
  const std::vector<uint32_t> border = border_vertices(triangles);
  if (border.empty()) return {};
  const std::vector<double> reach = reaches(positions, triangles, tolerance);
  const BorderPoints points{positions, border};
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, BorderPoints>, BorderPoints, 3, size_t>;
  Tree tree(3, points);
  tree.buildIndex();

  std::vector<uint32_t> becomes(positions.size());
  std::iota(becomes.begin(), becomes.end(), 0u);
  std::vector<char> is_settled(positions.size(), 0);
  Weld weld;
  std::vector<std::pair<size_t, double>> near; // by their squared distance
  for (const uint32_t v : border) {
    if (is_settled[v]) continue;
    is_settled[v] = 1;
    near.clear();
    tree.radiusSearch(&positions[v].x, reach[v] * reach[v], near, nanoflann::SearchParams(0, 0, false));
    for (const auto& [index, squared] : near) {
      const uint32_t other = border[index];
      if (is_settled[other] || squared >= reach[other] * reach[other]) continue;
      is_settled[other] = 1, becomes[other] = v;
      ++weld.vertices, weld.farthest = std::max(weld.farthest, std::sqrt(squared));
    }
  }
  for (Triangle& t : triangles)
    for (uint32_t& v : t) v = becomes[v];
  return weld;
}

void weld_borders(const std::vector<Vec3d>& positions, std::vector<Triangle>& triangles, double tolerance, const std::string& file,
                  Diagnostics& diagnostics) {
  const Weld weld = weld_borders(positions, triangles, tolerance);
  if (weld.vertices > 0)
    diagnostics.warning({file, 0, 0},
                        fmt::format("vertices on open borders welded to others, up to {:.2g} away: {} (\"weld\" sets how far)",
                                    weld.farthest, weld.vertices));
}

} // namespace kelpie
