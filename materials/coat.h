#pragma once

#include "materials/openpbr.h"
#include "materials/specular.h"

namespace kelpie {

/// A clear layer of a dielectric over a share of the surface (OpenPBR 1.1, "Coat"): it reflects, and it changes how the base below
/// it looks.
class Coat {
public:
  Coat() = default;
  /// `ior_near`: of the medium that the viewer is in.
  Coat(const SurfaceParameters&, float ior_near);

  /// What it reflects, where it lies.
  const SpecularLobe& lobe() const { return lobe_; }
  /// The share of the surface that it covers.
  float weight() const { return weight_; }

  /// The base as it is below: nearer to its own the index of refraction above it, and more blurred.
  static float ior_above_base(const SurfaceParameters&, float ior_near);
  static float base_roughness(const SurfaceParameters&);

  /// How much of what the base scatters from `in` gets to the viewer. `reflected`: what the coat reflects of light from all around.
  Vec3 lets_pass(const Vec3& out, const Vec3& in, float reflected) const;
  void make_at_least_as_rough_as(float alpha) { lobe_.make_at_least_as_rough_as(alpha); }
  void widen(float by) { lobe_.widen(by); }

private:
  Vec3 darkening(float cosine) const;

  SpecularLobe lobe_;
  float weight_ = 0, eta_ = 1;
  Vec3 colour_{1};         ///< what is left of light that goes straight in and out
  Vec3 base_albedo_{0};    ///< about what the base throws back
  float darkening_ = 0;    ///< how much of it is thrown down again
  float base_diffuse_ = 0; ///< 0: the base throws light back in one direction, 1: all around
};

} // namespace kelpie
