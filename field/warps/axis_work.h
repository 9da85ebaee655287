// How much work the inversion of axes is, for statistics.
#pragma once

#include <cstdint>

namespace kelpie {

struct AxisWork {
  uint64_t inversions = 0, newton_steps = 0;
  uint64_t in_lanes = 0, vectors = 0; ///< of the inversions those in SIMD lanes, and how many vectors these were

  AxisWork& operator+=(const AxisWork& w) {
    inversions += w.inversions, newton_steps += w.newton_steps, in_lanes += w.in_lanes, vectors += w.vectors;
    return *this;
  }
  friend AxisWork operator-(const AxisWork& a, const AxisWork& b) {
    return {a.inversions - b.inversions, a.newton_steps - b.newton_steps, a.in_lanes - b.in_lanes, a.vectors - b.vectors};
  }
};

/// That of this thread so far.
AxisWork& axis_work();

} // namespace kelpie
