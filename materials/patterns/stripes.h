#pragma once

#include "materials/patterns/solid_texture.h"

namespace kelpie {

template <class Mode>
struct Stripes : SolidTexture<Stripes, Mode> {
  static constexpr std::string_view k_name = "stripes";
  static constexpr std::string_view k_doc = R"(Stripes across a direction.

    phase   = direction . p / size + turbulence * noise(p / (size * turbulence_size))
    profile: 1 in a stripe, the part `width` of a period; 0 between; `softness` of the way from one to the other is soft)";
  static constexpr std::array<PlainStop, 2> k_default_stops{{{0.f, 0.72f, 0.7f, 0.66f, 0.3f}, {1.f, 0.05f, 0.1f, 0.22f, 0.3f}}};
  static constexpr PhaseDomain k_domain{0, 1, true};

  Value<Mode, Vec3> direction{Vec3(1, 0, 0)};
  Value<Mode, float> width{0.5f}, softness{0.f};

  static constexpr auto parameters() {
    return std::tuple_cat(std::tuple{parameter("direction", &Stripes::direction, "across the stripes").nonzero(),
                                     parameter("width", &Stripes::width, "of a stripe, in periods").at_least(0).at_most(1),
                                     parameter("softness", &Stripes::softness, "0: sharp, 1: a wave").at_least(0).at_most(1)},
                          Stripes::common_parameters());
  }

  // Sampled:
  PhaseMixture mixture(const Place& place) const { return phase(place); }

  SpreadPhase phase(const Place& place) const {
    const Vec3 along = glm::normalize(direction);
    return this->turbulent(place, glm::dot(along, place.p), along);
  }

  float profile(float phase) const {
    const float from_middle = std::abs(phase - std::floor(phase) - 0.5f); // of the stripe
    const float soft = std::max(0.5f * softness, 1e-6f);
    const float t = std::clamp((0.5f * width - from_middle) / soft + 0.5f, 0.f, 1.f);
    return t * t * (3 - 2 * t);
  }
};

} // namespace kelpie
