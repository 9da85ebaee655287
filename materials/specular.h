#pragma once

#include "materials/bsdf.h"
#include "materials/fresnel.h"
#include "materials/ggx.h"
#include "materials/thin_film.h"

namespace kelpie {

/// GGX microfacets of a metal, of a dielectric, or of a mixture of both. What the dielectric lets in is, for a share, passed on
/// to the other side (Walter et al. 2007); the rest is left to what lies below.
///
/// Light that meets a second microfacet is repaid (energy_table.h), so a smooth surface and a rough one are equally bright, and
/// the lobe is not quite reciprocal.
class SpecularLobe {
public:
  /// What it is made of.
  struct Parameters {
    Ggx facets;
    float eta = 1;         ///< index of refraction beyond the surface over that on the viewer's side: says where light goes
    float fresnel_eta = 1; ///< of the dielectric: says how much is reflected
    float metalness = 0;   ///< share of the metal
    F82Tint metal;
    float metal_weight = 1;   ///< a factor of what the metal reflects
    Vec3 reflected{1};        ///< a factor of what the dielectric reflects
    Vec3 transmitted{0};      ///< of what the dielectric lets in, how much comes out on the other side
    float film_weight = 0;    ///< share of the surface that has a thin film
    bool from_inside = false; ///< of the film: it is on the other side
    ThinFilm film;
  };

  SpecularLobe() = default;
  explicit SpecularLobe(const Parameters&);

  bool is_smooth() const { return p_.facets.is_smooth(); }
  void make_at_least_as_rough_as(float alpha);
  /// See Ggx::widened.
  void widen(float by);

  /// bsdf * |cosine of in|, without deltas, for out above the surface.
  Vec3 evaluate(const Vec3& out, const Vec3& in) const;
  float pdf(const Vec3& out, const Vec3& in) const;
  BsdfSample sample(const Vec3& out, float lobe, Vec2 u) const;

  /// Of light that is the same from everywhere: what the dielectric reflects, without its colour and the metal.
  Vec3 dielectric_albedo(float cosine) const;
  /// About how much the lobe scatters towards a viewer.
  Vec3 about(float cosine) const;
  /// Of light that meets the surface at a cosine and goes straight on, bent by nothing, about what passes.
  Vec3 passing(float cosine) const { return (1 - p_.metalness) * p_.transmitted * (Vec3(1) - dielectric_albedo(cosine)); }
  bool is_transmissive() const { return p_.transmitted != Vec3(0); }

private:
  /// Factors of what the microfacets scatter once that repay what is scattered more often.
  struct Gains {
    Vec3 metal{1};
    float dielectric = 1;
  };
  /// What microfacets seen at one cosine do with light.
  struct Shares {
    Vec3 reflected{0}, transmitted{0};
    /// With what probability `sample` reflects.
    float reflect_probability() const;
  };
  /// Two directions that a microfacet joins.
  struct Facet;

  bool passes_straight() const { return p_.eta == 1; }
  bool is_window() const;
  float visible_share(const Vec3& out) const { return is_transmissive() ? 1 : p_.facets.reflecting_share(out); }
  Gains gains(float cosine) const;
  Vec3 dielectric_fresnel(float cosine) const;
  Vec3 metal_fresnel(float cosine) const;
  Shares shares(float cosine, const Gains&) const;
  bool find_facet(const Vec3& out, const Vec3& in, Facet&) const;

  Parameters p_;
};

} // namespace kelpie
