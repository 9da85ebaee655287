// Worley's cells: space divided among scattered points, each place to its nearest. The same on every machine, as noise.h.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "base/vec.h"
#include "materials/patterns/noise.h"

namespace kelpie {

/// One of the scattered points, seen from a place.
struct WorleyPoint {
  Vec3 offset{0};                                     ///< from it to the place
  float distance = std::numeric_limits<float>::max(); ///< the length of that, in cells
  uint32_t id = 0;                                    ///< a hash of its own
};

/// The nearest and the second nearest point to a place (Worley 1996, "A cellular texture basis function": F1 and F2).
struct WorleyCell {
  WorleyPoint first, second;

  /// F2 - F1: 0 at the border between two cells.
  float border() const { return second.distance - first.distance; }
  /// Its gradient.
  Vec3 border_gradient() const { return direction(second) - direction(first); }
  /// How far it is to the plane between both points, and the normal of that plane towards the first.
  float plane_distance() const {
    const float apart = std::max(glm::length(second.offset - first.offset), 1e-6f);
    return 0.5f * (second.distance + first.distance) * border() / apart;
  }
  Vec3 plane_normal() const { return glm::normalize(second.offset - first.offset); }

  /// From the point to the place, of length 1.
  static Vec3 direction(const WorleyPoint& point) { return point.offset / std::max(point.distance, 1e-6f); }
};

/// One point in each cell of the unit lattice, anywhere in its middle (`jitter` 1: in all of it; 0: at its centre).
inline WorleyCell worley(const Vec3& p, uint32_t seed, float jitter = 0.8f) {
  const LatticeCell cell(p, seed);
  const Vec3& f = cell.fraction();
  float nearest = std::numeric_limits<float>::max(), next = nearest; // squares
  WorleyCell found;
  const float margin = 0.5f * (1 - jitter);
  // How far off, at least, the points of the layer before, of this and of the next are, squared.
  const auto gap2 = [&](float at, int layer) {
    const float gap = layer == 0 ? 0.f : layer < 0 ? at + margin : 1 - at + margin;
    return gap * gap;
  };
  static constexpr int k_layers[3] = {0, -1, 1}; // what is near comes first, and spares the rest
  for (const int k : k_layers) {
    const float gap_z = gap2(f.z, k);
    if (gap_z > next) continue;
    for (const int j : k_layers) {
      const float gap_yz = gap_z + gap2(f.y, j);
      if (gap_yz > next) continue;
      for (const int i : k_layers) {
        if (gap_yz + gap2(f.x, i) > next) continue;
        const uint32_t h = cell.hash(i, j, k);
        const auto within = [&](uint32_t bits) { return margin + jitter * (static_cast<float>(bits & 1023) + 0.5f) / 1024; };
        const Vec3 offset =
            f - Vec3(static_cast<float>(i) + within(h), static_cast<float>(j) + within(h >> 10), static_cast<float>(k) + within(h >> 20));
        const float d2 = glm::dot(offset, offset);
        if (d2 >= next) continue;
        if (d2 < nearest) {
          found.second = found.first, next = nearest;
          found.first = {offset, 0, h}, nearest = d2;
        } else {
          found.second = {offset, 0, h}, next = d2;
        }
      }
    }
  }
  found.first.distance = std::sqrt(nearest);
  found.second.distance = std::sqrt(next);
  found.first.id = scrambled(found.first.id), found.second.id = scrambled(found.second.id);
  return found;
}

} // namespace kelpie
