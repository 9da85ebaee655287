#pragma once

#include "base/kind.h"
#include "colour/colour.h"
#include "materials/bsdf.h"
#include "materials/ggx.h"
#include "materials/openpbr.h"

namespace kelpie {

/// A reflection by GGX microfacets (Walter et al. 2007) under Schlick's Fresnel term. Light that meets a second microfacet is lost.
class MetalBsdf {
public:
  /// `reflectance` at normal incidence. A width below k_least_alpha is that of a mirror.
  MetalBsdf(const Vec3& reflectance, float alpha) : reflectance_(reflectance), alpha_(alpha < k_least_alpha ? 0 : alpha) {}

  const Vec3& albedo() const { return reflectance_; }
  bool is_delta() const { return alpha_ == 0; }
  bool is_glossy() const { return true; }
  MetalBsdf at_least_as_rough_as(float alpha) const { return {reflectance_, std::max(alpha_, alpha)}; }

  Vec3 evaluate(const Vec3& out, const Vec3& in) const {
    if (in.z <= 0 || out.z <= 0 || is_delta()) return Vec3(0);
    const Vec3 m = glm::normalize(out + in);
    const float g2 = 1 / (1 + smith_lambda(out, alpha_) + smith_lambda(in, alpha_));
    return fresnel(glm::dot(out, m)) * (ggx_density(m, alpha_) * g2 / (4 * out.z));
  }

  float pdf(const Vec3& out, const Vec3& in) const {
    if (in.z <= 0 || out.z <= 0 || is_delta()) return 0;
    return density(out, glm::normalize(out + in));
  }

  BsdfSample sample(const Vec3& out, float, Vec2 u) const {
    if (out.z <= 0) return {};
    const Vec3 m = is_delta() ? Vec3(0, 0, 1) : sample_visible_normal(out, alpha_, u);
    const Vec3 in = 2 * glm::dot(out, m) * m - out;
    if (in.z <= 0) return {};
    const Vec3 f = fresnel(glm::dot(out, m));
    if (is_delta()) return {in, f, 1, true};
    const float lambda = smith_lambda(out, alpha_);
    return {in, f * ((1 + lambda) / (1 + lambda + smith_lambda(in, alpha_))), density(out, m)};
  }

private:
  /// Schlick's approximation.
  Vec3 fresnel(float cosine) const {
    const float c = 1 - std::min(std::max(cosine, 0.f), 1.f), c2 = c * c;
    return reflectance_ + (Vec3(1) - reflectance_) * (c2 * c2 * c);
  }
  /// Per solid angle of the direction that a microfacet of normal `m` reflects `out` to.
  float density(const Vec3& out, const Vec3& m) const { return ggx_density(m, alpha_) / ((1 + smith_lambda(out, alpha_)) * 4 * out.z); }

  Vec3 reflectance_;
  float alpha_; ///< GGX width; 0: a mirror
};

template <class Mode>
struct Metal {
  static constexpr std::string_view k_name = "metal";
  static constexpr std::string_view k_doc =
      R"(A metal: GGX microfacets (Walter et al. 2007; visible normals after Heitz 2018) under Schlick's Fresnel term.

The default is polished chrome; `"colour": [1.0, 0.77, 0.34]` is gold.)";

  Value<Mode, Colour> colour{Colour{Vec3(0.9f)}};
  Value<Mode, float> roughness{0.1f};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("colour", &Metal::colour, "reflectance at normal incidence").at_least(0).at_most(1),
        parameter("roughness", &Metal::roughness, "0 is a mirror, 1 is dull; the microfacets' alpha is its square").at_least(0).at_most(1),
    };
  }

  // Sampled:
  SurfaceParameters surface() const {
    SurfaceParameters s;
    s.base_color = colour, s.base_metalness = 1, s.specular_roughness = roughness;
    return s;
  }
  MetalBsdf bsdf() const { return {colour.rgb, roughness * roughness}; }
};

} // namespace kelpie
