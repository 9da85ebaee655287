#include "morph/liquid/measure.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "base/point_index.h"
#include "morph/liquid/fit_samples.h"

namespace kelpie {

namespace {

constexpr size_t k_points = 5000;
constexpr double k_farthest = 0.05, k_outside = 0.02;
constexpr int k_steps = 50, k_halvings = 30;

/// How far off the surface is where there is none at all.
constexpr double k_nowhere = 1;

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

struct Crossing {
  double distance = k_farthest;
  Vec3d place{0};
};
const Vec3d& place_of(const Crossing& c) { return c.place; }

/// The nearest sign change of f - 1 on the line through p, within k_farthest.
Crossing crossing_along(const std::vector<Weighed>& near, const Vec3d& p, const Vec3d& direction) {
  const auto is_inside = [&](double t) { return sum_at(near, p + t * direction).value > 1; };
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
      return {std::abs(b), p + b * direction};
    }
  return {};
}

Crossing nearest_crossing(const std::vector<Weighed>& blobs, const SurfaceSample& s) {
  const std::vector<Weighed> near = within(blobs, s.position, k_farthest);
  const Crossing along_normal = crossing_along(near, s.position, s.normal);
  const Vec3d g = sum_at(near, s.position).gradient;
  const double steepness = glm::length(g);
  if (!(steepness > 0)) return along_normal;
  const Crossing along_gradient = crossing_along(near, s.position, g / steepness);
  return along_gradient.distance < along_normal.distance ? along_gradient : along_normal;
}

/// Of points without a crossing near: the way to the nearest crossing of another.
void find_far_surface(std::span<const SurfaceSample> samples, std::vector<Crossing>& all) {
  std::vector<Crossing> found;
  for (const Crossing& c : all)
    if (c.distance < k_farthest) found.push_back(c);
  const PointIndex<Crossing> index(found);
  for (size_t i = 0; i < all.size(); ++i) {
    if (all[i].distance < k_farthest) continue;
    const double way = found.empty() ? k_nowhere : glm::length(found[index.nearest(samples[i].position)].place - samples[i].position);
    all[i].distance = std::max(way, k_farthest);
  }
}

} // namespace

FitErrors measure_fit(const std::vector<Ellipsoid>& blobs, const Mesh& unit, const TriangleTree& tree, uint64_t seed) {
  std::vector<Weighed> weighed;
  for (const Ellipsoid& b : blobs) weighed.push_back({b, std::exp(b.log_weight), reach_of(b)});
  const std::vector<SurfaceSample> samples = random_samples(unit, k_points, seed);
  const PointIndex<SurfaceSample> index(samples);
  std::vector<Crossing> crossings;
  for (const SurfaceSample& s : samples) crossings.push_back(nearest_crossing(weighed, s));
  find_far_surface(samples, crossings);
  FitErrors e;
  double squares = 0, angles = 0;
  size_t lost = 0, outside = 0, spurs = 0, normals = 0;
  for (size_t i = 0; i < samples.size(); ++i) {
    const SurfaceSample& s = samples[i];
    const Crossing& found = crossings[i];
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
