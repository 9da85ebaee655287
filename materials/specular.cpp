#include "materials/specular.h"

#include "materials/energy_table.h"

namespace kelpie {

namespace {

/// Ratios of indices of refraction closer to 1 are taken for 1: light goes straight on.
constexpr float k_least_bend = 1e-3f;

} // namespace

struct SpecularLobe::Facet {
  Vec3 normal{0};
  float out = 0;      ///< cosine between its normal and the viewer
  float jacobian = 0; ///< d(solid angle of its normal) / d(solid angle of in)
};

SpecularLobe::SpecularLobe(const Parameters& p) : p_(p) {
  if (std::abs(p_.eta - 1) < k_least_bend) p_.eta = 1;
  if (is_window()) p_.facets = Ggx();
}

/// All light passes as if there were no surface.
bool SpecularLobe::is_window() const {
  return is_transmissive() && passes_straight() && std::abs(p_.fresnel_eta - 1) < k_least_bend && p_.metalness == 0 && p_.film_weight == 0;
}

void SpecularLobe::make_at_least_as_rough_as(float alpha) {
  if (!is_window()) p_.facets = p_.facets.at_least_as_rough_as(alpha);
}

void SpecularLobe::widen(float by) {
  if (!is_window()) p_.facets = p_.facets.widened(by);
}

SpecularLobe::Gains SpecularLobe::gains(float cosine) const {
  Gains g;
  if (is_smooth()) return g;
  const float alpha = p_.facets.mean_alpha();
  if (p_.metalness > 0) {
    const float albedo = mirror_albedo(cosine, alpha);
    g.metal = Vec3(1) + p_.metal.at_normal() * ((1 - albedo) / albedo); // Turquin eq. 16
  }
  if (p_.metalness < 1) g.dielectric = 1 / kelpie::dielectric_albedo(cosine, alpha, p_.fresnel_eta).total;
  return g;
}

Vec3 SpecularLobe::dielectric_fresnel(float cosine) const {
  if (is_transmissive() && refracted_cosine(cosine, p_.eta) <= 0) return Vec3(1);
  const Vec3 plain(kelpie::fresnel_dielectric(cosine, p_.fresnel_eta));
  if (p_.film_weight == 0 || plain.x == 1) return plain;
  // Light takes the same way in both directions: the film is looked at from outside.
  const Vec3 film = p_.from_inside ? p_.film.on_dielectric(refracted_cosine(cosine, p_.fresnel_eta), 1 / p_.fresnel_eta)
                                   : p_.film.on_dielectric(cosine, p_.fresnel_eta);
  return glm::mix(plain, film, p_.film_weight);
}

Vec3 SpecularLobe::metal_fresnel(float cosine) const {
  const Vec3 plain = p_.metal(cosine);
  return p_.metal_weight * (p_.film_weight == 0 ? plain : glm::mix(plain, p_.film.on_metal(cosine, p_.metal), p_.film_weight));
}

SpecularLobe::Shares SpecularLobe::shares(float cosine, const Gains& gain) const {
  Shares s;
  if (p_.metalness < 1) {
    const Vec3 fresnel = dielectric_fresnel(cosine);
    s.reflected = fresnel * p_.reflected * ((1 - p_.metalness) * gain.dielectric);
    s.transmitted = (Vec3(1) - fresnel) * p_.transmitted * ((1 - p_.metalness) * gain.dielectric);
  }
  if (p_.metalness > 0) s.reflected += metal_fresnel(cosine) * gain.metal * p_.metalness;
  return s;
}

float SpecularLobe::Shares::reflect_probability() const {
  const float up = largest(reflected), down = largest(transmitted);
  return down > 0 ? up / (up + down) : 1;
}

Vec3 SpecularLobe::dielectric_albedo(float cosine) const {
  const float smooth = kelpie::fresnel_dielectric(cosine, p_.fresnel_eta);
  const float rough = is_smooth() ? smooth : kelpie::dielectric_albedo(cosine, p_.facets.mean_alpha(), p_.fresnel_eta).reflected;
  if (p_.film_weight == 0) return Vec3(rough);
  return glm::clamp(Vec3(rough - smooth) + dielectric_fresnel(cosine), Vec3(0), Vec3(1));
}

Vec3 SpecularLobe::about(float cosine) const {
  const Shares s = shares(cosine, {});
  return s.reflected + s.transmitted;
}

/// The microfacet that scatters light from `in` to `out`; false if there is none. `out` lies above the surface.
bool SpecularLobe::find_facet(const Vec3& out, const Vec3& in, Facet& facet) const {
  if (in.z > 0) {
    facet.normal = glm::normalize(out + in), facet.out = std::min(1.f, glm::dot(out, facet.normal));
    facet.jacobian = 1 / (4 * facet.out); // Walter eq. 14
    return true;
  }
  if (in.z == 0 || !is_transmissive() || passes_straight()) return false;
  const Vec3 sum = out + p_.eta * in; // Walter eq. 16
  facet.normal = glm::normalize(sum.z < 0 ? -sum : sum), facet.out = std::min(1.f, glm::dot(out, facet.normal));
  const float beyond = glm::dot(in, facet.normal), way = facet.out + p_.eta * beyond;
  facet.jacobian = p_.eta * p_.eta * -beyond / (way * way); // Walter eq. 17
  return facet.out > 0 && beyond < 0;
}

Vec3 SpecularLobe::evaluate(const Vec3& out, const Vec3& in) const {
  Facet facet;
  if (is_smooth() || !find_facet(out, in, facet)) return Vec3(0);
  const Shares s = shares(facet.out, gains(out.z));
  const float g2 = 1 / (1 + p_.facets.lambda(out) + p_.facets.lambda(in));
  const float scattered = p_.facets.density(facet.normal) * g2 * facet.out * facet.jacobian / out.z; // Walter eq. 20 and 21
  return in.z > 0 ? s.reflected * scattered : s.transmitted * (scattered / (p_.eta * p_.eta));
}

float SpecularLobe::pdf(const Vec3& out, const Vec3& in) const {
  Facet facet;
  if (is_smooth() || !find_facet(out, in, facet)) return 0;
  const float density = p_.facets.density(facet.normal) * p_.facets.visible_factor(out, visible_share(out)) * facet.out * facet.jacobian;
  if (!is_transmissive()) return density;
  const float reflect = shares(facet.out, gains(out.z)).reflect_probability();
  return (in.z > 0 ? reflect : 1 - reflect) * density;
}

BsdfSample SpecularLobe::sample(const Vec3& out, float lobe, Vec2 u) const {
  const float share = visible_share(out);
  const Vec3 m = is_smooth() ? Vec3(0, 0, 1) : p_.facets.sample_visible(out, share, u);
  const float cosine = std::min(1.f, glm::dot(out, m));
  const Shares s = shares(cosine, gains(out.z));
  const float reflect = s.reflect_probability();
  const bool is_reflected = lobe < reflect;
  const float eta = is_reflected ? 1 : p_.eta, probability = is_reflected ? reflect : 1 - reflect;
  const Vec3 in = is_reflected ? 2 * cosine * m - out : (cosine / eta - refracted_cosine(cosine, eta)) * m - out / eta;
  if (is_reflected ? in.z <= 0 : in.z >= 0) return {};
  const Vec3 weight = (is_reflected ? s.reflected : s.transmitted) / (probability * eta * eta);
  if (is_smooth() || (!is_reflected && passes_straight())) return {in, weight, probability, true, eta};
  Facet facet;
  if (!find_facet(out, in, facet)) return {};
  const float g2 = 1 / (1 + p_.facets.lambda(out) + p_.facets.lambda(in)), visible = p_.facets.visible_factor(out, share);
  return {in, weight * (g2 / (out.z * visible)), probability * p_.facets.density(m) * visible * facet.out * facet.jacobian, false, eta};
}

} // namespace kelpie
