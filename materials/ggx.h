// GGX microfacets: normals m of a rough surface, in its local frame. `alpha` is their width, above 0.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/vec.h"

namespace kelpie {

/// Below this width a lobe is narrower than float directions can tell: a mirror.
inline constexpr float k_least_alpha = 1e-3f;

/// Density of the normals (Walter et al. 2007, eq. 33).
inline float ggx_density(const Vec3& m, float alpha) {
  const float a2 = alpha * alpha, t = m.z * m.z * (a2 - 1) + 1;
  return a2 / (std::numbers::pi_v<float> * t * t);
}

/// Smith's Lambda of a direction: G1 = 1 / (1 + Lambda).
inline float smith_lambda(const Vec3& v, float alpha) {
  const float z2 = v.z * v.z;
  return 0.5f * (std::sqrt(1 + alpha * alpha * (1 - z2) / z2) - 1);
}

/// A normal as seen from `out` (Heitz 2018, "Sampling the GGX distribution of visible normals").
inline Vec3 sample_visible_normal(const Vec3& out, float alpha, Vec2 u) {
  const Vec3 stretched = glm::normalize(Vec3(alpha * out.x, alpha * out.y, out.z));
  const float flat2 = stretched.x * stretched.x + stretched.y * stretched.y;
  const Vec3 t1 = flat2 > 0 ? Vec3(-stretched.y, stretched.x, 0) / std::sqrt(flat2) : Vec3(1, 0, 0);
  const Vec3 t2 = glm::cross(stretched, t1);
  const float r = std::sqrt(u.x), phi = 2 * std::numbers::pi_v<float> * u.y;
  const float a = r * std::cos(phi), s = 0.5f * (1 + stretched.z);
  const float b = (1 - s) * std::sqrt(std::max(0.f, 1 - a * a)) + s * r * std::sin(phi);
  const Vec3 n = a * t1 + b * t2 + std::sqrt(std::max(0.f, 1 - a * a - b * b)) * stretched;
  return glm::normalize(Vec3(alpha * n.x, alpha * n.y, std::max(1e-6f, n.z)));
}

} // namespace kelpie
