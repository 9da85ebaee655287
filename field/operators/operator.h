// What every operator is asked by the engine.
//
// An operator has, besides its table,
//   Real combine(span<const Real> f, double threshold, Demand mine)   its formula, for double, Interval and Dual
//   void keep(f, threshold, mine, kept)           which operands can matter in a cell where they lie in f
//   Demand demand_of_operands(mine, count)        what its operands must yield, where so many are kept
//   void shares(f, threshold, shares)             how much of the material of what it makes is of each operand: they sum to 1, or are
//                                                 all 0 where nothing is; not below 0 (Barbier, Galin, Akkouche, section 4)
// One that depends on the threshold has `bool scales_with_threshold(mine)`: combine(s f, s T) = s combine(f, T). Between two states
// of it, whose numbers are interpolated together, `combine` lies between those of both. Its operands are what its table leads to, in
// roles that the table says; one that sees some of them through maps, or several times, says so itself (field/operators/operands.h).
// What becomes of it where operands are dropped is said by `k_is_positional` and `k_lone`.
//
// The demand of `combine` is that of the node in the whole tree, given once at compile time, so that the
// field's value does not depend on the cell in which it is evaluated. That of `keep` is the cell's: where a
// blend has one operand left, that one needs no more than its sign.
#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include "base/dual.h"
#include "base/table.h"

namespace kelpie {

/// What is asked of a node in a cell: only on which side of the threshold it is (unions, intersections
/// and differences up to the root), or its value (a blend above it).
enum class Demand { sign, value };

/// Where what an operator makes of its children (operands of other roles do not count) may be above 0: where any of them is (said of all
/// that do not say otherwise by `k_extent`), where all are, or where the first is.
enum class ExtentOf { any_child, all_children, first_child };
template <class Kind>
constexpr ExtentOf extent_of() {
  if constexpr (requires { Kind::k_extent; }) return Kind::k_extent;
  return ExtentOf::any_child;
}

/// What is left of an operator whose operands have all been dropped but one: that operand itself (said of all that do not say otherwise by
/// `k_lone`), its part above 0, or still the operator.
enum class Lone { itself, above_0, combined };

/// One that tells its operands apart by their places has `k_is_positional = true`: what is dropped leaves the constant 0 in its place, and
/// `combine` always has as many values as there are operands.
template <class Kind>
constexpr bool is_positional() {
  if constexpr (requires { Kind::k_is_positional; }) return Kind::k_is_positional;
  return false;
}
template <class Kind>
constexpr Lone lone_of() {
  if constexpr (requires { Kind::k_lone; }) return Kind::k_lone;
  return is_positional<Kind>() ? Lone::combined : Lone::itself;
}

/// Shares of a sum of which each operand has its part; what is not above 0 has none.
inline void share_by(std::span<const double> parts, std::span<double> shares) {
  double sum = 0;
  for (size_t i = 0; i < parts.size(); ++i) sum += shares[i] = std::max(0.0, parts[i]);
  if (sum > 0)
    for (double& share : shares) share /= sum;
}

/// All to one.
inline void share_all_to(size_t index, std::span<double> shares) {
  std::fill(shares.begin(), shares.end(), 0.0);
  shares[index] = 1;
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
