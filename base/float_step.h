// How far float numbers are apart.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/box.h"

namespace kelpie {

/// How coarse float places are in a box, as a part of its diagonal: 6e-8 at most near the origin, more as it lies farther from it. 0 of an
/// empty box.
inline double float_step_in(const Box3d& box) {
  if (box.is_empty()) return 0;
  double farthest = 0;
  for (int k = 0; k < 3; ++k) farthest = std::max({farthest, std::abs(box.lower[k]), std::abs(box.upper[k])});
  const auto place = static_cast<float>(farthest);
  const double step = double(std::nextafter(place, std::numeric_limits<float>::infinity())) - double(place);
  return box.diagonal() > 0 ? step / box.diagonal() : 0;
}

/// From here on terraces show.
inline constexpr double k_coarse_step = 1e-4;

} // namespace kelpie
