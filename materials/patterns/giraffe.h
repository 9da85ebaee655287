#pragma once

#include "materials/patterns/cellular.h"

namespace kelpie {

template <class Mode>
struct Giraffe : SolidTexture<Giraffe, Mode> {
  static constexpr std::string_view k_name = "giraffe";
  static constexpr std::string_view k_doc = R"(A giraffe's coat: dark polygons with light gaps between them.

    phase   = the part of space that is nearer to a border of Worley's cells of p / size + turbulence * noise(p)
    profile: 0 in the gaps, which are the part `gaps` of space; from 0.6 to 1 in the patches, darkest in the middle)";
  static constexpr std::array<PlainStop, 4> k_default_stops{{{0.f, 0.62f, 0.47f, 0.29f, 0.55f},
                                                             {0.45f, 0.36f, 0.19f, 0.085f, 0.5f},
                                                             {0.75f, 0.21f, 0.085f, 0.03f, 0.5f},
                                                             {1.f, 0.1f, 0.036f, 0.013f, 0.5f}}};
  static constexpr PhaseDomain k_domain{0, 1, false};

  Value<Mode, float> gaps{0.26f};

  Giraffe() : SolidTexture<Giraffe, Mode>({.size = 0.42f, .turbulence = 0.05f, .turbulence_size = 0.7f, .turbulence_octaves = 3}) {}

  static constexpr auto parameters() {
    return std::tuple_cat(std::tuple{parameter("gaps", &Giraffe::gaps, "their part of space").at_least(0).at_most(1)},
                          Giraffe::common_parameters());
  }

  // Sampled:
  PhaseMixture mixture(const Place& straight) const {
    return border_mixture(
        straight, [this](const Place& place) { return this->turbulent(place); }, this->stream(2));
  }

  float profile(float phase) const {
    const float within = std::max(phase - gaps, 0.f);
    return std::min(within / 0.035f, 1.f) * (0.6f + 0.4f * std::min(within / (1.001f - gaps), 1.f));
  }
};

} // namespace kelpie
