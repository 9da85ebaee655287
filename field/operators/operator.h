// What every operator is asked by the engine.
//
// An operator has, besides its table,
//   Real combine(span<const Real> f, double threshold, Demand mine)   its formula, for double, Interval and Dual
//   void keep(f, threshold, mine, kept)           which operands can matter in a cell where they lie in f
//   Demand demand_of_operands(mine, count)        what its operands must yield
// One that depends on the threshold has `bool scales_with_threshold(mine)`: combine(s f, s T) = s combine(f, T). A parameter
// that is animated moves the value one way: between two values of it, `combine` lies between those at both.
// With one operand left, `combine` must be either that operand or (k_is_clamped) its part above 0.
//
// The demand of `combine` is that of the node in the whole tree, given once at compile time, so that the
// field's value does not depend on the cell in which it is evaluated. That of `keep` is the cell's: where a
// blend has one operand left, that one needs no more than its sign.
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

/// Where what an operator makes of its children may be above 0: where any of them is (said of all that do not say otherwise by
/// `k_extent`), where all are, or where the first is.
enum class ExtentOf { any_child, all_children, first_child };
template <class Kind>
constexpr ExtentOf extent_of() {
  if constexpr (requires { Kind::k_extent; }) return Kind::k_extent;
  return ExtentOf::any_child;
}

/// The operands of an operator, in the order in which `combine` has them: its children, then its region.
template <class Kind>
std::vector<unsigned> operands_of(const Kind& kind) {
  std::vector<unsigned> operands = kind.children;
  if constexpr (requires { kind.region; }) operands.push_back(kind.region);
  return operands;
}

/// r += slope * x, of derivatives only; an unbounded slope leaves nothing to say (and no NaN).
template <int N>
void add_scaled(Dual<double, N>& r, double slope, const Dual<double, N>& x) {
  for (int i = 0; i < N; ++i) r.d[i] += slope * x.d[i];
}
template <int N>
void add_scaled(Dual<Interval, N>& r, Interval slope, const Dual<Interval, N>& x) {
  const bool is_bounded = std::isfinite(slope.hi);
  for (int i = 0; i < N; ++i) {
    if (x.d[i].lo == 0 && x.d[i].hi == 0) continue;
    r.d[i] = is_bounded ? r.d[i] + slope * x.d[i] : Interval::everything();
  }
}

} // namespace kelpie
