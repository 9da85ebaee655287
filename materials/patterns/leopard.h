#pragma once

#include "materials/patterns/cellular.h"

namespace kelpie {

template <class Mode>
struct Leopard : SolidTexture<Leopard, Mode> {
  static constexpr std::string_view k_name = "leopard";
  static constexpr std::string_view k_doc = R"(A leopard's coat: broken dark rings about a brown middle on a light ground.

    phase   = the part of space that is nearer to a point of Worley's cells of p / size + turbulence * noise(p)
    profile: 0.5 in the middle, 1 on the ring, 0 on the ground beyond it

`rosettes` is the part of space that they take. Rings are broken where noise is high: there the ground shows.)";
  static constexpr std::array<PlainStop, 3> k_default_stops{
      {{0.f, 0.56f, 0.4f, 0.22f, 0.55f}, {0.5f, 0.34f, 0.175f, 0.065f, 0.55f}, {1.f, 0.025f, 0.016f, 0.01f, 0.5f}}};
  static constexpr PhaseDomain k_domain{0, 1, false};

  Value<Mode, float> rosettes{0.5f};

  Leopard() : SolidTexture<Leopard, Mode>({.size = 0.28f, .turbulence = 0.07f, .turbulence_size = 0.6f, .turbulence_octaves = 3}) {}

  static constexpr auto parameters() {
    return std::tuple_cat(std::tuple{parameter("rosettes", &Leopard::rosettes, "their part of space").above(0).at_most(1)},
                          Leopard::common_parameters());
  }

  // Sampled:
  PhaseMixture mixture(const Place& straight) const {
    const float lost = distances_unseen(straight);
    const float broken = straight.scaled(2.2f).part_above(0.9f, 0.08f, {.octaves = 1, .seed = this->stream(3)});
    const Place place = this->turbulent(straight).turned();
    PhaseMixture mixture(lost < 1 ? nearest_phase(worley(place.p, this->stream(2)), place) : k_all_phases);
    mixture.cover(k_all_phases, lost);
    mixture.cover({1}, broken); // by ground
    return mixture;
  }

  float profile(float phase) const {
    const float ring = 0.36f * rosettes; // where it begins
    const auto step = [](float x) { return std::clamp(0.5f + x / 0.03f, 0.f, 1.f); };
    return (0.5f + 0.5f * step(phase - ring)) * (1 - step(phase - rosettes));
  }
};

} // namespace kelpie
