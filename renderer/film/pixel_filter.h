// Where samples lie around a pixel's centre.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "scene/film.h"

namespace kelpie {

/// Turns an even point of the unit square into an offset from the pixel's centre, in pixels, distributed
/// like the filter: every sample then weighs the same, and no pixel depends on its neighbours' samples.
class PixelFilterSampler {
public:
  explicit PixelFilterSampler(PixelFilter filter) : filter_(filter) {
    // The Gaussian, cut off at k_radius and lowered to 0 there: the inverse of its distribution, at equal steps of it.
    std::array<double, k_fine + 1> distribution{};
    for (size_t i = 0; i < k_fine; ++i) {
      const double x = k_radius * ((i + 0.5) / k_fine * 2 - 1);
      const double density = std::exp(-x * x / (2 * k_sigma * k_sigma)) - std::exp(-k_radius * k_radius / (2 * k_sigma * k_sigma));
      distribution[i + 1] = distribution[i] + density;
    }
    for (size_t i = 0, j = 0; j < k_table; ++j) {
      const double wanted = double(j) / k_table * distribution[k_fine];
      while (distribution[i + 1] <= wanted) ++i;
      const double within = (wanted - distribution[i]) / (distribution[i + 1] - distribution[i]);
      inverse_[j] = static_cast<float>(k_radius * ((double(i) + within) / k_fine * 2 - 1));
    }
    inverse_[k_table] = static_cast<float>(k_radius);
  }

  Vec2 offset(Vec2 u) const {
    switch (filter_) {
    case PixelFilter::centre: return Vec2(0);
    case PixelFilter::box: return u - Vec2(0.5f);
    case PixelFilter::gaussian: return {inverse(u.x), inverse(u.y)};
    }
    return Vec2(0);
  }

private:
  static constexpr size_t k_table = 1024, k_fine = 4096;
  /// About as wide as the eye forgives: sharper rings in motion, wider blurs.
  static constexpr double k_radius = 1.5, k_sigma = 0.5;

  float inverse(float u) const {
    const float place = u * k_table;
    const auto i = static_cast<uint32_t>(place); // u < 1
    return inverse_[i] + (inverse_[i + 1] - inverse_[i]) * (place - static_cast<float>(i));
  }

  PixelFilter filter_;
  std::array<float, k_table + 1> inverse_{};
};

} // namespace kelpie
