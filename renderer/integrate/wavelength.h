// Dispersion: light of one wavelength in three channels.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "materials/openpbr.h"

namespace kelpie {

/// Whether colours part in it.
inline bool is_dispersive(const SurfaceParameters& s) { return s.transmission_weight > 0 && s.transmission_dispersion_scale > 0; }

/// The index of refraction at a wavelength in nanometres: `specular_ior` is that of the line d, and the Abbe number fixes Cauchy's two
/// terms (OpenPBR 1.1, "Dispersion").
inline float ior_at(const SurfaceParameters& s, float wavelength) {
  constexpr float k_d = 587.6f, k_f = 486.1f, k_c = 656.3f; // Fraunhofer's lines
  constexpr auto inverse_square = [](float x) { return 1 / (x * x); };
  if (wavelength == 0 || !is_dispersive(s)) return s.specular_ior;
  const float abbe = s.transmission_dispersion_abbe_number / s.transmission_dispersion_scale;
  const float b = (s.specular_ior - 1) / (abbe * (inverse_square(k_f) - inverse_square(k_c)));
  return std::max(1.f, s.specular_ior + b * (inverse_square(wavelength) - inverse_square(k_d)));
}

/// Light of one wavelength, and what it adds to the channels.
struct Monochrome {
  float wavelength; ///< nanometres
  Vec3 weight;
};

/// Of wavelengths that are even in u, from 0 to 1: the weights' mean is 1 in each channel, so that white stays white. Channels are bands
/// that overlap, and not what eyes see of a wavelength: that has negative parts, and lies outside of what three channels can show.
inline Monochrome monochrome(float u) {
  constexpr float k_blue = 460, k_apart = 80; // the middles of the bands
  const float s = 3 * u - 0.5f;               // 0: blue, 1: green, 2: red
  const auto band = [](float x) {
    const float c = std::cos(0.5f * std::numbers::pi_v<float> * std::clamp(x, -1.f, 1.f));
    return 3 * c * c;
  };
  return {k_blue + k_apart * s, {band(std::min(s, 2.f) - 2), band(s - 1), band(std::max(s, 0.f))}};
}

} // namespace kelpie
