#pragma once

#include "materials/patterns/solid_texture.h"

namespace kelpie {

template <class Mode>
struct Checker : SolidTexture<Checker, Mode> {
  static constexpr std::string_view k_name = "checker";
  static constexpr std::string_view k_doc = R"(Cubes of side `size`, like the squares of a chess board: 0 and 1 in turn.

    value = floor(x / size) + floor(y / size) + floor(z / size) is odd ? 1 : 0

The cubes lie a thousandth of their side beside the origin, so that a floor at y = 0 is not on a border between them.)";
  static constexpr std::array<PlainStop, 2> k_default_stops{{{0.f, 0.03f, 0.03f, 0.032f, 0.25f}, {1.f, 0.72f, 0.7f, 0.66f, 0.25f}}};
  static constexpr PhaseDomain k_domain{0, 1, false};

  static constexpr auto parameters() { return Checker::common_parameters(); }

  // Sampled:
  PhaseMixture mixture(const Place& straight) const {
    constexpr float k_beside = 1e-3f;
    const Place place = this->turbulent(straight);
    float sign = 1 - unseen(0.5f * place.width());
    for (size_t axis = 0; axis < 3 && sign != 0; ++axis) {
      Vec3 along(0);
      along[axis] = 1;
      sign *= square_wave(place.p[axis] + k_beside, place.variance(along));
    }
    PhaseMixture mixture(SpreadPhase{0});
    mixture.cover({1}, 0.5f - 0.5f * sign);
    return mixture;
  }

  float profile(float phase) const { return phase; }

private:
  /// The mean of 1 in [0, 1), -1 in [1, 2), and so on, over a tent about x with this variance.
  static float square_wave(float x, float variance) {
    const float half = std::sqrt(6 * variance); // half the width of the tent
    if (half > 0.5f) return (twice_integrated(x + half) - 2 * twice_integrated(x) + twice_integrated(x - half)) / (half * half);
    const float t = within_period(x), sign = t < 1 ? 1.f : -1.f;
    const float to_border = 0.5f - std::abs(0.5f - (t < 1 ? t : t - 1)); // at most one is within the tent
    const float beyond = to_border < half ? 1 - to_border / half : 0.f;
    return sign * (1 - beyond * beyond);
  }
  /// A function of mean 0 whose second derivative is the square wave.
  static float twice_integrated(float x) {
    const float t = within_period(x);
    return t < 1 ? 0.5f * t * (t - 1) : -0.5f * (t - 1) * (t - 2);
  }
  static float within_period(float x) { return x - 2 * std::floor(0.5f * x); }
};

} // namespace kelpie
