#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/vec.h"

namespace kelpie {

/// GGX microfacets: the normals m of a rough surface (Walter et al. 2007; anisotropic: Heitz 2014), in its local frame. A surface
/// below the least width is smooth: one normal, z, because float directions cannot tell lobes that narrow from it.
class Ggx {
public:
  static constexpr float k_least_alpha = 1e-3f;

  /// `alpha`: width along x, along y.
  explicit Ggx(Vec2 alpha) : alpha_(std::max(alpha.x, alpha.y) < k_least_alpha ? Vec2(0) : glm::max(alpha, Vec2(k_least_alpha))) {}
  explicit Ggx(float alpha) : Ggx(Vec2(alpha)) {}
  Ggx() : alpha_(0) {}

  bool is_smooth() const { return alpha_.x == 0; }
  Ggx at_least_as_rough_as(float alpha) const { return Ggx(glm::max(alpha_, Vec2(alpha))); }
  /// The same with normals spread further, evenly: twice the variance of their slopes in a direction, which adds to alpha^2.
  Ggx widened(float by) const { return Ggx(glm::max(alpha_, glm::min(glm::sqrt(alpha_ * alpha_ + by), Vec2(1)))); }
  /// The width of isotropic microfacets that lose about as much light where they meet each other.
  float mean_alpha() const { return alpha_.x == alpha_.y ? alpha_.x : std::sqrt(0.5f * (alpha_.x * alpha_.x + alpha_.y * alpha_.y)); }

  /// Density of the normals (Walter eq. 33, Heitz eq. 85); its integral times m.z is 1.
  float density(const Vec3& m) const {
    const float x = m.x / alpha_.x, y = m.y / alpha_.y, t = x * x + y * y + m.z * m.z;
    return 1 / (std::numbers::pi_v<float> * alpha_.x * alpha_.y * t * t);
  }
  /// Smith's Lambda of a direction on either side: G1 = 1 / (1 + Lambda).
  float lambda(const Vec3& v) const {
    const float x = alpha_.x * v.x, y = alpha_.y * v.y;
    return 0.5f * (std::sqrt(1 + (x * x + y * y) / (v.z * v.z)) - 1);
  }

  /// The least share of visible normals that contains all which reflect `out` upwards (Eto and Tokuyoshi 2023, eq. 5).
  float reflecting_share(const Vec3& out) const {
    const float a = std::min(1.f, std::min(alpha_.x, alpha_.y)), s = 1 + std::sqrt(out.x * out.x + out.y * out.y);
    const float a2 = a * a, s2 = s * s;
    return (1 - a2) * s2 / (s2 + a2 * out.z * out.z);
  }
  /// A normal as seen from `out`, of the given share of them: a point of a spherical cap (Dupuy and Benyoub 2023).
  Vec3 sample_visible(const Vec3& out, float share, Vec2 u) const {
    const Vec3 stretched = glm::normalize(Vec3(alpha_.x * out.x, alpha_.y * out.y, out.z));
    const float lowest = share * stretched.z, z = (1 - u.y) * (1 + lowest) - lowest;
    const float sine = std::sqrt(std::max(0.f, 1 - z * z)), phi = 2 * std::numbers::pi_v<float> * u.x;
    const Vec3 m = stretched + Vec3(sine * std::cos(phi), sine * std::sin(phi), z);
    return glm::normalize(Vec3(alpha_.x * m.x, alpha_.y * m.y, std::max(1e-6f, m.z)));
  }
  /// density(m) * this * dot(out, m) is the density with which sample_visible chooses m.
  float visible_factor(const Vec3& out, float share) const {
    return 2 / (share * out.z + glm::length(Vec3(alpha_.x * out.x, alpha_.y * out.y, out.z)));
  }

private:
  Vec2 alpha_; ///< 0: smooth
};

} // namespace kelpie
