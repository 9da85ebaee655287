// How much light a smooth surface reflects. Cosines are those of the angle between the light and the normal, on the viewer's
// side, at least 0; `eta` is the index of refraction beyond the surface over that on the viewer's side.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec.h"

namespace kelpie {

/// The cosine beyond the surface (Snell's law); 0 where all light is reflected.
inline float refracted_cosine(float cosine, float eta) { return std::sqrt(std::max(0.f, 1 - (1 - cosine * cosine) / (eta * eta))); }

/// Of unpolarised light at a dielectric; 1 where it is totally reflected.
inline float fresnel_dielectric(float cosine, float eta) {
  const float beyond = refracted_cosine(cosine, eta);
  if (beyond <= 0) return 1;
  const float s = (cosine - eta * beyond) / (cosine + eta * beyond), p = (eta * cosine - beyond) / (eta * cosine + beyond);
  return 0.5f * (s * s + p * p);
}

/// Straight on.
inline float fresnel_at_normal(float eta) {
  const float r = (eta - 1) / (eta + 1);
  return r * r;
}

/// The eta that reflects `weight` times as much straight on (OpenPBR 1.1, eq. 25 and 26).
inline float modulated_eta(float eta, float weight) {
  if (weight == 1) return eta;
  constexpr float k_most = 0.98f; // the rest is a mirror
  const float r = std::copysign(std::sqrt(std::min(weight * fresnel_at_normal(eta), k_most)), eta - 1);
  return (1 + r) / (1 - r);
}

/// The mean over a cosine-weighted hemisphere, for eta >= 1 (Kulla and Conty 2017).
inline float mean_fresnel(float eta) { return (eta - 1) / (4.08567f + 1.00071f * eta); }

/// Of a metal: Schlick's approximation, made darker towards the edge so that at 82 degrees it is `tint` times as bright
/// (Kutz, Hasan and Edmondson 2021, "Novel aspects of the Adobe Standard Material", F82-tint).
class F82Tint {
public:
  F82Tint() = default;
  F82Tint(const Vec3& at_normal, const Vec3& tint) : at_normal_(at_normal), dip_(schlick(k_cosine) * (Vec3(1) - tint) / dip(k_cosine)) {}

  const Vec3& at_normal() const { return at_normal_; }
  Vec3 operator()(float cosine) const { return glm::max(schlick(cosine) - dip(cosine) * dip_, Vec3(0)); }

private:
  static constexpr float k_cosine = 1 / 7.f; // of 82 degrees, where the dip is deepest

  static float power_5(float x) { return x * x * (x * x) * x; }
  static float dip(float cosine) { return cosine * power_5(1 - cosine) * (1 - cosine); }
  Vec3 schlick(float cosine) const { return at_normal_ + (Vec3(1) - at_normal_) * power_5(1 - cosine); }

  Vec3 at_normal_{0}, dip_{0};
};

} // namespace kelpie
