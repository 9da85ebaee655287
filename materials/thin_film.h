#pragma once

#include <array>

#include "base/vec.h"
#include "materials/fresnel.h"

namespace kelpie {

/// A film so thin that light reflected at its two faces interferes (Belcour and Barla 2017): the colours of soap and oil.
/// Reflectances are scene-linear, of a light that is the same at all wavelengths. The cosine is that of the angle outside.
class ThinFilm {
public:
  ThinFilm() = default;
  /// `thickness` in micrometres; indices of refraction of the film and of what is above it.
  ThinFilm(float thickness, float ior, float ior_above) : thickness_(thickness), ior_(ior), ior_above_(ior_above) {}

  /// On a dielectric, of which `eta` is the index of refraction over that above the film.
  Vec3 on_dielectric(float cosine, float eta) const;
  /// On a metal.
  Vec3 on_metal(float cosine, const F82Tint& metal) const;

private:
  /// Of rays that differ by one, two and three ways down and up through the film.
  std::array<Vec3, 3> interferences(float cosine_in_film) const;

  float thickness_ = 0, ior_ = 1, ior_above_ = 1;
};

} // namespace kelpie
