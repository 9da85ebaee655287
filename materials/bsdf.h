// What a reflectance model answers at one point of a surface.
//
// Directions are unit vectors in the local frame of the surface: z is the normal on the side of the viewer, so the direction
// `out`, to the viewer, has z > 0. The direction `in`, to where light comes from, has z > 0 where light is reflected and z < 0
// where it is transmitted.
#pragma once

#include <algorithm>
#include <concepts>

#include "base/vec.h"

namespace kelpie {

/// The largest component.
inline float largest(const Vec3& v) { return std::max({v.x, v.y, v.z}); }

/// A direction that a model chose to look for light in.
struct BsdfSample {
  Vec3 direction{0};       ///< `in`
  Vec3 weight{0};          ///< bsdf * |cosine of in| / pdf
  float pdf = 0;           ///< per solid angle; of a delta lobe the probability that it is chosen; 0: no sample
  bool is_delta = false;   ///< of a lobe with one direction only: no sample of a light can match it
  float eta = 1;           ///< refractive index on the side of `direction` over that on the side of the viewer
  bool goes_below = false; ///< light wanders below the surface from here, at first in `direction`; then `pdf` is a probability

  bool is_transmitted() const { return direction.z < 0; }
};

/// A reflectance model with its parameters, at one point. A kind of surface makes one of its own parameters: `bsdf()`.
template <class T>
concept BsdfModel = std::copyable<T> && requires(const T& model, const Vec3& out, const Vec3& in, float lobe, Vec2 u, float alpha) {
  /// What the surface reflects and transmits of light from all around, about: a channel of the picture.
  { model.albedo() } -> std::convertible_to<Vec3>;
  /// Whether all lobes are deltas: samples of lights are in vain.
  { model.is_delta() } -> std::same_as<bool>;
  /// Whether some lobe is narrower than that of a matte surface: sampled directions then look for light too.
  { model.is_glossy() } -> std::same_as<bool>;
  /// The same with a GGX width of at least `alpha` where it is glossy.
  { model.at_least_as_rough_as(alpha) } -> std::same_as<T>;
  /// bsdf * |cosine of in|, without deltas.
  { model.evaluate(out, in) } -> std::convertible_to<Vec3>;
  /// The density with which `sample` chooses `in`, without deltas and without what goes below; its integral over the sphere is at most 1.
  { model.pdf(out, in) } -> std::same_as<float>;
  /// `lobe` in [0, 1) chooses among lobes, `u` in [0, 1)^2 a direction in one.
  { model.sample(out, lobe, u) } -> std::same_as<BsdfSample>;
};

} // namespace kelpie
