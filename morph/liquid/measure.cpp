#include "morph/liquid/measure.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/point_index.h"
#include "morph/liquid/fit_samples.h"

namespace kelpie {

namespace {

constexpr size_t k_points = 5000;
constexpr double k_farthest = 0.05, k_outside = 0.02;
constexpr int k_steps = 50, k_halvings = 30;

/// Beyond `k_farthest` steps grow by this factor, up to the diagonal.
constexpr double k_step_growth = 1.1, k_nowhere = 1;

/// A blob, with what takes long to find.
struct Weighed {
  Ellipsoid blob;
  double weight, reach; ///< of a ball that holds it
};

BlobValue sum_at(const std::vector<Weighed>& blobs, const Vec3d& p) {
  BlobValue sum;
  for (const Weighed& b : blobs) add_value(b.blob, b.weight, b.blob.to_ball * (p - b.blob.centre), sum);
  return sum;
}

std::vector<Weighed> within(const std::vector<Weighed>& blobs, const Vec3d& p, double distance) {
  std::vector<Weighed> near;
  for (const Weighed& b : blobs)
    if (const Vec3d d = p - b.blob.centre; glm::dot(d, d) < std::pow(b.reach + distance, 2)) near.push_back(b);
  return near;
}

/// Distance from p to the nearest sign change of f - 1 on the line through it, up to `most`, which is returned where there is none; the
/// place goes to `crossing`.
double distance_along(const std::vector<Weighed>& near, const Vec3d& p, const Vec3d& direction, double most, Vec3d& crossing) {
  const auto is_inside = [&](double t) { return sum_at(near, p + t * direction).value > 1; };
  const bool at_start = is_inside(0);
  double from = 0, step = k_farthest / k_steps;
  while (from < most * (1 - 1e-9)) {
    const double to = std::min(from + step, most);
    for (const double side : {1.0, -1.0}) {
      double a = side * from, b = side * to; // up to a nothing has changed
      if (is_inside(b) == at_start) continue;
      for (int k = 0; k < k_halvings; ++k) {
        const double m = 0.5 * (a + b);
        (is_inside(m) == at_start ? a : b) = m;
      }
      crossing = p + b * direction;
      return std::abs(b);
    }
    from = to;
    if (from > k_farthest) step *= k_step_growth;
  }
  return most;
}

struct Nearest {
  double distance;
  Vec3d place{0};
};

Nearest nearest_surface(const std::vector<Weighed>& blobs, const SurfaceSample& s) {
  Nearest best{k_farthest};
  const auto look = [&](const std::vector<Weighed>& near, const Vec3d& direction, double most) {
    Vec3d place(0);
    if (const double d = distance_along(near, s.position, direction, most, place); d < best.distance) best = {d, place};
  };
  const std::vector<Weighed> near = within(blobs, s.position, k_farthest);
  look(near, s.normal, k_farthest);
  const Vec3d g = sum_at(near, s.position).gradient;
  const double steepness = glm::length(g);
  if (steepness > 0) look(near, g / steepness, k_farthest);
  if (best.distance < k_farthest) return best;
  best.distance = k_nowhere;
  for (const Vec3d& direction : {s.normal, Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)}) look(blobs, direction, k_nowhere);
  return best;
}

} // namespace

FitErrors measure_fit(const std::vector<Ellipsoid>& blobs, const Mesh& unit, const TriangleTree& tree, uint64_t seed) {
  std::vector<Weighed> weighed;
  for (const Ellipsoid& b : blobs) weighed.push_back({b, std::exp(b.log_weight), reach_of(b)});
  const std::vector<SurfaceSample> samples = random_samples(unit, k_points, seed);
  const PointIndex<SurfaceSample> index(samples);
  FitErrors e;
  double squares = 0, angles = 0;
  size_t lost = 0, outside = 0, spurs = 0, normals = 0;
  for (const SurfaceSample& s : samples) {
    const Nearest found = nearest_surface(weighed, s);
    squares += found.distance * found.distance, e.max = std::max(e.max, found.distance);
    if (found.distance >= k_farthest) {
      ++lost;
    } else if (has_normal(s)) {
      const Vec3d g = sum_at(within(weighed, found.place, 0), found.place).gradient;
      const double angle = std::atan2(glm::length(glm::cross(g, s.smooth)), -glm::dot(g, s.smooth));
      angles += angle * angle, ++normals;
    }
    const Vec3d out = s.position + k_outside * s.normal;
    if (glm::length(samples[index.nearest(out)].position - out) < 0.7 * k_outside || tree.winding(out) > 0.5) continue;
    ++outside;
    spurs += sum_at(within(weighed, out, 0), out).value > 1;
  }
  const double n = static_cast<double>(samples.size());
  e.rms = std::sqrt(squares / n), e.lost = static_cast<double>(lost) / n;
  e.normals = std::sqrt(angles / static_cast<double>(std::max<size_t>(normals, 1))) * 180 / std::numbers::pi;
  e.spurs = static_cast<double>(spurs) / static_cast<double>(std::max<size_t>(outside, 1));
  return e;
}

} // namespace kelpie
