#pragma once

#include "materials/patterns/solid_texture.h"

namespace kelpie {

template <class Mode>
struct Marble : SolidTexture<Marble, Mode> {
  static constexpr std::string_view k_name = "marble";
  static constexpr std::string_view k_doc = R"(Marble: veins along planes that turbulence has folded.

    phase   = direction . p / size + turbulence * noise(p / (size * turbulence_size))
    profile: some veins in every period, of several strengths, each sharp on one side and soft on the other, over soft clouds

0 is the ground, 1 the heart of the strongest vein; `vein_width` widens all veins. More `turbulence` folds them; with 0 they are planes.
Ground covers the veins here more and there less: `patches` of it, on the average.
Source: Perlin, "An image synthesizer" (1985).)";
  static constexpr std::array<PlainStop, 5> k_default_stops{{{0.f, 0.80f, 0.79f, 0.77f, 0.18f},
                                                             {0.22f, 0.70f, 0.70f, 0.69f, 0.18f},
                                                             {0.5f, 0.40f, 0.42f, 0.44f, 0.2f},
                                                             {0.8f, 0.17f, 0.19f, 0.22f, 0.22f},
                                                             {1.f, 0.07f, 0.08f, 0.10f, 0.25f}}};
  static constexpr PhaseDomain k_domain{0, 1, true};

  Value<Mode, Vec3> direction{Vec3(0.8f, 0.5f, 0.33f)};
  Value<Mode, float> vein_width{1.f}, patches{0.3f};

  Marble() : SolidTexture<Marble, Mode>({.turbulence = 0.3f, .turbulence_size = 1.2f, .turbulence_octaves = 5}) {}

  static constexpr auto parameters() {
    return std::tuple_cat(std::tuple{parameter("direction", &Marble::direction, "across the veins").nonzero(),
                                     parameter("vein_width", &Marble::vein_width, "a factor of the widths of the veins").above(0),
                                     parameter("patches", &Marble::patches, "how much ground covers veins").at_least(0).at_most(0.5)},
                          Marble::common_parameters());
  }

  // Sampled:
  PhaseMixture mixture(const Place& place) const {
    PhaseMixture mixture(phase(place));
    if (patches > 0)
      mixture.cover({k_ground}, 2 * patches * place.scaled(0.8f).part_above(0, 0.8f, {.octaves = 1, .seed = this->stream(2)}));
    return mixture;
  }

  SpreadPhase phase(const Place& place) const {
    const Vec3 along = glm::normalize(direction);
    return this->turbulent(place, glm::dot(along, place.p), along);
  }

  float profile(float phase) const {
    struct Vein {
      float at, height, before, after; ///< half widths of its sides
    };
    static constexpr std::array<Vein, 5> k_veins{{{0.10f, 1.f, 0.014f, 0.16f},
                                                  {0.33f, 0.5f, 0.11f, 0.008f},
                                                  {0.41f, 0.4f, 0.006f, 0.05f},
                                                  {0.62f, 0.8f, 0.010f, 0.10f},
                                                  {0.88f, 0.4f, 0.10f, 0.006f}}};
    const float wave = 4 * phase * (1 - phase);
    float result = 0.3f * wave * wave;
    for (const Vein& vein : k_veins) {
      const float d = phase - vein.at - std::round(phase - vein.at);
      const float ridge = std::max(0.f, 1 - std::abs(d) / (vein_width * (d < 0 ? vein.before : vein.after)));
      const float height = 0.4f * ridge * ridge + 0.6f * ridge * ridge * ridge * ridge * ridge; // a soft cloud and a sharp line
      result = std::max(result, vein.height * height + result * (1 - ridge));
    }
    return result;
  }

private:
  static constexpr float k_ground = 0.97f; ///< a phase
};

} // namespace kelpie
