#pragma once

#include "materials/patterns/cellular.h"

namespace kelpie {

template <class Mode>
struct Rust : SolidTexture<Rust, Mode> {
  static constexpr std::string_view k_name = "rust";
  static constexpr std::string_view k_doc =
      R"(Iron that rusts: blotches that eat into bare metal or paint, dark where they are oldest, with pits.

    phase   = noise(p / size + turbulence * noise), `octaves` of it; normally distributed, mean 0, variance 1
    profile = the part of a normal distribution below the phase

So all values are as frequent: a stop at 0.4 is where two fifths are not yet rusty. Pits have the value 1.)";
  static constexpr std::array<PlainStop, 6> k_default_stops{{{0.f, 0.2f, 0.205f, 0.21f, 0.3f},
                                                             {0.36f, 0.15f, 0.145f, 0.14f, 0.38f},
                                                             {0.41f, 0.29f, 0.13f, 0.055f, 0.75f},
                                                             {0.6f, 0.22f, 0.082f, 0.032f, 0.85f},
                                                             {0.8f, 0.115f, 0.042f, 0.02f, 0.9f},
                                                             {1.f, 0.04f, 0.02f, 0.014f, 0.95f}}};
  static constexpr PhaseDomain k_domain{-4, 4, false};

  Value<Mode, float> octaves{8.f}, gain{0.68f}, pits{0.05f};

  Rust() : SolidTexture<Rust, Mode>({.size = 0.55f, .turbulence = 0.03f, .turbulence_size = 0.3f, .turbulence_octaves = 2}) {}

  static constexpr auto parameters() {
    return std::tuple_cat(
        std::tuple{parameter("octaves", &Rust::octaves, "of the blotches").at_least(1).at_most(12),
                   parameter("gain", &Rust::gain, "the height of each octave over that of the one before").at_least(0).at_most(1),
                   parameter("pits", &Rust::pits, "their part of the surface").at_least(0).at_most(0.2)},
        Rust::common_parameters());
  }

  // Sampled:
  PhaseMixture mixture(const Place& straight) const {
    const Place place = this->turbulent(straight);
    const NoiseSample noise = place.noise({.octaves = octaves, .gain = gain, .seed = this->stream(2)});
    PhaseMixture mixture(SpreadPhase{noise.value, noise.variance + place.variance(noise.gradient)});
    if (pits > 0)
      mixture.cover({k_domain.upper},
                    ball_part(straight.scaled(26).turned(), k_pit_radius, pits / ball_volume(k_pit_radius), this->stream(3)));
    return mixture;
  }

  float profile(float phase) const { return normal_below(phase); }

private:
  static constexpr float k_pit_radius = 0.48f;
};

} // namespace kelpie
