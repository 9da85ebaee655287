#include "field/mesh/repair.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "field/mesh/edges.h"
#include "field/mesh/orient.h"
#include "field/mesh/triangle_tree.h"
#include "field/mesh/triangulate.h"
#include "field/mesh/weld.h"

namespace kelpie {

namespace {

/// A lid is right if the mesh winds around it by a half, more or less.
constexpr double k_least_winding = 0.3, k_most_winding = 0.7;

constexpr uint32_t k_none = std::numeric_limits<uint32_t>::max();

class Repair {
public:
  Repair(std::vector<Vec3d> positions, std::vector<Triangle> triangles, const MeshOptions& options, const std::string& file,
         Diagnostics& diagnostics)
      : positions_(std::move(positions)), triangles_(std::move(triangles)), options_(options), file_(file), diagnostics_(diagnostics) {}

  Mesh run() {
    drop_unused_vertices();
    merge_equal_vertices();
    weld_borders(positions_, triangles_, options_.weld, file_, diagnostics_);
    drop_degenerate();
    drop_duplicates();
    if (triangles_.empty()) throw Error(ExitStatus::bad_data, "the mesh has no face with three different vertices", {file_, 0, 0});
    drop_unused_vertices();
    centre();
    const Components components = orient_consistently(triangles_);
    warn(components.turned, "triangles turned to agree with their neighbours: {}");
    warn(components.contradictions, "edges whose triangles cannot agree on an outside (a one-sided surface): {}");
    warn(orient_outward(positions_, components, triangles_), "triangles turned in components that faced the wrong way: {}");
    if (options_.closes_holes) warn(close_holes(), "holes that were closed: {}");
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

  /// Closes every boundary loop that is a hole and touches itself nowhere. Returns how many there were.
  size_t close_holes() {
    const std::vector<std::vector<uint32_t>> loops = boundary_loops();
    if (loops.empty()) return 0;
    const TriangleTree as_read(Mesh{positions_, triangles_, origin_});
    size_t holes = 0;
    std::vector<Triangle> lid;
    for (const std::vector<uint32_t>& loop : loops) {
      lid.clear();
      triangulate(positions_, loop, lid);
      if (!is_worth_closing(loop) || !is_boundary(lid, as_read)) continue;
      triangles_.insert(triangles_.end(), lid.begin(), lid.end());
      ++holes;
    }
    return holes;
  }

  std::vector<std::vector<uint32_t>> boundary_loops() const {
    std::vector<uint32_t> after(positions_.size(), k_none); // the boundary runs against its triangles
    std::vector<char> is_forked(positions_.size(), 0);
    for_each_edge(sorted_half_edges(triangles_), [&](const HalfEdge* first, const HalfEdge* last) {
      if (last - first != 1) return;
      const uint32_t start = first->is_reversed ? first->low : first->high, end = first->is_reversed ? first->high : first->low;
      if (after[start] != k_none) is_forked[start] = 1;
      after[start] = end;
    });
    std::vector<std::vector<uint32_t>> loops;
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
      if (is_simple) loops.push_back(loop);
    }
    return loops;
  }

  /// Whether a lid lies between inside and outside, by the mean winding number of the mesh around its triangles.
  bool is_boundary(const std::vector<Triangle>& lid, const TriangleTree& mesh) const {
    double sum = 0, area = 0;
    for (const Triangle& t : lid) {
      const Vec3d &a = positions_[t[0]], &b = positions_[t[1]], &c = positions_[t[2]];
      const double share = glm::length(glm::cross(b - a, c - a)) + std::numeric_limits<double>::min();
      sum += share * mesh.winding((a + b + c) / 3.0), area += share;
    }
    return sum > k_least_winding * area && sum < k_most_winding * area;
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
  MeshOptions options_;
  std::string file_;
  Diagnostics& diagnostics_;
  Vec3d origin_{0};
};

} // namespace

Mesh repair_mesh(std::vector<Vec3d> positions, std::vector<Triangle> triangles, const MeshOptions& options, const std::string& file,
                 Diagnostics& diagnostics) {
  return Repair(std::move(positions), std::move(triangles), options, file, diagnostics).run();
}

} // namespace kelpie
