// What every pattern is asked.
#pragma once

#include <concepts>
#include <span>

#include "materials/patterns/footprint.h"
#include "materials/patterns/ramp.h"

namespace kelpie {

/// A stop of what a pattern is where a scene says no stops.
struct PlainStop {
  float at;
  float red, green, blue; ///< scene-linear base_color
  float roughness;        ///< specular_roughness
  float height = 0;       ///< bump_height, in sizes of the pattern
};

/// A kind of pattern at one moment: a scalar function of space with values in [0, 1], and the stops that it ranges over
/// (`std::vector<Stop<Mode>> stops`, ascending).
template <class T>
concept Pattern = requires(const T pattern, const Vec3& p, const Footprint& footprint, std::span<float> shares) {
  /// The value at p; its mean over the footprint.
  { pattern.value(p, footprint) } -> std::same_as<float>;
  /// How much of each stop there is over the footprint, on the average: each >= 0, their sum 1. As many as there are stops.
  pattern.shares(p, footprint, shares);
  /// What it ranges over by default, ascending: a std::array<PlainStop, n>.
  { T::k_default_stops[0] } -> std::convertible_to<PlainStop>;
};

} // namespace kelpie
