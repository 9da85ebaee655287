#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/kind.h"
#include "colour/colour.h"
#include "materials/bsdf.h"
#include "materials/openpbr.h"

namespace kelpie {

/// A perfectly diffuse reflection (Lambert).
class MatteBsdf {
public:
  explicit MatteBsdf(const Vec3& albedo) : albedo_(albedo) {}

  const Vec3& albedo() const { return albedo_; }
  bool is_delta() const { return false; }
  bool is_glossy() const { return false; }
  MatteBsdf at_least_as_rough_as(float) const { return *this; }

  Vec3 evaluate(const Vec3& out, const Vec3& in) const { return albedo_ * pdf(out, in); }
  float pdf(const Vec3& out, const Vec3& in) const { return in.z <= 0 || out.z <= 0 ? 0 : in.z / k_pi; }
  BsdfSample sample(const Vec3& out, float, Vec2 u) const {
    if (out.z <= 0) return {};
    const float r = std::sqrt(u.x), phi = 2 * k_pi * u.y;
    const Vec3 in(r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.f, 1 - u.x)));
    return {in, albedo_, pdf(out, in)};
  }

private:
  static constexpr float k_pi = std::numbers::pi_v<float>;

  Vec3 albedo_;
};

template <class Mode>
struct Matte {
  static constexpr std::string_view k_name = "matte";
  static constexpr std::string_view k_doc = "A perfectly diffuse (Lambertian) surface.";

  Value<Mode, Colour> colour{Colour{Vec3(0.5f)}};

  static constexpr auto parameters() { return std::tuple{parameter("colour", &Matte::colour, "albedo").at_least(0).at_most(1)}; }

  // Sampled:
  SurfaceParameters surface() const {
    SurfaceParameters s;
    s.base_color = colour, s.specular_weight = 0;
    return s;
  }
  MatteBsdf bsdf() const { return MatteBsdf(colour.rgb); }
};

} // namespace kelpie
