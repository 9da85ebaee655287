#include "renderer/mesh/mesh_solid.h"

#include <algorithm>

#include <tbb/parallel_sort.h>

#include "base/parallel.h"
#include "renderer/mesh/cell_tetrahedra.h"
#include "renderer/program/surface_search.h"

namespace kelpie {

namespace {

using Place = Octree::Place;

/// A place as one number: corners of tetrahedra are told apart by it.
uint64_t key_of(const Place& p) { return p[0] | uint64_t(p[1]) << 21 | uint64_t(p[2]) << 42; }
Place place_of(uint64_t key) {
  constexpr uint64_t k_mask = (1u << 21) - 1;
  return {uint32_t(key & k_mask), uint32_t(key >> 21 & k_mask), uint32_t(key >> 42)};
}

void sort_unique(std::vector<uint64_t>& keys) {
  tbb::parallel_sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  keys.shrink_to_fit();
}

uint32_t index_in(const std::vector<uint64_t>& sorted, uint64_t key) {
  return static_cast<uint32_t>(std::lower_bound(sorted.begin(), sorted.end(), key) - sorted.begin());
}

/// Whether b, c and d are seen counter-clockwise from a.
bool is_positive(const std::array<Place, 4>& t) {
  std::array<std::array<int64_t, 3>, 3> e;
  for (size_t i = 0; i < 3; ++i)
    for (size_t k = 0; k < 3; ++k) e[i][k] = int64_t(t[i + 1][k]) - int64_t(t[0][k]);
  const auto minor = [&](size_t x, size_t y) { return e[1][x] * e[2][y] - e[1][y] * e[2][x]; };
  return e[0][0] * minor(1, 2) + e[0][1] * minor(2, 0) + e[0][2] * minor(0, 1) > 0;
}

/// The tetrahedra of a leaf, and the keys of their corners, sorted.
struct LeafTetrahedra {
  std::vector<std::array<Place, 4>> all;
  std::vector<uint64_t> keys;

  void find(const CellTetrahedra& tetrahedra, const Octree::Leaf& leaf) {
    all.clear(), keys.clear();
    tetrahedra.for_each(leaf, [&](const std::array<Place, 4>& t) {
      all.push_back(t);
      for (const Place& p : t) keys.push_back(key_of(p));
    });
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  }
};

class Marcher {
public:
  Marcher(const Solid& solid, double tolerance) : solid_(solid), octree_(solid, tolerance), tolerance_(tolerance) {}

  Mesh run() {
    find_nodes();
    find_triangles();
    Mesh mesh;
    mesh.positions.resize(edges_.size());
    parallel_for(size_t(0), edges_.size(), [&](size_t i) { mesh.positions[i] = vertex_on(edges_[i]); });
    mesh.triangles.resize(triangles_.size());
    parallel_for(size_t(0), triangles_.size(), [&](size_t i) {
      for (size_t k = 0; k < 3; ++k) mesh.triangles[i][k] = index_in(edges_, triangles_[i][k]);
    });
    return mesh;
  }

private:
  /// An edge of tetrahedra: its ends' indices, the lower one above.
  using Edge = uint64_t;
  using EdgeTriangle = std::array<Edge, 3>;

  static constexpr size_t k_block = 512; ///< leaves at a time

  /// Calls work(tetrahedra, list) for all leaves, and returns what it appends, in the leaves' order.
  template <class T, class Work>
  std::vector<T> gather(const Work& work) const {
    const CellTetrahedra tetrahedra(octree_);
    const std::vector<Octree::Leaf>& leaves = octree_.leaves();
    std::vector<std::vector<T>> lists((leaves.size() + k_block - 1) / k_block);
    parallel_for(size_t(0), lists.size(), [&](size_t b) {
      LeafTetrahedra of_leaf;
      for (size_t i = b * k_block; i < std::min(leaves.size(), (b + 1) * k_block); ++i) {
        of_leaf.find(tetrahedra, leaves[i]);
        work(of_leaf, lists[b]);
      }
    });
    std::vector<T> all;
    for (std::vector<T>& list : lists) {
      all.insert(all.end(), list.begin(), list.end());
      list = {};
    }
    return all;
  }

  void find_nodes() {
    nodes_ = gather<uint64_t>(
        [](const LeafTetrahedra& leaf, std::vector<uint64_t>& list) { list.insert(list.end(), leaf.keys.begin(), leaf.keys.end()); });
    sort_unique(nodes_);
    values_.resize(nodes_.size());
    parallel_for(size_t(0), nodes_.size(), [&](size_t i) {
      const Place p = place_of(nodes_[i]);
      values_[i] = solid_.value(octree_.code_at(p), octree_.position(p));
    });
  }

  void find_triangles() {
    triangles_ = gather<EdgeTriangle>([&](const LeafTetrahedra& leaf, std::vector<EdgeTriangle>& list) {
      std::vector<uint32_t> nodes;
      for (const uint64_t key : leaf.keys) nodes.push_back(index_in(nodes_, key));
      for (const std::array<Place, 4>& t : leaf.all) {
        std::array<uint32_t, 4> corners;
        for (size_t i = 0; i < 4; ++i) corners[i] = nodes[index_in(leaf.keys, key_of(t[i]))];
        cut(t, corners, list);
      }
    });
    edges_.reserve(3 * triangles_.size());
    for (const EdgeTriangle& t : triangles_) edges_.insert(edges_.end(), t.begin(), t.end());
    sort_unique(edges_);
  }

  static Edge edge_of(uint32_t a, uint32_t b) { return uint64_t(std::min(a, b)) << 32 | std::max(a, b); }

  /// One corner on its own side makes a triangle, two a quadrangle.
  void cut(const std::array<Place, 4>& places, const std::array<uint32_t, 4>& nodes, std::vector<EdgeTriangle>& out) const {
    std::array<size_t, 4> order{}; // corners inside first
    size_t inside = 0, outside = 4;
    for (size_t i = 0; i < 4; ++i) order[values_[nodes[i]] > 0 ? inside++ : --outside] = i;
    if (inside == 0 || inside == 4) return;
    std::array<Place, 4> sorted;
    std::array<uint32_t, 4> c{};
    for (size_t i = 0; i < 4; ++i) sorted[i] = places[order[i]], c[i] = nodes[order[i]];
    const auto add = [&, is_turned = !is_positive(sorted)](Edge p, Edge q, Edge r) {
      out.push_back(is_turned ? EdgeTriangle{p, r, q} : EdgeTriangle{p, q, r});
    };
    if (inside == 1) add(edge_of(c[0], c[1]), edge_of(c[0], c[2]), edge_of(c[0], c[3]));
    if (inside == 3) add(edge_of(c[0], c[3]), edge_of(c[1], c[3]), edge_of(c[2], c[3]));
    if (inside != 2) return;
    add(edge_of(c[0], c[2]), edge_of(c[0], c[3]), edge_of(c[1], c[3]));
    add(edge_of(c[0], c[2]), edge_of(c[1], c[3]), edge_of(c[1], c[2]));
  }

  Vec3d vertex_on(Edge edge) const {
    auto a = static_cast<uint32_t>(edge >> 32), b = static_cast<uint32_t>(edge);
    if (values_[a] <= 0) std::swap(a, b);
    const Place inner = place_of(nodes_[a]), outer = place_of(nodes_[b]);
    const Vec3d p = octree_.position(inner), way = octree_.position(outer) - p;
    const Code& code = octree_.code_at(middle_of(inner, outer));
    const double part = crossing(values_[a], values_[b], solid_.close(), [&](double s) { return solid_.value(code, p + s * way); });
    const double least = std::min(0.1, 0.1 * tolerance_ / glm::length(way));
    return p + std::clamp(part, least, 1 - least) * way;
  }

  /// Both lie in the closure of its leaf, as an edge of a tetrahedron does.
  static Place middle_of(const Place& a, const Place& b) { return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2}; }

  const Solid& solid_;
  Octree octree_;
  double tolerance_;
  std::vector<uint64_t> nodes_; ///< corners of tetrahedra, sorted
  std::vector<double> values_;  ///< of the solid, at each
  std::vector<EdgeTriangle> triangles_;
  std::vector<Edge> edges_; ///< with a vertex, sorted
};

} // namespace

Mesh mesh_solid(const Solid& solid, double tolerance) {
  if (solid.bounds().is_empty()) return {};
  return Marcher(solid, tolerance).run();
}

} // namespace kelpie
