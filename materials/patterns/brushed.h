#pragma once

#include "materials/patterns/solid_texture.h"

namespace kelpie {

template <class Mode>
struct Brushed : SolidTexture<Brushed, Mode> {
  static constexpr std::string_view k_name = "brushed";
  static constexpr std::string_view k_doc = R"(Metal that was brushed: fine scratches along a direction.

    phase   = noise, of features `size` across the direction and `length` sizes along it; normally distributed, mean 0, variance 1
    profile = the part of a normal distribution below the phase

All values are as frequent.)";
  static constexpr std::array<PlainStop, 3> k_default_stops{
      {{0.f, 0.3f, 0.3f, 0.305f, 0.36f}, {0.5f, 0.45f, 0.45f, 0.455f, 0.28f}, {1.f, 0.6f, 0.6f, 0.6f, 0.2f}}};
  static constexpr PhaseDomain k_domain{-4, 4, false};

  Value<Mode, Vec3> direction{Vec3(1, 0, 0)};
  Value<Mode, float> length{40.f};

  Brushed() : SolidTexture<Brushed, Mode>({.size = 0.02f, .turbulence = 0.1f, .turbulence_size = 20, .turbulence_octaves = 1}) {}

  static constexpr auto parameters() {
    return std::tuple_cat(std::tuple{parameter("direction", &Brushed::direction, "of the brush").nonzero(),
                                     parameter("length", &Brushed::length, "of scratches, in sizes").at_least(1)},
                          Brushed::common_parameters());
  }

  // Sampled:
  PhaseMixture mixture(const Place& straight) const {
    const Place place = this->turbulent(straight).scaled(glm::normalize(direction), 1 / length, 1);
    const NoiseSample noise = place.noise({.octaves = 3, .gain = 0.8f, .seed = this->stream(2)});
    return SpreadPhase{noise.value, noise.variance + place.variance(noise.gradient)};
  }

  float profile(float phase) const { return normal_below(phase); }
};

} // namespace kelpie
