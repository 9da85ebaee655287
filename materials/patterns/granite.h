#pragma once

#include "materials/patterns/cellular.h"

namespace kelpie {

template <class Mode>
struct Granite : SolidTexture<Granite, Mode> {
  static constexpr std::string_view k_name = "granite";
  static constexpr std::string_view k_doc = R"(Granite: grown-together crystals of several minerals, with small dark flakes among them.

    phase   = a random number for every one of Worley's cells of p / size + turbulence * noise(p), + 0.04 * noise(4 p / size)
    profile = the phase

All values are as frequent: a mineral between the stops at 0.3 and 0.6 is three tenths of the stone. Flakes have the value 1, and are
the part `flakes` of it. Turbulence makes the borders of crystals uneven.)";
  static constexpr std::array<PlainStop, 8> k_default_stops{{{0.f, 0.20f, 0.20f, 0.205f, 0.12f},
                                                             {0.28f, 0.33f, 0.325f, 0.32f, 0.12f},
                                                             {0.3f, 0.36f, 0.235f, 0.195f, 0.25f},
                                                             {0.66f, 0.50f, 0.37f, 0.315f, 0.25f},
                                                             {0.68f, 0.56f, 0.53f, 0.49f, 0.2f},
                                                             {0.91f, 0.68f, 0.66f, 0.63f, 0.2f},
                                                             {0.93f, 0.035f, 0.034f, 0.036f, 0.35f},
                                                             {1.f, 0.02f, 0.02f, 0.022f, 0.35f}}};
  static constexpr PhaseDomain k_domain{0, 1, false};

  Value<Mode, float> flakes{0.1f};

  Granite() : SolidTexture<Granite, Mode>({.size = 0.12f, .turbulence = 0.08f, .turbulence_size = 0.7f, .turbulence_octaves = 2}) {}

  static constexpr auto parameters() {
    return std::tuple_cat(std::tuple{parameter("flakes", &Granite::flakes, "their part of the stone").at_least(0).at_most(1)},
                          Granite::common_parameters());
  }

  // Sampled:
  PhaseMixture mixture(const Place& place) const {
    const float lost = cells_unseen(place);
    if (lost == 1) {
      PhaseMixture mixture(k_all_phases);
      mixture.cover({1}, flakes);
      return mixture;
    }
    const Place bent = this->turbulent(place).turned(), fine = bent.scaled(4);
    const TwoCells crystals(bent, this->stream(2));
    const NoiseSample tone = fine.noise({.octaves = 1, .seed = this->stream(4)});
    const float shade = k_tone * tone.value, variance = k_tone * k_tone * (tone.variance + fine.variance(tone.gradient));
    PhaseMixture mixture(SpreadPhase{unit_of(crystals.cell.first.id) + shade, variance});
    mixture.cover({unit_of(crystals.cell.second.id) + shade, variance}, 1 - crystals.part);
    mixture.cover(k_all_phases, lost);
    mixture.cover({1}, flake_part(bent.scaled(k_fineness)));
    return mixture;
  }

  float profile(float phase) const { return phase; }

private:
  static constexpr float k_fineness = 3; ///< how many flakes are as long as a crystal

  static constexpr float k_tone = 0.04f; ///< how much the phase changes within a crystal

  float flake_part(const Place& place) const {
    const float lost = cells_unseen(place);
    if (lost == 1) return flakes;
    const TwoCells grains(place, this->stream(3));
    const float seen = grains.mean([this](const WorleyPoint& point) { return static_cast<float>(unit_of(point.id) < flakes); });
    return lost * flakes + (1 - lost) * seen;
  }
};

} // namespace kelpie
