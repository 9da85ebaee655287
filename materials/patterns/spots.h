#pragma once

#include "materials/patterns/cellular.h"

namespace kelpie {

template <class Mode>
struct Spots : SolidTexture<Spots, Mode> {
  static constexpr std::string_view k_name = "spots";
  static constexpr std::string_view k_doc = R"(Balls of several sizes, scattered: on a surface, round spots.

    value = 1 in a ball, 0 between; one ball in each cube of side `size`, of radius `radius` sizes or less)";
  static constexpr std::array<PlainStop, 2> k_default_stops{{{0.f, 0.7f, 0.66f, 0.58f, 0.3f}, {1.f, 0.42f, 0.035f, 0.03f, 0.3f}}};
  static constexpr PhaseDomain k_domain{0, 1, false};

  Value<Mode, float> radius{0.36f}, part{1.f};

  Spots() : SolidTexture<Spots, Mode>({.size = 0.35f}) {}

  static constexpr auto parameters() {
    return std::tuple_cat(std::tuple{parameter("radius", &Spots::radius, "of the largest, in sizes").above(0).at_most(0.5),
                                     parameter("part", &Spots::part, "how many cubes have a ball").at_least(0).at_most(1)},
                          Spots::common_parameters());
  }

  // Sampled:
  PhaseMixture mixture(const Place& place) const {
    PhaseMixture mixture(SpreadPhase{0});
    mixture.cover({1}, ball_part(this->turbulent(place).turned(), radius, part, this->stream(2)));
    return mixture;
  }

  float profile(float phase) const { return phase; }
};

} // namespace kelpie
