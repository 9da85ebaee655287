#include "morph/liquid/body_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "base/parallel.h"
#include "morph/liquid/blob_shape.h"

namespace kelpie {

namespace {

/// Blobs are in one another where their centres are nearer than this share of their reaches together.
constexpr double k_overlap = 0.55;

/// The widest gap between the surfaces of two blobs that a drop would leap, as a share of the diagonal of both bodies.
constexpr double k_leap = 0.06;

struct Moments {
  Vec3d centre{0};
  Box3d box;
};

Moments moments(const BlobCloud& cloud) {
  Moments m;
  double total = 0;
  for (const Blob& b : cloud) {
    const double e = shape_of(b).sphere_radius, mass = e * e * e;
    m.centre += mass * Vec3d(b.centre), total += mass;
    m.box.extend(Box3d{Vec3d(b.centre) - e, Vec3d(b.centre) + e});
  }
  m.centre /= total;
  return m;
}

} // namespace

BodyGraph::BodyGraph(const BlobCloud& from, const BlobCloud& to) : from_count_(from.size()), to_count_(to.size()) {
  const Moments a = moments(from), b = moments(to);
  if (intersect(a.box, b.box).is_empty()) shift_ = a.centre - b.centre;
  add_nodes(from, Vec3d(0)), add_nodes(to, shift_);
  edges_.resize(nodes_.size());
  add_edges();
  join_components();
  lengths_.resize(from_count_ * to_count_), comes_from_.resize(from_count_ * nodes_.size());
  parallel_for(size_t{0}, from_count_, [&](size_t i) { find_ways(i); });
}

void BodyGraph::add_nodes(const BlobCloud& cloud, const Vec3d& shift) {
  for (const Blob& b : cloud) nodes_.push_back({Vec3d(b.centre) + shift, b, shape_of(b).sphere_radius / b.radius});
}

void BodyGraph::add_edges() {
  Box3d box;
  for (const Node& n : nodes_) box.extend(Box3d{n.centre - n.radius * n.blob.radius, n.centre + n.radius * n.blob.radius});
  const double leap = k_leap * box.diagonal();
  for (uint32_t i = 0; i < nodes_.size(); ++i)
    for (uint32_t j = i + 1; j < nodes_.size(); ++j) {
      const Node &a = nodes_[i], &b = nodes_[j];
      const Vec3d way = a.centre - b.centre;
      const double apart = glm::length(way), gap = apart - (a.extent(way) + b.extent(way));
      if (apart < k_overlap * (a.reach(way) + b.reach(way)))
        add_edge(i, j, apart);
      else if (gap < leap)
        add_edge(i, j, apart + k_air * std::max(0.0, gap));
    }
}

/// The number of its component, for each node.
std::vector<uint32_t> BodyGraph::components() const {
  constexpr uint32_t k_none = ~0u;
  std::vector<uint32_t> component(nodes_.size(), k_none), stack;
  uint32_t count = 0;
  for (uint32_t start = 0; start < nodes_.size(); ++start) {
    if (component[start] != k_none) continue;
    component[start] = count, stack.push_back(start);
    while (!stack.empty()) {
      const uint32_t node = stack.back();
      stack.pop_back();
      for (const Edge& e : edges_[node])
        if (component[e.node] == k_none) component[e.node] = count, stack.push_back(e.node);
    }
    ++count;
  }
  return component;
}

/// Joins each component with the one nearest to it, until there is one (Borůvka's algorithm).
void BodyGraph::join_components() {
  struct Bridge {
    double gap = std::numeric_limits<double>::infinity();
    uint32_t a = 0, b = 0;
  };
  for (;;) {
    const std::vector<uint32_t> component = components();
    const uint32_t count = 1 + *std::max_element(component.begin(), component.end());
    if (count == 1) return;
    std::vector<Bridge> nearest(count);
    for (uint32_t i = 0; i < nodes_.size(); ++i)
      for (uint32_t j = i + 1; j < nodes_.size(); ++j) {
        if (component[i] == component[j]) continue;
        const Vec3d way = nodes_[i].centre - nodes_[j].centre;
        const double gap = glm::length(way) - nodes_[i].extent(way) - nodes_[j].extent(way);
        for (const uint32_t c : {component[i], component[j]})
          if (gap < nearest[c].gap) nearest[c] = {gap, i, j};
      }
    for (const Bridge& n : nearest) add_edge(n.a, n.b, glm::length(nodes_[n.a].centre - nodes_[n.b].centre) + k_air * std::max(0.0, n.gap));
  }
}

void BodyGraph::find_ways(size_t source) {
  using Entry = std::pair<double, uint32_t>;
  std::vector<double> length(nodes_.size(), std::numeric_limits<double>::infinity());
  uint32_t* const comes_from = comes_from_.data() + source * nodes_.size();
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  length[source] = 0, queue.push({0, static_cast<uint32_t>(source)});
  while (!queue.empty()) {
    const auto [at, node] = queue.top();
    queue.pop();
    if (at > length[node]) continue;
    for (const Edge& e : edges_[node])
      if (at + e.length < length[e.node]) length[e.node] = at + e.length, comes_from[e.node] = node, queue.push({length[e.node], e.node});
  }
  std::copy(length.begin() + static_cast<std::ptrdiff_t>(from_count_), length.end(), lengths_.data() + source * to_count_);
}

std::vector<Vec3d> BodyGraph::way(size_t i, size_t j) const {
  const uint32_t* const comes_from = comes_from_.data() + i * nodes_.size();
  std::vector<uint32_t> nodes{static_cast<uint32_t>(from_count_ + j)};
  while (nodes.back() != i) nodes.push_back(comes_from[nodes.back()]);
  std::reverse(nodes.begin(), nodes.end());
  // Where `to` was moved, the way leads there little by little.
  std::vector<Vec3d> way;
  double so_far = 0;
  std::vector<double> along;
  for (size_t k = 0; k < nodes.size(); ++k) {
    if (k > 0) so_far += glm::length(nodes_[nodes[k]].centre - nodes_[nodes[k - 1]].centre);
    along.push_back(so_far);
  }
  for (size_t k = 0; k < nodes.size(); ++k) {
    const double done = so_far > 0 ? along[k] / so_far : double(k) / double(nodes.size() - 1);
    way.push_back(nodes_[nodes[k]].centre - done * shift_);
  }
  return way;
}

} // namespace kelpie
