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
    // The Gaussian, cut off at k_radius and lowered to 0 there: inverse of its distribution by table.
    double sum = 0;
    std::array<double, k_table> density{};
    for (size_t i = 0; i < k_table; ++i) {
      const double x = k_radius * ((i + 0.5) / k_table * 2 - 1);
      sum += density[i] = std::exp(-x * x / (2 * k_sigma * k_sigma)) - std::exp(-k_radius * k_radius / (2 * k_sigma * k_sigma));
    }
    double cumulative = 0;
    for (size_t i = 0; i < k_table; ++i) cdf_[i + 1] = static_cast<float>((cumulative += density[i]) / sum);
    cdf_[k_table] = 1;
    for (size_t i = 0, guide = 0; guide < k_table; ++guide) {
      while (cdf_[i + 1] <= static_cast<float>(guide) / k_table) ++i;
      guides_[guide] = static_cast<uint16_t>(i);
    }
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
  static constexpr size_t k_table = 256;
  /// About as wide as the eye forgives: sharper rings in motion, wider blurs.
  static constexpr double k_radius = 1.5, k_sigma = 0.5;

  float inverse(float u) const {
    size_t i = guides_[static_cast<size_t>(u * k_table)]; // u < 1
    while (cdf_[i + 1] <= u) ++i;
    const float width = cdf_[i + 1] - cdf_[i];
    const float within = width > 0 ? (u - cdf_[i]) / width : 0.5f;
    return static_cast<float>(k_radius * ((static_cast<double>(i) + within) / k_table * 2 - 1));
  }

  PixelFilter filter_;
  std::array<float, k_table + 1> cdf_{};
  std::array<uint16_t, k_table> guides_{}; ///< where to begin to look: the entry that holds each 1 / k_table
};

} // namespace kelpie
