// How much each feature leads at a place (methods.md, section 3).
//
// d_i is the signed distance to feature i, positive inside, in any unit. The weights w_i = omega_i / sum omega,
//   omega_i = max(0, d_i)^p      where the place is in any feature,
//             |d_i|^-p           where it is in none,
// are those of Biswas, Shapiro and Tsukanov (eq. 5 of Sanchez, Fryazinov, Vilbrandt and Pasko 2013) for p = 1; for p = 2 they are smooth at
// borders as well. They sum to 1 everywhere, and are continuous but where the borders of two features cross.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "base/dual.h"
#include "field/operators/operator.h"

namespace kelpie::feature_weights {

/// x^p for x >= 0.
inline double power(double x, double p) { return p == 2 ? x * x : p == 1 ? x : std::pow(x, p); }

/// omega_i of all features, in parts of the largest, and their sum.
inline double omegas(std::span<const double> d, double p, std::vector<double>& out) {
  const double best = *std::max_element(d.begin(), d.end());
  double sum = 0;
  out.clear();
  for (const double x : d) {
    const double part = x == best ? 1 : best > 0 ? std::max(0.0, x) / best : best / x; // 0 / 0 is 1: on both borders
    sum += out.emplace_back(power(part, p));
  }
  return sum;
}

/// The weights.
inline void normalised(std::span<const double> d, double p, std::vector<double>& out) {
  const double sum = omegas(d, p, out);
  for (double& w : out) w /= sum;
}

/// sum w_i g_i.
inline double mean(std::span<const double> d, std::span<const double> g, double p) {
  thread_local std::vector<double> omega;
  const double sum = omegas(d, p, omega);
  double weighted = 0;
  for (size_t i = 0; i < g.size(); ++i) weighted += omega[i] * g[i];
  return weighted / sum;
}

// --- over a box ---

/// The least that sum omega_i g_i / sum omega_i can be, each omega_i anywhere in its range and not all 0: it is where the omega of all that
/// is below the mean are largest, and of all that is above it least.
inline double least_mean(std::span<const Interval> omega, std::span<const double> g) {
  thread_local std::vector<size_t> order;
  order.clear();
  for (size_t i = 0; i < g.size(); ++i)
    if (omega[i].hi > 0) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return g[a] < g[b]; });
  double weighted = 0, sum = 0, least = std::numeric_limits<double>::infinity();
  for (const size_t i : order) weighted += omega[i].lo * g[i], sum += omega[i].lo;
  for (const size_t i : order) {
    if (!std::isfinite(omega[i].hi)) return std::min(least, g[i]); // it alone counts
    weighted += (omega[i].hi - omega[i].lo) * g[i], sum += omega[i].hi - omega[i].lo;
    least = std::min(least, weighted / sum);
  }
  return least;
}

inline Interval mean_range(std::span<const Interval> omega, std::span<const Interval> g) {
  thread_local std::vector<double> ends;
  ends.clear();
  for (const Interval& x : g) ends.push_back(x.lo);
  const double lo = least_mean(omega, ends);
  for (size_t i = 0; i < g.size(); ++i) ends[i] = -g[i].hi;
  return {lo, -least_mean(omega, ends)};
}

/// Of the features in whose range of distances a box lies: whether it is in any of them, or in none, throughout.
struct Where {
  double surely, maybe; ///< the largest distance is at least and at most this
  explicit Where(std::span<const Interval> d) : surely(d[0].lo), maybe(d[0].hi) {
    for (const Interval& x : d) surely = std::max(surely, x.lo), maybe = std::max(maybe, x.hi);
  }
  bool may_be_in_any() const { return maybe > 0; }
  bool may_be_in_none() const { return surely <= 0; }
};

/// omega_i where the box is in any feature: in parts of the largest that they can be.
inline void omegas_inside(std::span<const Interval> d, double p, const Where& where, std::vector<Interval>& out) {
  out.clear();
  const auto part = [&](double x) { return power(std::max(0.0, x) / where.maybe, p); };
  for (const Interval& x : d) out.push_back({part(x.lo), part(x.hi)});
}

/// omega_i where it is in none: in parts of that of a feature as far away as the nearest can be. Without bound where a border may be met.
inline void omegas_outside(std::span<const Interval> d, double p, const Where& where, std::vector<Interval>& out) {
  out.clear();
  const double nearest = -where.surely;
  const auto part = [&](double x) { return x < 0 ? power(nearest / -x, p) : std::numeric_limits<double>::infinity(); };
  for (const Interval& x : d) out.push_back({part(x.lo), part(x.hi)});
}

inline Interval hull_of(std::span<const Interval> g) {
  Interval all = g[0];
  for (const Interval& x : g) all = hull(all, x);
  return all;
}

inline Interval mean(std::span<const Interval> d, std::span<const Interval> g, double p) {
  if (g.size() == 1) return g[0];
  const Where where(d);
  if (where.may_be_in_none() && where.surely == 0) return hull_of(g); // somebody's border, or some feature's inside
  thread_local std::vector<Interval> omega;
  Interval range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  if (where.may_be_in_any()) omegas_inside(d, p, where, omega), range = mean_range(omega, g);
  if (where.may_be_in_none()) omegas_outside(d, p, where, omega), range = hull(range, mean_range(omega, g));
  return range;
}

// --- with derivatives ---

// omega_i in fixed parts of any unit has the derivative p omega_i / |d_i|.

template <int N>
Dual<double, N> mean(std::span<const Dual<double, N>> d, std::span<const Dual<double, N>> g, double p) {
  thread_local std::vector<double> distances, omega;
  distances.clear();
  for (const auto& x : d) distances.push_back(x.value);
  const double sum = omegas(distances, p, omega);
  Dual<double, N> r;
  for (size_t i = 0; i < g.size(); ++i) r.value += omega[i] * g[i].value / sum;
  for (size_t i = 0; i < g.size(); ++i) {
    if (omega[i] == 0) continue;
    add_scaled(r, omega[i] / sum, g[i]);
    if (distances[i] != 0) add_scaled(r, p * omega[i] / std::abs(distances[i]) * (g[i].value - r.value) / sum, d[i]);
  }
  return r;
}

/// The derivative of omega_i by d_i over a range of it; inside it rises with d_i, as p >= 1, and so it does outside.
inline Interval omega_slope(const Interval& d, double p, const Where& where) {
  const double unit = where.may_be_in_any() ? where.maybe : -where.surely;
  const auto at = [&](double x) {
    if (where.may_be_in_any()) return x > 0 ? p * std::pow(x / unit, p - 1) / unit : 0.0;
    return p * std::pow(unit / -x, p + 1) / unit;
  };
  return {at(d.lo), at(d.hi)};
}

/// Slopes are bounded where the box is in a feature throughout, or in none.
template <int N>
Dual<Interval, N> mean(std::span<const Dual<Interval, N>> d, std::span<const Dual<Interval, N>> g, double p) {
  if (g.size() == 1) return g[0];
  thread_local std::vector<Interval> distances, values, omega;
  distances.clear(), values.clear();
  for (const auto& x : d) distances.push_back(x.value);
  for (const auto& x : g) values.push_back(x.value);
  Dual<Interval, N> r;
  r.value = mean(std::span<const Interval>(distances), std::span<const Interval>(values), p);
  const Where where(distances);
  if (where.surely <= 0 && where.maybe >= 0) {
    r.d.fill(Interval::everything());
    return r;
  }
  if (where.may_be_in_any())
    omegas_inside(distances, p, where, omega);
  else
    omegas_outside(distances, p, where, omega);
  Interval sum(0.0);
  for (const Interval& x : omega) sum = sum + x;
  for (size_t i = 0; i < g.size(); ++i) {
    if (omega[i].hi == 0) continue;
    const double least_others = sum.lo - omega[i].lo, most_others = sum.hi - omega[i].hi;
    add_scaled(r, Interval{omega[i].lo / (omega[i].lo + most_others), omega[i].hi / (omega[i].hi + least_others)}, g[i]);
    add_scaled(r, omega_slope(distances[i], p, where) * (values[i] - r.value) / sum, d[i]);
  }
  return r;
}

} // namespace kelpie::feature_weights
