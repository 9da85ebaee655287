#pragma once

#include "materials/patterns/solid_texture.h"

namespace kelpie {

template <class Mode>
struct Gradient : SolidTexture<Gradient, Mode> {
  static constexpr std::string_view k_name = "gradient";
  static constexpr std::string_view k_doc = R"(From 0 to 1 along a direction, over one `size` from the origin on.

    phase   = direction . p / size + turbulence * noise(p / (size * turbulence_size))
    profile = the phase, clamped)";
  static constexpr std::array<PlainStop, 3> k_default_stops{
      {{0.f, 0.02f, 0.035f, 0.09f, 0.3f}, {0.5f, 0.35f, 0.12f, 0.16f, 0.3f}, {1.f, 0.85f, 0.55f, 0.22f, 0.3f}}};
  static constexpr PhaseDomain k_domain{-3, 4, false};

  Value<Mode, Vec3> direction{Vec3(0, 1, 0)};

  static constexpr auto parameters() {
    return std::tuple_cat(std::tuple{parameter("direction", &Gradient::direction, "from 0 to 1").nonzero()}, Gradient::common_parameters());
  }

  // Sampled:
  PhaseMixture mixture(const Place& place) const {
    SpreadPhase shown = phase(place);
    if (shown.variance > 1) { // so wide that the way from 0 to 1 is a step
      shown.mean = 0.5f + (shown.mean - 0.5f) / std::sqrt(shown.variance);
      shown.variance = 1;
    }
    return shown;
  }

  SpreadPhase phase(const Place& place) const {
    const Vec3 along = glm::normalize(direction);
    return this->turbulent(place, glm::dot(along, place.p), along);
  }

  float profile(float phase) const { return std::clamp(phase, 0.f, 1.f); }
};

} // namespace kelpie
