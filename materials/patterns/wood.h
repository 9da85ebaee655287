#pragma once

#include "materials/patterns/solid_texture.h"

namespace kelpie {

template <class Mode>
struct Wood : SolidTexture<Wood, Mode> {
  static constexpr std::string_view k_name = "wood";
  static constexpr std::string_view k_doc = R"(Wood: the rings of a trunk, and fine fibres along it.

    phase   = (|q| / size + turbulence * noise(p) + fibres * streaks(p)) / 8,   q from `centre` straight across `axis` to p
    profile: eight rings of several widths; in each, light early wood turns to dark late wood, which ends sharply

0 is early, 1 is late wood. `size` is the mean width of a ring. Cut along the axis it has a board's grain, cut across it has rings.
Fibres also darken fine streaks.)";
  static constexpr std::array<PlainStop, 4> k_default_stops{{{0.f, 0.235f, 0.145f, 0.085f, 0.42f},
                                                             {0.35f, 0.165f, 0.098f, 0.056f, 0.4f},
                                                             {0.7f, 0.098f, 0.055f, 0.032f, 0.38f},
                                                             {1.f, 0.05f, 0.027f, 0.017f, 0.36f}}};
  static constexpr PhaseDomain k_domain{0, 1, true};
  static constexpr int k_rings = 8; ///< in a period: no two of them as wide

  Value<Mode, Vec3> axis{Vec3(0.06f, 0.1f, 1)};
  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, float> fibres{0.5f};

  Wood() : SolidTexture<Wood, Mode>({.size = 0.12f, .turbulence = 0.5f, .turbulence_size = 7, .turbulence_octaves = 2}) {}

  static constexpr auto parameters() {
    return std::tuple_cat(std::tuple{parameter("axis", &Wood::axis, "of the trunk").nonzero(),
                                     parameter("centre", &Wood::centre, "a point of its heart").in(Unit::length),
                                     parameter("fibres", &Wood::fibres, "how strong they are").at_least(0).at_most(1)},
                          Wood::common_parameters());
  }

  // Sampled:
  PhaseMixture mixture(const Place& place) const {
    const NoiseSample streaks = this->streaks(place);
    PhaseMixture mixture(phase(place, streaks));
    const float dark = 0.93f / k_rings; // in the late wood of the first ring
    mixture.cover({dark},
                  1.1f * fibres * normal_below(streaks.value / std::sqrt(0.3f + streaks.variance + place.variance(streaks.gradient))));
    return mixture;
  }

  SpreadPhase phase(const Place& place) const { return phase(place, streaks(place)); }

  float profile(float phase) const {
    float ring = phase * k_rings, width = 1;
    for (int i = 0; i < k_rings; ++i, ring -= width) {
      width = ring_width(i);
      if (ring < width) break;
    }
    const float t = std::clamp(ring / width, 0.f, 1.f); // 0 where the year begins
    const float late = t * t * (0.35f + 0.65f * t * t);
    return t < 0.93f ? late / 0.85f : std::max(0.f, (1 - t) / 0.07f);
  }

private:
  /// They sum to k_rings.
  static constexpr float ring_width(int i) {
    constexpr std::array<float, k_rings> k_widths{1.15f, 0.7f, 1.3f, 0.95f, 0.6f, 1.45f, 1.05f, 0.8f};
    return k_widths[static_cast<size_t>(i)];
  }

  /// Noise drawn out along the axis.
  NoiseSample streaks(const Place& place) const {
    constexpr float k_across = 7, k_along = 0.25f;
    const Vec3 along = glm::normalize(axis);
    NoiseSample noise = place.scaled(along, k_along, k_across).noise({.octaves = 2, .gain = 0.6f, .seed = this->stream(2)});
    noise.gradient = Place{noise.gradient}.scaled(along, k_along, k_across).p;
    return noise;
  }

  SpreadPhase phase(const Place& place, const NoiseSample& streaks) const {
    const Vec3 along = glm::normalize(axis);
    const Vec3 q = place.p - centre / this->size, across = q - glm::dot(q, along) * along;
    const float radius = std::max(glm::length(across), 1e-6f), jitter = 0.05f * fibres;
    SpreadPhase phase = this->turbulent(place, radius + jitter * streaks.value, across / radius + jitter * streaks.gradient);
    phase.variance += jitter * jitter * streaks.variance;
    return {phase.mean / k_rings, phase.variance / (k_rings * k_rings)};
  }
};

} // namespace kelpie
