#include "bench/knot_cloud.h"

#include <cmath>
#include <random>

namespace kelpie {

namespace {

constexpr double k_pi = 3.14159265358979;
constexpr double k_overlap = 20;
constexpr double k_tube_radius = 0.28;
/// The mean potential inside is overlap * weight * 24/105 (the mean of (1 - r^2)^2 over a ball is 24/105):
/// about twice the threshold, so that the surface is lumpy.
constexpr float k_weight = 0.45f;
constexpr double k_stray_share = 0.02;
constexpr float k_stray_weight = 2;

/// A (3, 4) torus knot, s in [0, 1].
Vec3d knot(double s) {
  const double a = 2 * k_pi * s, ring = 1 + 0.45 * std::cos(4 * a);
  return {ring * std::cos(3 * a), 0.55 * std::sin(4 * a), ring * std::sin(3 * a)};
}

double knot_length() {
  constexpr int k_steps = 4096;
  double sum = 0;
  for (int i = 0; i < k_steps; ++i) sum += glm::distance(knot(double(i) / k_steps), knot(double(i + 1) / k_steps));
  return sum;
}

/// std::uniform_real_distribution differs between libraries; this does not.
double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

Vec3d in_ball(std::mt19937_64& random, double radius) {
  for (;;) {
    Vec3d p;
    for (int i = 0; i < 3; ++i) p[i] = (2 * uniform(random) - 1) * radius;
    if (glm::length(p) <= radius) return p;
  }
}

} // namespace

BlobCloud make_knot_cloud(int count) {
  std::mt19937_64 random(1);
  const int strays = static_cast<int>(count * k_stray_share);
  const double volume = k_pi * k_tube_radius * k_tube_radius * knot_length();
  const double radius = std::cbrt(k_overlap * volume / (count - strays) * 3 / (4 * k_pi));
  BlobCloud cloud(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) {
    Blob& b = cloud[static_cast<size_t>(i)];
    const bool is_stray = i < strays;
    b.weight = is_stray ? k_stray_weight : k_weight;
    b.centre = Vec3(is_stray ? in_ball(random, 2) : knot(uniform(random)) + in_ball(random, k_tube_radius));
    b.radius = static_cast<float>(radius * (0.85 + 0.3 * uniform(random)));
  }
  return cloud;
}

double mean_overlap(const BlobCloud& cloud) {
  constexpr size_t k_samples = 200;
  const size_t step = std::max<size_t>(1, cloud.size() / k_samples);
  double total = 0, samples = 0;
  for (size_t i = 0; i < cloud.size(); i += step, ++samples)
    for (const Blob& b : cloud) total += glm::distance(cloud[i].centre, b.centre) < b.radius;
  return total / samples;
}

} // namespace kelpie
