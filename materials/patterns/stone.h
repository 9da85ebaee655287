#pragma once

#include "materials/patterns/solid_texture.h"

namespace kelpie {

template <class Mode>
struct Stone : SolidTexture<Stone, Mode> {
  static constexpr std::string_view k_name = "stone";
  static constexpr std::string_view k_doc = R"(A grey rock: mottled by noise, with fine grains and dark cracks.

    phase   = noise(p / size), `octaves` of it; normally distributed, mean 0, variance 1
    profile = the part of a normal distribution below the phase

So all values are as frequent. Cracks are where another noise, shifted by turbulence, is near 0; they have the value 0.)";
  static constexpr std::array<PlainStop, 5> k_default_stops{{{0.f, 0.045f, 0.043f, 0.042f, 0.6f},
                                                             {0.04f, 0.17f, 0.165f, 0.155f, 0.55f},
                                                             {0.5f, 0.27f, 0.262f, 0.245f, 0.5f},
                                                             {0.85f, 0.36f, 0.35f, 0.325f, 0.5f},
                                                             {1.f, 0.47f, 0.45f, 0.42f, 0.45f}}};
  static constexpr PhaseDomain k_domain{-4, 4, false};

  Value<Mode, float> octaves{8.f}, gain{0.78f}, cracks{0.5f};

  Stone() : SolidTexture<Stone, Mode>({.size = 0.6f, .turbulence = 0.12f, .turbulence_size = 0.5f, .turbulence_octaves = 3}) {}

  static constexpr auto parameters() {
    return std::tuple_cat(
        std::tuple{parameter("octaves", &Stone::octaves, "of the mottling").at_least(1).at_most(12),
                   parameter("gain", &Stone::gain, "the height of each octave over that of the one before").at_least(0).at_most(1),
                   parameter("cracks", &Stone::cracks, "how wide they are: 0 none").at_least(0).at_most(1)},
        Stone::common_parameters());
  }

  // Sampled:
  PhaseMixture mixture(const Place& place) const {
    const NoiseSample noise = place.noise({.octaves = octaves, .gain = gain, .seed = this->stream(2)});
    PhaseMixture mixture(SpreadPhase{noise.value, noise.variance + place.variance(noise.gradient)});
    if (cracks > 0) mixture.cover({k_domain.lower}, crack_part(this->turbulent(place).scaled(0.45f)));
    return mixture;
  }

  float profile(float phase) const { return normal_below(phase); }

private:
  /// Where noise is within a narrow band about 0.
  float crack_part(const Place& place) const {
    const NoiseSample noise = place.noise({.octaves = 1, .seed = this->stream(3)});
    const float width = 0.02f * cracks, spread = std::sqrt(0.25f * width * width + noise.variance + place.variance(noise.gradient));
    return normal_below((width - noise.value) / spread) - normal_below((-width - noise.value) / spread);
  }
};

} // namespace kelpie
