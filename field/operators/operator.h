// What every operator is asked by the engine.
//
// An operator has, besides its table,
//   Real combine(span<const Real> f, double threshold)   its formula, for double, Interval and Dual
//   void keep(f, threshold, demand, kept)                 which operands can matter in a cell where they lie in f
//   Demand demand_of_operands(mine, count)                what its operands must yield
// With one operand left, `combine` must be either that operand or (difference) its part above 0.
#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include "base/dual.h"
#include "base/kind.h"

namespace kelpie {

/// What is asked of a node in a cell: only on which side of the threshold it is (unions, intersections
/// and differences up to the root), or its value (a blend above it).
enum class Demand { sign, value };

} // namespace kelpie
