#include "morph/liquid/fit_samples.h"

#include <algorithm>
#include <cmath>

namespace kelpie {

namespace {

/// A ball is free if nothing is nearer to its centre than this share of its radius: facets are not the surface.
constexpr double k_free = 0.9;
constexpr int k_halvings = 7;
constexpr double k_least_ball = 0.0005, k_most_ball = 0.5;

/// The largest free ball that touches the surface at p, its centre in direction `away`, up to a radius of `most`.
double free_ball(const TriangleTree& tree, const Vec3d& p, const Vec3d& away, double most) {
  const auto is_free = [&](double r) { return tree.distance(p + r * away, r) >= k_free * r; };
  if (is_free(most)) return most;
  double low = 0, high = most;
  for (int k = 0; k < k_halvings; ++k) {
    const double middle = 0.5 * (low + high);
    (is_free(middle) ? low : high) = middle;
  }
  return low;
}

} // namespace

std::vector<FitSample> fit_samples(const Mesh& unit, const TriangleTree& tree, size_t count, uint64_t seed) {
  std::vector<FitSample> samples;
  for (const SurfaceSample& on_surface : spread_samples(unit, count, seed, Sides::apart)) {
    FitSample s{on_surface};
    const double through = tree.way_out(s.position - 1e-7 * s.normal, -s.normal, 0.02);
    s.inner = free_ball(tree, s.position, -s.normal, std::min(0.5 * through, k_most_ball));
    if (!(s.inner > k_least_ball)) continue;
    s.outer = free_ball(tree, s.position, s.normal, k_most_outer);
    samples.push_back(s);
  }
  return samples;
}

} // namespace kelpie
