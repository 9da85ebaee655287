#pragma once

#include "materials/bsdf.h"
#include "materials/coat.h"
#include "materials/diffuse.h"
#include "materials/openpbr.h"
#include "materials/specular.h"

namespace kelpie {

/// The media that a surface lies between, as its viewer sees them.
struct Boundary {
  float ior_near = 1;       ///< index of refraction on the viewer's side
  float ior_far = 1;        ///< beyond the surface; of an opaque dielectric its own
  bool from_inside = false; ///< the viewer is in what the surface encloses

  /// A surface in air, seen from outside.
  static Boundary in_air(const SurfaceParameters& surface) { return {1, surface.specular_ior, false}; }
};

/// What a surface does with light: OpenPBR's base and coat. From above: a coat's reflection; microfacets of a metal, of a
/// dielectric or of both; below a dielectric a diffuse ground, or the other side. A layer gets what the one above it leaves of light
/// from all around (albedo scaling), so no light is made or lost, at the price of reciprocity. A part of the ground may let light in:
/// of that `sample` alone knows, and comes back with a way below the surface (materials/subsurface.h).
///
/// From inside there is only the clear dielectric. An opaque surface is the same from both sides.
class SurfaceBsdf {
public:
  explicit SurfaceBsdf(const SurfaceParameters& s) : SurfaceBsdf(s, Boundary::in_air(s)) {}
  SurfaceBsdf(const SurfaceParameters&, const Boundary&);

  const Vec3& albedo() const { return albedo_; }
  bool is_delta() const {
    return !(lobes_ & k_diffuse) && (!has_specular() || specular_.is_smooth()) && (!has_coat() || coat_.lobe().is_smooth());
  }
  /// Whether some light wanders below the surface.
  bool lets_below() const { return lobes_ & k_below; }
  bool is_glossy() const { return lobes_ != k_diffuse; }
  SurfaceBsdf at_least_as_rough_as(float alpha) const;
  /// The same with microfacets whose slopes vary more: `by` adds to the alpha^2 of all.
  SurfaceBsdf widened(float by) const;
  /// Of light that arrives at a cosine about what passes to the other side, if it is not bent on its way.
  Vec3 passing(float cosine) const;

  Vec3 evaluate(const Vec3& out, const Vec3& in) const {
    if (is_glossy()) return evaluate_lobes(out, in);
    return out.z > 0 && in.z > 0 ? diffuse_.evaluate(out, in) : Vec3(0);
  }
  float pdf(const Vec3& out, const Vec3& in) const {
    if (is_glossy()) return pdf_of_lobes(out, in);
    return out.z > 0 && in.z > 0 ? diffuse_.pdf(in) : 0;
  }
  BsdfSample sample(const Vec3& out, float lobe, Vec2 u) const {
    if (is_glossy()) return sample_lobes(out, lobe, u);
    if (out.z <= 0) return {};
    const Vec3 in = DiffuseLobe::sample(u);
    return {in, diffuse_.reflectance(out, in), diffuse_.pdf(in)};
  }

private:
  enum Lobe : unsigned { k_diffuse = 1, k_specular = 2, k_coat = 4, k_below = 8 };
  struct Layers;

  bool has_diffuse() const { return lobes_ & k_diffuse; }
  bool has_specular() const { return lobes_ & k_specular; }
  bool has_coat() const { return lobes_ & k_coat; }
  void make_clear(const SurfaceParameters&, const Boundary&);
  void make_layers(const SurfaceParameters&, const Boundary&);
  Layers layers(const Vec3& out) const;
  Vec3 evaluate_lobes(const Vec3& out, const Vec3& in) const;
  float pdf_of_lobes(const Vec3& out, const Vec3& in) const;
  BsdfSample sample_lobes(const Vec3& out, float lobe, Vec2 u) const;
  Vec3 evaluate(const Layers&, const Vec3& out, const Vec3& in) const;
  float pdf(const Layers&, const Vec3& out, const Vec3& in) const;

  unsigned lobes_ = k_diffuse;
  float ground_ = 1; ///< share of the surface that is a ground
  float below_ = 0;  ///< share of the ground that lets light in
  Vec3 albedo_{0};
  DiffuseLobe diffuse_;
  SpecularLobe specular_;
  Coat coat_;
};

static_assert(BsdfModel<SurfaceBsdf>);

} // namespace kelpie
