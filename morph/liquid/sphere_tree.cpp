#include "morph/liquid/sphere_tree.h"
#include "base/point_index.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <tuple>

namespace kelpie {

namespace {

/// A level is chosen from this many times as many medial spheres.
constexpr size_t k_candidates_per_sphere = 10;

/// The forming points double until there are enough.
constexpr double k_growth = 2.2;

/// Finds the medial spheres, adding forming points where a sphere sticks out most.
class MedialSpheres {
public:
  MedialSpheres(std::span<const SurfaceSample> dense, const TriangleTree& mesh, const PointIndex<SurfaceSample>& index, size_t wanted)
      : dense_(dense), mesh_(mesh), index_(index) {
    wanted = std::min(wanted, dense.size());
    is_forming_.assign(dense.size(), 0);
    const size_t first = std::max<size_t>(wanted / 5, std::min<size_t>(wanted, 64));
    for (size_t i = 0; i < first; ++i) is_forming_[i] = 1; // the samples come in no spatial order
    forming_ = first;
    for (;;) {
      find_spheres();
      if (forming_ >= wanted) break;
      add_forming_points(std::min(wanted, static_cast<size_t>(k_growth * static_cast<double>(forming_))));
    }
  }

  /// Shrunk to where they touch the surface.
  std::vector<MedialSphere> result() const {
    std::vector<MedialSphere> inscribed;
    for (size_t i = 0; i < spheres_.size(); ++i) inscribed.push_back({spheres_[i].centre, std::min(spheres_[i].radius, reach_[i])});
    return inscribed;
  }

private:
  void find_spheres() {
    std::vector<SurfaceSample> points;
    for (size_t i = 0; i < dense_.size(); ++i)
      if (is_forming_[i]) points.push_back(dense_[i]);
    spheres_.clear(), reach_.clear(), touched_.clear();
    for (const Poles& p : find_poles(points, mesh_)) {
      if (!(p.inner.radius > 0)) continue;
      const size_t q = index_.nearest(p.inner.centre);
      // A centre beyond the surface belongs to a sample without a partner on the other side.
      if (glm::dot(p.inner.centre - dense_[q].position, dense_[q].normal) >= 0) continue;
      spheres_.push_back(p.inner);
      touched_.push_back(q);
      reach_.push_back(glm::length(p.inner.centre - dense_[q].position));
    }
  }

  /// Eq. 2: the error of a sphere is r - |q - c|; its q becomes a forming point.
  void add_forming_points(size_t wanted) {
    std::vector<size_t> order(spheres_.size());
    std::iota(order.begin(), order.end(), size_t{0});
    const auto error = [&](size_t i) { return spheres_[i].radius - reach_[i]; };
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return error(a) > error(b); });
    for (const size_t i : order)
      if (forming_ < wanted && !is_forming_[touched_[i]]) is_forming_[touched_[i]] = 1, ++forming_;
    for (size_t i = 0; i < dense_.size() && forming_ < wanted; ++i)
      if (!is_forming_[i]) is_forming_[i] = 1, ++forming_;
  }

  std::span<const SurfaceSample> dense_;
  const TriangleTree& mesh_;
  const PointIndex<SurfaceSample>& index_;
  std::vector<char> is_forming_;
  size_t forming_ = 0;
  std::vector<MedialSphere> spheres_;
  std::vector<size_t> touched_;
  std::vector<double> reach_;
};

/// Which samples a sphere covers once it is expanded: ascending by the expansion needed.
struct Reach {
  std::vector<std::pair<float, uint32_t>> samples;
};

/// The expansion of a sphere of the usual radius is taken as it is; smaller ones than the least are as good as it.
/// Lengths are in units of the shape's diagonal.
constexpr double k_usual_radius = 0.05, k_least_radius = 0.008, k_most_expansion = 0.025;

/// A torus whose spheres stick out of each other by this much is fitted as well as one of four times the spheres.
constexpr double k_close_expansion = 0.001;

/// Bradshaw and O'Sullivan's expanding reduction: the least expansion d such that a greedy cover of the
/// samples by spheres of radius r + d sqrt(r / usual) needs no more than `wanted`.
class Expander {
public:
  Expander(std::span<const SurfaceSample> dense, const PointIndex<SurfaceSample>& index, const std::vector<MedialSphere>& spheres,
           double most)
      : sample_count_(dense.size()), spheres_(spheres), reaches_(spheres.size()), most_(most) {
    for (size_t s = 0; s < spheres.size(); ++s) {
      // A thin sheet needs its spheres closer together than a fat body: expansion is relative, by the root.
      const double scale = std::sqrt(std::max(spheres[s].radius, k_least_radius) / k_usual_radius);
      index.visit_within(spheres[s].centre, spheres[s].radius + most * scale, [&](size_t i, double distance) {
        reaches_[s].samples.push_back({static_cast<float>((distance - spheres[s].radius) / scale), static_cast<uint32_t>(i)});
      });
      std::sort(reaches_[s].samples.begin(), reaches_[s].samples.end());
    }
  }

  /// Indices of the chosen spheres; fewer than wanted where an expansion of `least` is enough.
  std::vector<size_t> reduce(size_t wanted, double least) const {
    double low = least, high = most_;
    if (least > 0) {
      std::vector<size_t> close = cover(least, wanted + 1);
      if (close.size() <= wanted) return close;
    }
    std::vector<size_t> best = cover(high, wanted);
    for (int step = 0; step < 12; ++step) {
      const double middle = 0.5 * (low + high);
      std::vector<size_t> chosen = cover(middle, wanted + 1);
      if (chosen.size() <= wanted)
        high = middle, best = std::move(chosen);
      else
        low = middle;
    }
    return best;
  }

private:
  size_t within(size_t s, float d) const {
    const auto& r = reaches_[s].samples;
    return static_cast<size_t>(std::upper_bound(r.begin(), r.end(), std::pair(d, UINT32_MAX)) - r.begin());
  }

  /// Greedy: always the sphere that covers most of what is left; at most `limit` of them.
  std::vector<size_t> cover(double expansion, size_t limit) const {
    const float d = static_cast<float>(expansion);
    std::vector<size_t> reach(reaches_.size());
    // (gain when last counted, radius, sphere): gains only sink; of equals the larger sphere is the better start
    std::priority_queue<std::tuple<size_t, double, size_t>> queue;
    for (size_t s = 0; s < reaches_.size(); ++s) {
      reach[s] = within(s, d);
      if (reach[s]) queue.push({reach[s], spheres_[s].radius, s});
    }
    std::vector<char> is_covered(sample_count_, 0);
    std::vector<size_t> chosen;
    while (!queue.empty() && chosen.size() < limit) {
      const auto [gain, radius, s] = queue.top();
      queue.pop();
      size_t now = 0;
      for (size_t k = 0; k < reach[s]; ++k) now += !is_covered[reaches_[s].samples[k].second];
      if (now == 0) continue;
      if (now < gain) {
        queue.push({now, radius, s});
        continue;
      }
      chosen.push_back(s);
      for (size_t k = 0; k < reach[s]; ++k) is_covered[reaches_[s].samples[k].second] = 1;
    }
    return chosen;
  }

  size_t sample_count_;
  const std::vector<MedialSphere>& spheres_;
  std::vector<Reach> reaches_;
  double most_;
};

MedialSphere enclosing_sphere(std::span<const SurfaceSample> samples) {
  Box3d box;
  for (const SurfaceSample& s : samples) box.extend(s.position);
  MedialSphere all{box.centre(), 0};
  for (const SurfaceSample& s : samples) all.radius = std::max(all.radius, glm::length(s.position - all.centre));
  return all;
}

/// The parent of a sphere is the one whose surface it sticks out of least.
unsigned find_parent(const MedialSphere& child, const std::vector<SphereTree::Node>& parents) {
  const auto excess = [&](const SphereTree::Node& p) { return glm::length(p.sphere.centre - child.centre) - p.sphere.radius; };
  const auto best = std::min_element(parents.begin(), parents.end(), [&](const auto& a, const auto& b) { return excess(a) < excess(b); });
  return static_cast<unsigned>(best - parents.begin());
}

} // namespace

SphereTree build_sphere_tree(std::span<const SurfaceSample> dense, const TriangleTree& mesh, size_t spheres, bool may_use_fewer) {
  SphereTree tree;
  tree.levels.push_back({{enclosing_sphere(dense), 0}});
  const PointIndex<SurfaceSample> index(dense);
  const std::vector<MedialSphere> candidates = MedialSpheres(dense, mesh, index, k_candidates_per_sphere * spheres).result();
  if (candidates.empty()) {
    tree.levels.push_back({});
    return tree;
  }
  const Expander expander(dense, index, candidates, k_most_expansion);
  std::vector<size_t> sizes;
  for (size_t n = spheres; n > 4; n /= 8) sizes.insert(sizes.begin(), n);
  if (sizes.empty()) sizes.push_back(spheres);
  for (const size_t n : sizes) {
    std::vector<SphereTree::Node> level;
    for (const size_t s : expander.reduce(n, may_use_fewer ? k_close_expansion : 0))
      level.push_back({candidates[s], find_parent(candidates[s], tree.levels.back())});
    tree.levels.push_back(std::move(level));
  }
  return tree;
}

} // namespace kelpie
