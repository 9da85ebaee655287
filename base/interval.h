// Interval arithmetic in double precision: what a formula can yield over a box or a stretch of ray.
//
// Bounds are not rounded outward: a formula of some tens of operations errs by about 1e-14 of its
// terms, and every decision that is built on an interval keeps a margin of 1e-6 or more.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace kelpie {

/// The closed interval [lo, hi].
struct Interval {
  double lo = 0, hi = 0;

  constexpr Interval() = default;
  constexpr Interval(double v) : lo(v), hi(v) {} // NOLINT: a number is an interval
  constexpr Interval(double l, double h) : lo(l), hi(h) {}

  static constexpr Interval everything() { return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()}; }
  constexpr double width() const { return hi - lo; }
  constexpr double middle() const { return 0.5 * (lo + hi); }
  /// The largest absolute value.
  constexpr double magnitude() const { return std::max(std::abs(lo), std::abs(hi)); }
  constexpr bool contains(double v) const { return lo <= v && v <= hi; }
};

constexpr Interval operator-(Interval a) { return {-a.hi, -a.lo}; }
constexpr Interval operator+(Interval a, Interval b) { return {a.lo + b.lo, a.hi + b.hi}; }
constexpr Interval operator-(Interval a, Interval b) { return {a.lo - b.hi, a.hi - b.lo}; }
/// An unbounded factor with one that may be 0 says nothing.
constexpr Interval operator*(Interval a, Interval b) {
  const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  const double lo = std::min(std::min(p, q), std::min(r, s)), hi = std::max(std::max(p, q), std::max(r, s));
  return lo <= hi ? Interval{lo, hi} : Interval::everything(); // 0 times infinity is no number
}
constexpr Interval operator*(Interval a, double b) { return b >= 0 ? Interval{a.lo * b, a.hi * b} : Interval{a.hi * b, a.lo * b}; }
constexpr Interval operator*(double a, Interval b) { return b * a; }
inline Interval operator/(Interval a, Interval b) {
  return b.lo <= 0 && b.hi >= 0 ? Interval::everything() : a * Interval{1 / b.hi, 1 / b.lo};
}

constexpr Interval hull(Interval a, Interval b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; }
/// Both bounds hold; where rounding makes them miss each other, their gap's ends are kept.
constexpr Interval intersect(Interval a, Interval b) {
  const double lo = std::max(a.lo, b.lo), hi = std::min(a.hi, b.hi);
  return lo <= hi ? Interval{lo, hi} : Interval{hi, lo};
}

constexpr Interval max(Interval a, Interval b) { return {std::max(a.lo, b.lo), std::max(a.hi, b.hi)}; }
constexpr Interval min(Interval a, Interval b) { return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)}; }
constexpr Interval square(Interval a) {
  const double p = a.lo * a.lo, q = a.hi * a.hi;
  return {a.lo <= 0 && a.hi >= 0 ? 0 : std::min(p, q), std::max(p, q)};
}
inline Interval sqrt(Interval a) { return {std::sqrt(std::max(a.lo, 0.0)), std::sqrt(std::max(a.hi, 0.0))}; }

/// Exact: 1 and -1 are reached at the multiples of pi.
inline Interval cos(Interval a) {
  constexpr double k_pi = 3.14159265358979323846;
  if (!(a.width() < 2 * k_pi)) return {-1, 1};
  const double p = std::cos(a.lo), q = std::cos(a.hi), n = std::ceil(a.lo / k_pi);
  Interval r{std::min(p, q), std::max(p, q)};
  if (n * k_pi > a.hi) return r;
  if ((n + 1) * k_pi <= a.hi) return {-1, 1};
  (std::fmod(n, 2) == 0 ? r.hi : r.lo) = std::fmod(n, 2) == 0 ? 1 : -1;
  return r;
}
inline Interval sin(Interval a) { return cos(a - Interval(1.57079632679489661923)); }

// The same names for plain numbers, so that one template serves both.
constexpr double max(double a, double b) { return a > b ? a : b; }
constexpr double min(double a, double b) { return a < b ? a : b; }
constexpr double square(double a) { return a * a; }
inline double sqrt(double a) { return std::sqrt(a); }
inline double cos(double a) { return std::cos(a); }
inline double sin(double a) { return std::sin(a); }

/// Whether a > b, or a < b, throughout.
constexpr bool surely_greater(double a, double b) { return a > b; }
constexpr bool surely_greater(Interval a, Interval b) { return a.lo > b.hi; }
/// A set that holds both values: for numbers the first one (a kink has no single derivative).
constexpr double either(double a, double) { return a; }
constexpr Interval either(Interval a, Interval b) { return hull(a, b); }

} // namespace kelpie
