#pragma once

#include "materials/patterns/cellular.h"

namespace kelpie {

template <class Mode>
struct Dents : SolidTexture<Dents, Mode> {
  static constexpr std::string_view k_name = "dents";
  static constexpr std::string_view k_doc =
      R"(Dents as of a hammer, side by side. Its own stops are dents by their `bump_height`: 0 at 0, and a tenth of `size` at 1.

    phase   = the part of space that is nearer to a point of Worley's cells of p / size + turbulence * noise(p)
    profile = phase^(2/3): about the square of the distance, 0 in the middle of a dent, 1 on the highest ridges)";
  static constexpr std::array<PlainStop, 3> k_default_stops{
      {{0.f, 0.2f, 0.1f, 0.055f, 0.22f}, {0.6f, 0.45f, 0.25f, 0.15f, 0.25f, 0.06f}, {1.f, 0.74f, 0.48f, 0.32f, 0.3f, 0.1f}}};
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
