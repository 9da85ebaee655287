#include "materials/coat.h"

namespace kelpie {

namespace {

/// What a smooth dielectric reflects of light that comes from all around inside it; eta is its index over that outside.
float mean_fresnel_inside(float eta) { return eta < 1 ? mean_fresnel(1 / eta) : 1 - (1 - mean_fresnel(eta)) / (eta * eta); }

} // namespace

Coat::Coat(const SurfaceParameters& s, float ior_near)
    : weight_(s.coat_weight), eta_(s.coat_ior / ior_near), colour_(s.coat_color.rgb), darkening_(s.coat_darkening) {
  SpecularLobe::Parameters p;
  p.facets = Ggx(s.coat_roughness * s.coat_roughness), p.eta = p.fresnel_eta = eta_;
  lobe_ = SpecularLobe(p);
  const float clear = s.transmission_weight * (1 - s.base_metalness);
  base_albedo_ = s.base_color.rgb * (s.base_weight * (1 - clear));
  base_diffuse_ = glm::mix(1.f, s.specular_roughness, s.base_metalness);
}

float Coat::ior_above_base(const SurfaceParameters& s, float ior_near) { return glm::mix(ior_near, s.coat_ior, s.coat_weight); }

// As if the widths of two blurs added up: roughness^4 is the square of alpha.
float Coat::base_roughness(const SurfaceParameters& s) {
  const float base = s.specular_roughness, coat = s.coat_roughness * s.coat_roughness;
  if (s.coat_weight == 0 || coat == 0) return base;
  return glm::mix(base, std::min(1.f, std::pow(base * base * base * base + 2 * coat * coat, 0.25f)), s.coat_weight);
}

/// Light that the base throws back is in part thrown down by the coat, and so on: what is left of it, by how bright the base is.
Vec3 Coat::darkening(float cosine) const {
  const float down = glm::mix(fresnel_dielectric(cosine, eta_), mean_fresnel_inside(eta_), base_diffuse_);
  return glm::mix(Vec3(1), Vec3(1 - down) / (Vec3(1) - down * base_albedo_), darkening_);
}

Vec3 Coat::lets_pass(const Vec3& out, const Vec3& in, float reflected) const {
  Vec3 passed = (1 - reflected) * darkening(out.z);
  if (colour_ != Vec3(1)) {
    constexpr float k_least = 0.01f; // no way through the coat is longer than 100 times its thickness
    const float way_in = in.z > 0 ? 1 / std::max(k_least, refracted_cosine(in.z, eta_)) : 0;
    passed *= glm::pow(colour_, Vec3(0.5f * (1 / std::max(k_least, refracted_cosine(out.z, eta_)) + way_in)));
  }
  return glm::mix(Vec3(1), passed, weight_);
}

} // namespace kelpie
