#pragma once
#include "materials/matte.h"
#include "materials/metal.h"
namespace kelpie {
/// What lies on both sides of a surface.
struct Boundary {
  float ior_near = 1, ior_far = 1; ///< indices of refraction of the media on the viewer's side and beyond
  bool from_inside = false;        ///< seen from within the shape
};
class SurfaceBsdf {
public:
  explicit SurfaceBsdf(const SurfaceParameters& s, const Boundary& = {})
      : metal_(s.base_metalness > 0.5f), m_(s.base_color.rgb), g_(s.base_color.rgb, s.specular_roughness * s.specular_roughness) {}
  Vec3 albedo() const { return metal_ ? g_.albedo() : m_.albedo(); }
  bool is_delta() const { return metal_ && g_.is_delta(); }
  bool is_glossy() const { return metal_; }
  SurfaceBsdf at_least_as_rough_as(float a) const {
    SurfaceBsdf b = *this;
    b.g_ = g_.at_least_as_rough_as(a);
    return b;
  }
  Vec3 evaluate(const Vec3& o, const Vec3& i) const { return metal_ ? g_.evaluate(o, i) : m_.evaluate(o, i); }
  float pdf(const Vec3& o, const Vec3& i) const { return metal_ ? g_.pdf(o, i) : m_.pdf(o, i); }
  BsdfSample sample(const Vec3& o, float l, Vec2 u) const { return metal_ ? g_.sample(o, l, u) : m_.sample(o, l, u); }

private:
  bool metal_;
  MatteBsdf m_;
  MetalBsdf g_;
};
} // namespace kelpie
