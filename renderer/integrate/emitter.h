// What a light is asked.
#pragma once

#include <concepts>
#include <limits>

#include "base/vec.h"

namespace kelpie {

inline constexpr float k_infinitely_far = std::numeric_limits<float>::infinity();

/// Light that arrives at a point from one direction.
struct Arrival {
  Vec3 direction{0}; ///< towards the light, unit
  Vec3 radiance{0};  ///< irradiance across the direction, where `is_delta`
  float pdf = 0;     ///< of sampling the direction, per solid angle; 0: no sample
  bool is_delta = false;
  float distance = k_infinitely_far; ///< of what shines
};

/// What a kind of light answers once it is ready for a frame.
template <class T>
concept Emitter = requires(const T& emitter, const Vec3& p, Vec2 u, const Vec3& direction) {
  /// Light at p from a direction by importance, for u in [0, 1)^2.
  { emitter.sample(p, u) } -> std::same_as<Arrival>;
  /// What a ray from p that meets nothing before sees of this light, and how likely `sample` is to choose its direction.
  { emitter.seen_along(p, direction) } -> std::same_as<Arrival>;
  /// Whether all light at a point comes from one direction, which no ray finds by chance.
  { emitter.is_delta() } -> std::same_as<bool>;
  /// Whether it is infinitely far away, behind everything.
  { emitter.is_distant() } -> std::same_as<bool>;
  /// Whether the camera sees it behind everything, where the film's background is `environment`.
  { emitter.is_background() } -> std::same_as<bool>;
  /// Whether the camera sees it in its place.
  { emitter.is_visible() } -> std::same_as<bool>;
  /// Whether rays towards it run side by side where they start side by side: such rays are traced as packets.
  { emitter.is_narrow() } -> std::same_as<bool>;
  /// Whether it comes so evenly from all around that the scattered rays of a matte surface find it as well as samples of it do.
  { emitter.is_even() } -> std::same_as<bool>;
};

} // namespace kelpie
