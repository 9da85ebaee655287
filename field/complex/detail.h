// How finely complex primitives are expanded: into as many pieces as their detail asks for.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/box.h"

namespace kelpie {

/// How the camera sees a primitive, in the primitive's own space.
struct PixelScale {
  Vec3 eye{0};
  float per_distance = 0; ///< the size of a pixel, as a part of its distance from the eye; 0: no camera is known
};

/// What a complex primitive is given when a frame is sampled and compiled.
struct Expansion {
  PixelScale pixels;
  uint32_t first = 0, count = 0; ///< its pieces, in SampledField::nodes
};

/// How finely each part of a primitive is divided. Of several moments the largest numbers serve them all: so they get the same
/// pieces, in the same order.
using Divisions = std::vector<uint32_t>;

/// A part is divided into no more pieces than this along a line.
inline constexpr uint32_t k_most_divisions = 128;
/// The detail where no camera is known: this part of a primitive's size.
inline constexpr double k_relative_detail = 1.0 / 500;

/// By how much a part of a primitive within `box` may differ from what it is expanded to, in the primitive's units: `detail`
/// or, where that is 0, as many pixels as said at the box's nearest place.
inline double chord_error(float detail, float detail_pixels, const PixelScale& pixels, const Box3d& box) {
  if (detail > 0) return detail;
  if (pixels.per_distance == 0) return k_relative_detail * box.diagonal();
  const Vec3d eye(pixels.eye);
  return double(detail_pixels) * double(pixels.per_distance) * glm::distance(eye, glm::clamp(eye, box.lower, box.upper));
}

/// The least number of equal steps in which chords follow a curve with that error, if its second derivative over the whole is at
/// most `bend`: they are apart by at most bend / (8 n^2). Rounded up to 2^k or 3 2^k, so that it changes seldom from frame to frame.
inline uint32_t divisions_for(double bend, double error) {
  const double most = k_most_divisions, least = error > 0 ? std::sqrt(bend / (8 * error)) : bend > 0 ? most : 1;
  uint32_t n = 1;
  while (n < std::min(least, most)) n = n < 3 ? n + 1 : n % 3 == 0 ? n / 3 * 4 : n / 2 * 3;
  return n;
}

/// Raises `all` to `more`, element by element.
inline void extend(Divisions& all, const Divisions& more) {
  all.resize(std::max(all.size(), more.size()), 1);
  for (size_t i = 0; i < more.size(); ++i) all[i] = std::max(all[i], more[i]);
}

} // namespace kelpie
