// How much work the inversion of axes is, for statistics.
#pragma once

#include <cstdint>

namespace kelpie {

struct AxisWork {
  uint64_t inversions = 0, newton_steps = 0;

  AxisWork& operator+=(const AxisWork& w) {
    inversions += w.inversions, newton_steps += w.newton_steps;
    return *this;
  }
  friend AxisWork operator-(const AxisWork& a, const AxisWork& b) { return {a.inversions - b.inversions, a.newton_steps - b.newton_steps}; }
};

/// That of this thread: counted without a lock.
AxisWork& axis_work();

/// That of all threads so far. Exact while none of them inverts.
AxisWork all_axis_work();

} // namespace kelpie
