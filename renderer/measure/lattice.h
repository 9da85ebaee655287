// Regular lattices of nodes in space.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/box.h"

namespace kelpie {

/// Cubes side by side, `cells` of them along each axis; nodes are their corners.
struct Lattice {
  using Place = std::array<uint32_t, 3>;

  Vec3d origin{0}; ///< the first node
  double step = 1; ///< the cubes' side
  Place cells{};

  /// As fine as a cube of `resolution` cells along the longest side of `box`, and a cell wider than it all around.
  static Lattice around(const Box3d& box, int resolution) {
    const Vec3d extent = box.extent();
    Lattice l;
    l.step = std::max({extent.x, extent.y, extent.z}) / resolution;
    l.origin = box.lower - Vec3d(l.step);
    for (int a = 0; a < 3; ++a) l.cells[size_t(a)] = static_cast<uint32_t>(std::ceil(extent[a] / l.step - 1e-9)) + 2;
    return l;
  }

  size_t node_count() const { return (size_t(cells[0]) + 1) * (size_t(cells[1]) + 1) * (size_t(cells[2]) + 1); }
  size_t index(const Place& p) const { return p[0] + (size_t(cells[0]) + 1) * (p[1] + (size_t(cells[1]) + 1) * p[2]); }
  /// How far the indices of two nodes lie apart that differ by one step along the axes that are bits of `direction` (1 to 7).
  size_t stride(unsigned direction) const { return index({direction & 1, direction >> 1 & 1, direction >> 2 & 1}); }
  Vec3d at(const Place& p) const { return origin + step * Vec3d(p[0], p[1], p[2]); }
};

} // namespace kelpie
