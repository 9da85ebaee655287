#pragma once

#include "materials/patterns/cellular.h"

namespace kelpie {

template <class Mode>
struct Leather : SolidTexture<Leather, Mode> {
  static constexpr std::string_view k_name = "leather";
  static constexpr std::string_view k_doc = R"(Leather, or skin: plump cells between creases.

    phase   = the part of space that is nearer to a border of Worley's cells of p / size + turbulence * noise(p)
    profile: from 0 in the creases to 1 on the plump cells; creases are the part `creases` of space

Its own stops are creases by their `bump_height`, too: 0 at 0, and a seventh of `size` at 1.)";
  static constexpr std::array<PlainStop, 4> k_default_stops{{{0, 0.012f, 0.006f, 0.004f, 0.7f},
                                                             {0.4f, 0.05f, 0.022f, 0.012f, 0.5f, 0.09f},
                                                             {0.75f, 0.13f, 0.062f, 0.032f, 0.4f, 0.13f},
                                                             {1, 0.21f, 0.112f, 0.062f, 0.34f, 0.145f}}};
  static constexpr PhaseDomain k_domain{0, 1, false};

  Value<Mode, float> creases{0.4f};

  Leather() : SolidTexture<Leather, Mode>({.size = 0.075f, .turbulence = 0.07f, .turbulence_size = 2, .turbulence_octaves = 2}) {}

  static constexpr auto parameters() {
    return std::tuple_cat(std::tuple{parameter("creases", &Leather::creases, "their part of space").above(0).at_most(1)},
                          Leather::common_parameters());
  }

  // Sampled:
  PhaseMixture mixture(const Place& straight) const {
    return border_mixture(
        straight, [this](const Place& place) { return this->turbulent(place); }, this->stream(2));
  }

  float profile(float phase) const {
    const float side = std::min(phase / creases, 1.f);
    return 0.6f * side * (2 - side) + 0.4f * phase;
  }
};

} // namespace kelpie
