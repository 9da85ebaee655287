#include "renderer/integrate/bsdf.h"

#include <cmath>

namespace kelpie {

namespace {

constexpr float k_pi = 3.14159265358979f;
/// Below this width the lobe is narrower than float directions can tell: a mirror.
constexpr float k_min_alpha = 1e-3f;

/// Density of GGX normals (Walter et al. 2007, eq. 33).
float ggx_density(const Vec3& m, float alpha) {
  const float a2 = alpha * alpha, t = m.z * m.z * (a2 - 1) + 1;
  return a2 / (k_pi * t * t);
}

/// Smith's Lambda: G1 = 1 / (1 + Lambda).
float smith_lambda(const Vec3& v, float alpha) {
  const float z2 = v.z * v.z;
  return 0.5f * (std::sqrt(1 + alpha * alpha * (1 - z2) / z2) - 1);
}

/// A normal as seen from `out` (Heitz 2018, "Sampling the GGX distribution of visible normals").
Vec3 sample_visible_normal(const Vec3& out, float alpha, Vec2 u) {
  const Vec3 stretched = glm::normalize(Vec3(alpha * out.x, alpha * out.y, out.z));
  const float flat2 = stretched.x * stretched.x + stretched.y * stretched.y;
  const Vec3 t1 = flat2 > 0 ? Vec3(-stretched.y, stretched.x, 0) / std::sqrt(flat2) : Vec3(1, 0, 0);
  const Vec3 t2 = glm::cross(stretched, t1);
  const float r = std::sqrt(u.x), phi = 2 * k_pi * u.y;
  const float a = r * std::cos(phi), s = 0.5f * (1 + stretched.z);
  const float b = (1 - s) * std::sqrt(std::max(0.f, 1 - a * a)) + s * r * std::sin(phi);
  const Vec3 n = a * t1 + b * t2 + std::sqrt(std::max(0.f, 1 - a * a - b * b)) * stretched;
  return glm::normalize(Vec3(alpha * n.x, alpha * n.y, std::max(1e-6f, n.z)));
}

Vec3 sample_cosine(Vec2 u) {
  const float r = std::sqrt(u.x), phi = 2 * k_pi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.f, 1 - u.x))};
}

} // namespace

Bsdf::Bsdf(const SurfaceKinds::Variant<SampledMode>& surface) {
  if (const auto* matte = std::get_if<Matte<SampledMode>>(&surface)) {
    colour_ = matte->colour.rgb;
  } else {
    const auto& metal = std::get<Metal<SampledMode>>(surface);
    colour_ = metal.colour.rgb;
    is_metal_ = true;
    const float alpha = metal.roughness * metal.roughness;
    alpha_ = alpha < k_min_alpha ? 0 : alpha;
  }
}

/// Schlick's approximation.
Vec3 Bsdf::fresnel(float cosine) const {
  const float c = 1 - std::min(std::max(cosine, 0.f), 1.f), c2 = c * c;
  return colour_ + (Vec3(1) - colour_) * (c2 * c2 * c);
}

Vec3 Bsdf::evaluate(const Vec3& out, const Vec3& in) const {
  if (in.z <= 0 || out.z <= 0 || is_delta()) return Vec3(0);
  if (!is_metal_) return colour_ * (in.z / k_pi);
  const Vec3 m = glm::normalize(out + in);
  const float g2 = 1 / (1 + smith_lambda(out, alpha_) + smith_lambda(in, alpha_));
  return fresnel(glm::dot(out, m)) * (ggx_density(m, alpha_) * g2 / (4 * out.z));
}

float Bsdf::pdf(const Vec3& out, const Vec3& in) const {
  if (in.z <= 0 || out.z <= 0 || is_delta()) return 0;
  if (!is_metal_) return in.z / k_pi;
  const Vec3 m = glm::normalize(out + in);
  return ggx_density(m, alpha_) / ((1 + smith_lambda(out, alpha_)) * 4 * out.z);
}

BsdfSample Bsdf::sample(const Vec3& out, Vec2 u) const {
  BsdfSample s;
  if (out.z <= 0) return s;
  if (!is_metal_) {
    s.direction = sample_cosine(u);
    s.weight = colour_, s.pdf = s.direction.z / k_pi;
    return s;
  }
  const Vec3 m = alpha_ == 0 ? Vec3(0, 0, 1) : sample_visible_normal(out, alpha_, u);
  s.direction = 2 * glm::dot(out, m) * m - out;
  if (s.direction.z <= 0) return s;
  const Vec3 f = fresnel(glm::dot(out, m));
  if (alpha_ == 0) {
    s.weight = f, s.pdf = 1, s.is_delta = true;
    return s;
  }
  const float lambda = smith_lambda(out, alpha_);
  s.weight = f * ((1 + lambda) / (1 + lambda + smith_lambda(s.direction, alpha_)));
  s.pdf = ggx_density(m, alpha_) / ((1 + lambda) * 4 * out.z);
  return s;
}

} // namespace kelpie
