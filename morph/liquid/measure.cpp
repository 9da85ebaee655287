#include "morph/liquid/measure.h"
#include "base/point_index.h"

#include <algorithm>
#include <cmath>

namespace kelpie {

namespace {

constexpr size_t k_points = 5000;
constexpr double k_farthest = 0.05, k_outside = 0.02;
constexpr int k_steps = 50, k_halvings = 30;

/// Distance from p to the nearest sign change of f - 1 on the line through it.
double distance_along(const std::vector<BlobParameters>& near, const Vec3d& p, const Vec3d& direction) {
  const auto is_inside = [&](double t) { return evaluate(near, p + t * direction).value > 1; };
  const bool at_start = is_inside(0);
  const double step = k_farthest / k_steps;
  for (int i = 1; i <= k_steps; ++i)
    for (const double side : {1.0, -1.0}) {
      double a = side * step * (i - 1), b = side * step * i; // up to a nothing has changed
      if (is_inside(b) == at_start) continue;
      for (int k = 0; k < k_halvings; ++k) {
        const double m = 0.5 * (a + b);
        (is_inside(m) == at_start ? a : b) = m;
      }
      return std::abs(b);
    }
  return k_farthest;
}

double distance_to_surface(const std::vector<BlobParameters>& blobs, const SurfaceSample& s) {
  std::vector<BlobParameters> near;
  for (const BlobParameters& b : blobs)
    if (glm::length(s.position - centre_of(b)) < std::exp(b[3]) + k_farthest) near.push_back(b);
  const double along_normal = distance_along(near, s.position, s.normal);
  const Vec3d g = evaluate(near, s.position).gradient;
  const double steepness = glm::length(g);
  return steepness > 0 ? std::min(along_normal, distance_along(near, s.position, g / steepness)) : along_normal;
}

} // namespace

FitErrors measure_fit(const std::vector<BlobParameters>& blobs, const Mesh& unit, const TriangleTree& tree, uint64_t seed) {
  const std::vector<SurfaceSample> samples = random_samples(unit, k_points, seed);
  const PointIndex<SurfaceSample> index(samples);
  FitErrors e;
  double squares = 0;
  size_t lost = 0, outside = 0, spurs = 0;
  for (const SurfaceSample& s : samples) {
    const double d = distance_to_surface(blobs, s);
    squares += d * d, e.max = std::max(e.max, d), lost += d >= k_farthest;
    const Vec3d out = s.position + k_outside * s.normal;
    if (glm::length(samples[index.nearest(out)].position - out) < 0.7 * k_outside || tree.winding(out) > 0.5) continue;
    ++outside;
    spurs += evaluate(blobs, out).value > 1;
  }
  const double n = static_cast<double>(samples.size());
  e.rms = std::sqrt(squares / n), e.lost = static_cast<double>(lost) / n;
  e.spurs = static_cast<double>(spurs) / static_cast<double>(std::max<size_t>(outside, 1));
  return e;
}

} // namespace kelpie
