#pragma once

#include "materials/patterns/cellular.h"

namespace kelpie {

template <class Mode>
struct Dents : SolidTexture<Dents, Mode> {
  static constexpr std::string_view k_name = "dents";
  static constexpr std::string_view k_doc = R"(Dents as of a hammer, side by side: meant as a bump.

    phase   = the part of space that is nearer to a point of Worley's cells of p / size + turbulence * noise(p)
    profile = phase^(2/3): about the square of the distance, 0 in the middle of a dent, 1 on the highest ridges)";
  static constexpr std::array<PlainStop, 3> k_default_stops{
      {{0.f, 0.42f, 0.25f, 0.16f, 0.2f}, {0.6f, 0.55f, 0.33f, 0.215f, 0.24f}, {1.f, 0.68f, 0.43f, 0.29f, 0.3f}}};
  static constexpr PhaseDomain k_domain{0, 1, false};

  Dents() : SolidTexture<Dents, Mode>({.size = 0.25f}) {}

  static constexpr auto parameters() { return Dents::common_parameters(); }

  // Sampled:
  PhaseMixture mixture(const Place& straight) const {
    const float lost = distances_unseen(straight);
    if (lost == 1) return k_all_phases;
    const Place place = this->turbulent(straight).turned();
    PhaseMixture mixture(nearest_phase(worley(place.p, this->stream(2)), place));
    mixture.cover(k_all_phases, lost);
    return mixture;
  }

  float profile(float phase) const { return std::cbrt(phase * phase); }
};

} // namespace kelpie
