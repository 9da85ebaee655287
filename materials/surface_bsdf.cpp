#include "materials/surface_bsdf.h"

#include <utility>

namespace kelpie {

namespace {

/// OpenPBR 1.1, "Microfacet model": anisotropy leaves the mean of alpha^2 as it is.
Ggx microfacets(float roughness, float anisotropy) {
  const float alpha = roughness * roughness, across = 1 - anisotropy;
  if (anisotropy == 0) return Ggx(alpha);
  const float along = alpha * std::sqrt(2 / (1 + across * across));
  return Ggx(Vec2(along, along * across));
}

/// What is left of light that passes the surface.
Vec3 tint(const SurfaceParameters& s) { return s.transmission_depth > 0 ? Vec3(1) : s.transmission_color.rgb; }

} // namespace

/// How the layers share light that comes from all around, for one viewer.
struct SurfaceBsdf::Layers {
  Vec3 ground{1};                               ///< of what comes to the base, what the diffuse ground gets
  float coat = 0;                               ///< what the coat reflects, where it lies
  float p_diffuse, p_specular, p_coat, p_below; ///< with what probability `sample` chooses each
};

SurfaceBsdf::SurfaceBsdf(const SurfaceParameters& s, const Boundary& boundary) {
  const bool is_clear = s.transmission_weight > 0 && s.base_metalness < 1;
  if (boundary.from_inside && is_clear)
    make_clear(s, boundary);
  else if (boundary.from_inside)
    make_layers(s, {boundary.ior_far, boundary.ior_near});
  else
    make_layers(s, boundary);
}

void SurfaceBsdf::make_clear(const SurfaceParameters& s, const Boundary& boundary) {
  SpecularLobe::Parameters p;
  p.facets = microfacets(s.specular_roughness, s.specular_roughness_anisotropy);
  p.eta = boundary.ior_far / boundary.ior_near, p.fresnel_eta = modulated_eta(p.eta, s.specular_weight);
  p.transmitted = albedo_ = tint(s);
  p.from_inside = true, p.film_weight = s.thin_film_weight;
  p.film = ThinFilm(s.thin_film_thickness, s.thin_film_ior, boundary.ior_far);
  specular_ = SpecularLobe(p), lobes_ = k_specular, ground_ = 0;
}

void SurfaceBsdf::make_layers(const SurfaceParameters& s, const Boundary& boundary) {
  const Vec3 base = s.base_color.rgb * s.base_weight;
  const float clear = s.transmission_weight, metalness = s.base_metalness;
  diffuse_ = DiffuseLobe(base, s.base_diffuse_roughness);
  ground_ = (1 - metalness) * (1 - clear);
  below_ = s.subsurface_weight;
  const Vec3 ground = glm::mix(base, s.subsurface_color.rgb, below_);
  const unsigned grounds =
      (below_ < 1 && base != Vec3(0) ? k_diffuse : 0u) | (below_ > 0 && s.subsurface_color.rgb != Vec3(0) ? k_below : 0u);
  if (grounds != 0) lobes_ = grounds;
  albedo_ = ground;
  const bool is_bare = s.coat_weight == 0;
  // Without metal and without what a dielectric reflects or lets pass there is only the ground.
  if (metalness > 0 || clear > 0 || s.specular_weight > 0) {
    SpecularLobe::Parameters p;
    const float ior_above = Coat::ior_above_base(s, boundary.ior_near);
    float ratio = boundary.ior_far / ior_above;
    if (!is_bare && ratio < 1 && boundary.ior_far >= boundary.ior_near) ratio = 1 / ratio; // no total reflection below a coat
    p.facets = microfacets(Coat::base_roughness(s), s.specular_roughness_anisotropy);
    p.eta = boundary.ior_far / boundary.ior_near, p.fresnel_eta = modulated_eta(ratio, s.specular_weight);
    p.metalness = metalness, p.metal = F82Tint(base, s.specular_color.rgb), p.metal_weight = std::min(1.f, s.specular_weight);
    p.reflected = s.specular_color.rgb, p.transmitted = tint(s) * clear;
    if (s.thin_film_weight > 0 && s.thin_film_thickness > 0)
      p.film_weight = s.thin_film_weight, p.film = ThinFilm(s.thin_film_thickness, s.thin_film_ior, ior_above);
    specular_ = SpecularLobe(p);
    lobes_ = ground_ > 0 ? grounds | k_specular : k_specular;
    const float straight_on = fresnel_at_normal(p.fresnel_eta);
    const Vec3 below = glm::mix(ground, tint(s), clear);
    albedo_ = glm::mix(straight_on * p.reflected + (1 - straight_on) * below, base * p.metal_weight, metalness);
  }
  if (is_bare) return;
  coat_ = Coat(s, boundary.ior_near), lobes_ |= k_coat;
  albedo_ *= glm::mix(Vec3(1), s.coat_color.rgb, s.coat_weight);
}

SurfaceBsdf SurfaceBsdf::at_least_as_rough_as(float alpha) const {
  SurfaceBsdf wide = *this;
  wide.specular_.make_at_least_as_rough_as(alpha), wide.coat_.make_at_least_as_rough_as(alpha);
  return wide;
}

SurfaceBsdf SurfaceBsdf::widened(float by) const {
  SurfaceBsdf wide = *this;
  wide.specular_.widen(by), wide.coat_.widen(by);
  return wide;
}

Vec3 SurfaceBsdf::passing(float cosine) const {
  if (!has_specular() || !specular_.is_transmissive()) return Vec3(0);
  const Vec3 passing = specular_.passing(cosine);
  if (!has_coat()) return passing;
  const Vec3 along(std::sqrt(std::max(0.f, 1 - cosine * cosine)), 0, cosine);
  return passing * coat_.lets_pass(along, -along, coat_.lobe().dielectric_albedo(cosine).x);
}

SurfaceBsdf::Layers SurfaceBsdf::layers(const Vec3& out) const {
  Layers l;
  l.coat = has_coat() ? coat_.lobe().dielectric_albedo(out.z).x : 0;
  l.ground = Vec3(ground_);
  if (has_specular() && (has_diffuse() || lets_below())) l.ground *= Vec3(1) - specular_.dielectric_albedo(out.z);
  const float coat = coat_.weight() * l.coat;
  const float diffuse = has_diffuse() ? (1 - coat) * (1 - below_) * largest(l.ground * diffuse_.albedo()) : 0;
  const float under = lets_below() ? (1 - coat) * below_ * largest(l.ground) : 0;
  const float specular = has_specular() ? (1 - coat) * largest(specular_.about(out.z)) : 0;
  const float sum = coat + diffuse + specular + under;
  if (!(sum > 0)) return l.p_diffuse = has_diffuse(), l.p_specular = !has_diffuse(), l.p_coat = l.p_below = 0, l;
  l.p_diffuse = diffuse / sum, l.p_specular = specular / sum, l.p_coat = coat / sum, l.p_below = under / sum;
  return l;
}

Vec3 SurfaceBsdf::evaluate(const Layers& l, const Vec3& out, const Vec3& in) const {
  Vec3 f(0);
  if (has_specular()) f = specular_.evaluate(out, in);
  if (has_diffuse() && in.z > 0) f += (1 - below_) * l.ground * diffuse_.evaluate(out, in);
  if (!has_coat()) return f;
  f *= coat_.lets_pass(out, in, l.coat);
  return in.z > 0 ? f + coat_.weight() * coat_.lobe().evaluate(out, in) : f;
}

float SurfaceBsdf::pdf(const Layers& l, const Vec3& out, const Vec3& in) const {
  float sum = 0;
  if (l.p_specular > 0) sum = l.p_specular * specular_.pdf(out, in);
  if (in.z <= 0) return sum;
  if (l.p_diffuse > 0) sum += l.p_diffuse * diffuse_.pdf(in);
  if (l.p_coat > 0) sum += l.p_coat * coat_.lobe().pdf(out, in);
  return sum;
}

Vec3 SurfaceBsdf::evaluate_lobes(const Vec3& out, const Vec3& in) const {
  if (out.z <= 0) return Vec3(0);
  if (lobes_ == k_specular) return specular_.evaluate(out, in);
  return evaluate(layers(out), out, in);
}

float SurfaceBsdf::pdf_of_lobes(const Vec3& out, const Vec3& in) const {
  if (out.z <= 0) return 0;
  if (lobes_ == k_specular) return specular_.pdf(out, in);
  return pdf(layers(out), out, in);
}

BsdfSample SurfaceBsdf::sample_lobes(const Vec3& out, float lobe, Vec2 u) const {
  if (out.z <= 0) return {};
  if (lobes_ == k_specular) return specular_.sample(out, lobe, u);
  const Layers l = layers(out);
  BsdfSample s;
  if (lobe >= 1 - l.p_below) {
    const Vec3 above = DiffuseLobe::sample(u); // light comes in by the cosine, as to any ground
    s.direction = {above.x, above.y, -above.z}, s.pdf = l.p_below, s.goes_below = true;
    s.weight = l.ground * (below_ / l.p_below);
    if (has_coat()) s.weight *= coat_.lets_pass(out, above, l.coat);
    return s;
  }
  const bool is_coat = lobe < l.p_coat, is_specular = !is_coat && lobe < l.p_coat + l.p_specular;
  const float probability = is_coat ? l.p_coat : is_specular ? l.p_specular : l.p_diffuse;
  if (is_coat)
    s = coat_.lobe().sample(out, 0, u);
  else if (is_specular)
    s = specular_.sample(out, (lobe - l.p_coat) / l.p_specular, u);
  else
    s = {DiffuseLobe::sample(u), Vec3(1), 1};
  if (s.pdf <= 0) return {};
  if (s.is_delta) {
    s.weight *= (is_coat ? Vec3(coat_.weight()) : has_coat() ? coat_.lets_pass(out, s.direction, l.coat) : Vec3(1)) / probability;
    s.pdf *= probability;
    return s;
  }
  s.pdf = pdf(l, out, s.direction);
  if (!(s.pdf > 0)) return {};
  s.weight = evaluate(l, out, s.direction) / s.pdf;
  return s;
}

} // namespace kelpie
