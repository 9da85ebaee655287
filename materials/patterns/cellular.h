// What patterns of cells have in common.
#pragma once

#include "materials/patterns/solid_texture.h"
#include "materials/worley.h"

namespace kelpie {

/// How much a pattern of unit cells is its mean over a footprint.
inline float cells_unseen(const Place& place) { return unseen(1.3f * place.width()); }

/// The two cells that a footprint is in, and which part of it is in the first.
struct TwoCells {
  WorleyCell cell;
  float part = 1;

  TwoCells(const Place& place, uint32_t seed) : cell(worley(place.p, seed)) {
    const float width = std::sqrt(12 * place.variance(cell.plane_normal())); // of a box with that variance
    if (width > 0) part = std::min(0.5f + cell.plane_distance() / width, 1.f);
  }

  /// The mean over both of what `of` says of each.
  template <class Of>
  float mean(const Of& of) const {
    return part < 1 ? part * of(cell.first) + (1 - part) * of(cell.second) : of(cell.first);
  }
};

} // namespace kelpie
