#pragma once

#include <algorithm>
#include <cmath>

#include "materials/patterns/footprint.h"
#include "materials/patterns/noise.h"

namespace kelpie {

/// Where a pattern is looked at, in units of its size.
struct Place {
  Vec3 p{0};
  Footprint footprint{};
  float blur = 0; ///< variance of p in every direction beside that of the footprint

  /// The variance of something with this gradient.
  float variance(const Vec3& gradient) const {
    const float along_u = glm::dot(gradient, footprint.u), along_v = glm::dot(gradient, footprint.v);
    return (along_u * along_u + along_v * along_v) / 12 + glm::dot(gradient, gradient) * blur;
  }
  /// That of something whose gradient has length 1, the mean over its directions.
  float mean_variance() const { return (glm::dot(footprint.u, footprint.u) + glm::dot(footprint.v, footprint.v)) / 36 + blur; }
  /// The narrower side.
  float width() const { return std::sqrt(std::min(glm::dot(footprint.u, footprint.u), glm::dot(footprint.v, footprint.v)) + 12 * blur); }
  /// A width between both sides': what is as wide as this cannot be told by its slope at one point.
  float blind_width() const {
    const float longer2 = std::max(glm::dot(footprint.u, footprint.u), glm::dot(footprint.v, footprint.v));
    return std::max(width(), 0.65f * std::sqrt(longer2 + 12 * blur));
  }
  Place scaled(float factor) const { return {p * factor, {footprint.u * factor, footprint.v * factor}, blur * factor * factor}; }

  /// Drawn out along a unit vector by one factor, across it by another.
  Place scaled(const Vec3& along, float factor_along, float factor_across) const {
    const auto drawn = [&](const Vec3& v) { return factor_across * v + ((factor_along - factor_across) * glm::dot(along, v)) * along; };
    const float most = std::max(factor_along, factor_across);
    return {drawn(p), {drawn(footprint.u), drawn(footprint.v)}, blur * most * most};
  }
  /// In a space where a lattice is not along the axes.
  Place turned() const { return {kelpie::turned(p), {kelpie::turned(footprint.u), kelpie::turned(footprint.v)}, blur}; }

  NoiseSample noise(const Fractal& fractal) const { return fractal_noise(p, footprint, fractal, blur); }
  /// The part of the footprint where noise is above a threshold; `softness` is the standard deviation of that.
  float part_above(float threshold, float softness, const Fractal& fractal) const {
    const NoiseSample sample = noise(fractal);
    return normal_below((sample.value - threshold) / std::sqrt(softness * softness + sample.variance + variance(sample.gradient)));
  }

  /// Moved by a random vector: each component has the standard deviation `amount`, and features `size` wide.
  Place displaced(float amount, float size, float octaves, uint32_t seed) const {
    if (amount == 0) return *this;
    Place moved = *this;
    const Place noise_place = scaled(1 / size);
    float variance = 0;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const NoiseSample noise = noise_place.noise({.octaves = octaves, .seed = seed + 100 * axis});
      const Vec3 slope = noise.gradient * (amount / size);
      moved.p[axis] += amount * noise.value;
      moved.footprint.u[axis] += glm::dot(slope, footprint.u);
      moved.footprint.v[axis] += glm::dot(slope, footprint.v);
      variance += noise.variance;
    }
    moved.blur += amount * amount * variance / 3;
    return moved;
  }
};

} // namespace kelpie
