#include "field/mesh/repair.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "field/mesh/edges.h"
#include "field/mesh/orient.h"
#include "field/mesh/triangulate.h"

namespace kelpie {

namespace {

/// Beyond this a coordinate is no place: its cube must be far from overflow.
constexpr double k_farthest = 1e30;

constexpr uint32_t k_none = std::numeric_limits<uint32_t>::max();

class Repair {
public:
  Repair(std::vector<Vec3d> positions, std::vector<Triangle> triangles, const std::string& file, Diagnostics& diagnostics)
      : positions_(std::move(positions)), triangles_(std::move(triangles)), file_(file), diagnostics_(diagnostics) {}

  Mesh run() {
    drop_unusable_triangles(positions_, triangles_, file_, diagnostics_);
    merge_equal_vertices();
    drop_degenerate();
    drop_duplicates();
    if (triangles_.empty()) throw Error(ExitStatus::bad_data, "the mesh has no face with three different vertices", {file_, 0, 0});
    drop_unused_vertices();
    centre();
    Components components = orient_consistently(triangles_);
    warn(components.turned, "triangles turned to agree with their neighbours: {}");
    warn(components.contradictions, "edges whose triangles cannot agree on an outside (a one-sided surface): {}");
    if (const size_t holes = close_holes()) {
      warn(holes, "holes that were closed: {}");
      components = orient_consistently(triangles_);
    }
    warn(orient_outward(positions_, components, triangles_), "triangles turned in components that faced the wrong way: {}");
    return report();
  }

private:
  void warn(size_t count, std::string_view message) {
    if (count) diagnostics_.warning({file_, 0, 0}, fmt::format(fmt::runtime(message), count));
  }

  template <class Predicate>
  size_t drop_if(Predicate&& predicate) {
    const size_t before = triangles_.size();
    triangles_.erase(std::remove_if(triangles_.begin(), triangles_.end(), predicate), triangles_.end());
    return before - triangles_.size();
  }

  void merge_equal_vertices() {
    const std::vector<uint32_t> kept = first_at_same_place(positions_);
    size_t merged = 0;
    for (uint32_t i = 0; i < kept.size(); ++i) merged += kept[i] != i;
    const bool is_soup = positions_.size() == 3 * triangles_.size();
    for (Triangle& t : triangles_)
      for (uint32_t& v : t) v = kept[v];
    if (!is_soup) warn(merged, "vertices merged with others at the same place: {}");
  }

  void drop_degenerate() {
    warn(drop_if([](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }),
         "triangles dropped for two equal vertices: {}");
  }

  void drop_duplicates() {
    const auto key = [](Triangle t) {
      std::sort(t.begin(), t.end());
      return t;
    };
    std::vector<uint32_t> order(triangles_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
      const Triangle x = key(triangles_[a]), y = key(triangles_[b]);
      return x != y ? x < y : a < b;
    });
    std::vector<char> is_duplicate(triangles_.size(), 0);
    for (size_t i = 1; i < order.size(); ++i) is_duplicate[order[i]] = key(triangles_[order[i]]) == key(triangles_[order[i - 1]]);
    size_t i = 0;
    warn(drop_if([&](const Triangle&) { return is_duplicate[i++] != 0; }), "triangles dropped that were there twice: {}");
  }

  void drop_unused_vertices() {
    std::vector<uint32_t> renamed(positions_.size(), k_none);
    std::vector<Vec3d> used;
    for (Triangle& t : triangles_)
      for (uint32_t& v : t) {
        if (renamed[v] == k_none) renamed[v] = static_cast<uint32_t>(used.size()), used.push_back(positions_[v]);
        v = renamed[v];
      }
    positions_ = std::move(used);
  }

  void centre() {
    Box3d box;
    for (const Vec3d& p : positions_) box.extend(p);
    origin_ = box.centre();
    for (Vec3d& p : positions_) p -= origin_;
  }

  /// Closes every boundary loop that touches itself nowhere. Returns how many there were.
  size_t close_holes() {
    std::vector<uint32_t> after(positions_.size(), k_none); // the boundary runs against its triangles
    std::vector<char> is_forked(positions_.size(), 0);
    for_each_edge(sorted_half_edges(triangles_), [&](const HalfEdge* first, const HalfEdge* last) {
      if (last - first != 1) return;
      const uint32_t start = first->is_reversed ? first->low : first->high, end = first->is_reversed ? first->high : first->low;
      if (after[start] != k_none) is_forked[start] = 1;
      after[start] = end;
    });
    size_t holes = 0;
    std::vector<uint32_t> loop;
    for (uint32_t seed = 0; seed < after.size(); ++seed) {
      if (after[seed] == k_none) continue;
      loop.clear();
      bool is_simple = true;
      for (uint32_t v = seed; v != k_none;) {
        loop.push_back(v);
        is_simple = is_simple && !is_forked[v];
        v = std::exchange(after[v], k_none);
      }
      is_simple = is_simple && loop.size() > 3 && loop.back() == seed;
      loop.pop_back();
      if (is_simple && is_worth_closing(loop)) triangulate(positions_, loop, triangles_), ++holes;
    }
    return holes;
  }

  /// Not the outline of a triangle that stands alone: its lid would be the triangle itself.
  bool is_worth_closing(const std::vector<uint32_t>& loop) const {
    if (loop.size() != 3) return true;
    Triangle lid{loop[0], loop[1], loop[2]};
    std::sort(lid.begin(), lid.end());
    return std::none_of(triangles_.begin(), triangles_.end(), [&](Triangle t) {
      std::sort(t.begin(), t.end());
      return t == lid;
    });
  }

  Mesh report() {
    size_t open = 0, crowded = 0;
    for_each_edge(sorted_half_edges(triangles_), [&](const HalfEdge* first, const HalfEdge* last) {
      open += last - first == 1;
      crowded += last - first > 2;
    });
    warn(open, "the mesh is open; boundary edges: {}");
    warn(crowded, "the mesh is not manifold; edges with more than two triangles: {}");
    Mesh mesh{std::move(positions_), std::move(triangles_), origin_};
    const double diagonal = bounding_box(mesh).diagonal();
    if (!(signed_volume(mesh) > 1e-9 * diagonal * diagonal * diagonal)) diagnostics_.warning({file_, 0, 0}, "the mesh encloses no volume");
    return mesh;
  }

  std::vector<Vec3d> positions_;
  std::vector<Triangle> triangles_;
  std::string file_;
  Diagnostics& diagnostics_;
  Vec3d origin_{0};
};

} // namespace

void drop_unusable_triangles(std::vector<Vec3d>& positions, std::vector<Triangle>& triangles, const std::string& file,
                             Diagnostics& diagnostics) {
  const auto is_unusable = [](const Vec3d& p) {
    return !(std::abs(p.x) < k_farthest && std::abs(p.y) < k_farthest && std::abs(p.z) < k_farthest);
  };
  const size_t before = triangles.size();
  const auto has_unusable = [&](const Triangle& t) {
    return std::any_of(t.begin(), t.end(), [&](uint32_t v) { return is_unusable(positions[v]); });
  };
  triangles.erase(std::remove_if(triangles.begin(), triangles.end(), has_unusable), triangles.end());
  if (const size_t dropped = before - triangles.size())
    diagnostics.warning({file, 0, 0}, fmt::format("triangles dropped for coordinates that are not finite or beyond 1e30: {}", dropped));
  for (Vec3d& p : positions)
    if (is_unusable(p)) p = Vec3d(0);
}

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

Mesh repair_mesh(std::vector<Vec3d> positions, std::vector<Triangle> triangles, const std::string& file, Diagnostics& diagnostics) {
  return Repair(std::move(positions), std::move(triangles), file, diagnostics).run();
}

} // namespace kelpie
