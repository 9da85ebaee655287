#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/vec.h"
#include "materials/bsdf.h"

namespace kelpie {

/// A rough diffuse ground: energy-preserving Oren-Nayar (Portsmouth, Kutz and Hill 2025, "EON"). Roughness 0 is Lambert's. It
/// conserves energy and is reciprocal.
class DiffuseLobe {
public:
  DiffuseLobe() = default;
  /// `roughness` in [0, 1].
  DiffuseLobe(const Vec3& albedo, float roughness) : albedo_(albedo), roughness_(roughness) {}

  const Vec3& albedo() const { return albedo_; }

  /// bsdf * cosine, for directions above the surface.
  Vec3 evaluate(const Vec3& out, const Vec3& in) const { return reflectance(out, in) * pdf(in); }
  float pdf(const Vec3& in) const { return in.z / k_pi; }
  /// A direction by the cosine.
  static Vec3 sample(Vec2 u) {
    const float r = std::sqrt(u.x), phi = 2 * k_pi * u.y;
    return {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.f, 1 - u.x))};
  }
  /// pi * bsdf.
  Vec3 reflectance(const Vec3& out, const Vec3& in) const {
    if (roughness_ == 0) return albedo_;
    constexpr float k_mean = 2 / 3.f - 28 / (15 * k_pi);
    const float s = glm::dot(out, in) - out.z * in.z, over_t = s > 0 ? s / std::max(out.z, in.z) : s;
    const float a = 1 / (1 + k_flat * roughness_);
    const float lost_out = std::max(0.f, 1 - fujii_albedo(out.z)), lost_in = std::max(0.f, 1 - fujii_albedo(in.z));
    const float kept = a * (1 + k_mean * roughness_), lost = std::max(1e-6f, 1 - kept);
    // What meets a second facet takes the ground's colour once more, and so on.
    const Vec3 again = albedo_ * albedo_ * (kept / lost) / (Vec3(1) - albedo_ * lost);
    return albedo_ * (a * std::max(0.f, 1 + roughness_ * over_t)) + again * (lost_out * lost_in);
  }

private:
  static constexpr float k_pi = std::numbers::pi_v<float>;
  static constexpr float k_flat = 0.5f - 2 / (3 * k_pi);

  /// Of a white ground, without what meets a second facet (their appendix: an approximation within 0.1 %).
  float fujii_albedo(float cosine) const {
    const float c = 1 - cosine;
    const float g = c * (0.0571085289f + c * (0.491881867f + c * (-0.332181442f + c * 0.0714429953f)));
    return (1 + roughness_ * g) / (1 + k_flat * roughness_);
  }

  Vec3 albedo_{0};
  float roughness_ = 0;
};

} // namespace kelpie
