// Unions, intersections and differences whose fields are smooth except where the surfaces cross: R-functions,
// for Booleans below a blend (field/operators/boolean.h chooses).
//
// With a = f_A - T, b = f_B - T (methods.md section 2):
//   u = T + (a + b + sqrt(a^2 + b^2)) / (2 - sqrt 2),   r = T + (a + b - sqrt(a^2 + b^2)) / (2 + sqrt 2).
// As they stand they have no local support (u of 0.5 T and 0 is 0.348 T), so with k(f) = max(0, 1 - f/T)^2
//   intersection  r(f_A, f_B) - k(f_A) r(0, f_B) - k(f_B) r(f_A, 0):        rises with both, 0 where either is 0
//   union         u(f_A, f_B) + k(f_A) (f_B - u(0, f_B)) + k(f_B) (f_A - u(f_A, 0)):   f_A where f_B is 0
// for f_A, f_B >= 0. Several operands are joined from the first to the last.
#pragma once

#include "field/operators/operator.h"
#include "field/skeletons/frame.h"

namespace kelpie {

/// The localised R-functions of fields >= 0 at threshold T, in units of T.
namespace r_function {

inline constexpr double k_root2 = 1.4142135623730950488;

inline double u(double a, double b) { return 1 + (a + b - 2 + norm(a - 1, b - 1)) / (2 - k_root2); }
inline double r(double a, double b) { return 1 + (a + b - 2 - norm(a - 1, b - 1)) / (2 + k_root2); }
inline double k(double f) { return square(std::max(0.0, 1 - f)); }
/// u and r rise with both operands, k falls.
inline Interval u(Interval a, Interval b) { return {u(a.lo, b.lo), u(a.hi, b.hi)}; }
inline Interval r(Interval a, Interval b) { return {r(a.lo, b.lo), r(a.hi, b.hi)}; }
inline Interval k(Interval f) { return {k(f.hi), k(f.lo)}; }

/// Derivatives by the first operand.
template <class T>
T slope_of_u(const T& a, const T& b) {
  return (T(1.0) + cosine(a - T(1.0), b - T(1.0))) * (1 / (2 - k_root2));
}
template <class T>
T slope_of_r(const T& a, const T& b) {
  return (T(1.0) - cosine(a - T(1.0), b - T(1.0))) * (1 / (2 + k_root2));
}
template <class T>
T slope_of_k(const T& f) {
  return max(T(0.0), T(1.0) - f) * -2.0;
}

/// f - u(0, f): concave, largest where u's slope is 1.
inline double rest(double f) { return f - u(0.0, f); }
inline Interval rest(Interval f) {
  constexpr double k_peak = 0.5449; // to four digits: flat there
  const double a = rest(f.lo), b = rest(f.hi), most = f.lo < k_peak && k_peak < f.hi ? rest(k_peak) + 1e-8 : std::max(a, b);
  return {std::min(a, b), most};
}

struct Unite {
  static double join(double a, double b) { return u(a, b) + k(a) * rest(b) + k(b) * rest(a); }
  template <class T>
  static T slope(const T& a, const T& b) {
    return slope_of_u(a, b) + slope_of_k(a) * rest(b) + k(b) * (T(1.0) - slope_of_u(a, T(0.0)));
  }
  /// Not quite monotone: term by term, met with the mean-value form, and hardly less than the larger operand. Without that the bounds of
  /// many operands, joined one after another, would grow without end.
  static Interval join(Interval a, Interval b) {
    const Interval natural = u(a, b) + k(a) * rest(b) + k(b) * rest(a);
    const double reach = 0.5 * (slope(a, b).magnitude() * a.width() + slope(b, a).magnitude() * b.width());
    const double at_middle = join(a.middle(), b.middle()), least = std::max(a.lo, b.lo) - k_below;
    const Interval met = intersect(natural, Interval{at_middle - reach, at_middle + reach});
    return {std::clamp(met.lo, std::max(least, 0.0), k_huge), std::clamp(met.hi, 0.0, k_huge)};
  }
  static constexpr double k_huge = 1e100;  ///< no field is as large; beyond it there are no numbers any more
  static constexpr double k_below = 0.045; ///< by 0.0439 at most, on a grid of steps of 1/1000
};

struct Intersect {
  static double join(double a, double b) { return r(a, b) - k(a) * r(0.0, b) - k(b) * r(a, 0.0); }
  template <class T>
  static T slope(const T& a, const T& b) {
    return max(T(0.0), slope_of_r(a, b) - slope_of_k(a) * r(T(0.0), b) - k(b) * slope_of_r(a, T(0.0)));
  }
  static Interval join(Interval a, Interval b) { return {join(a.lo, b.lo), join(a.hi, b.hi)}; }
};

template <class Function>
double join(double a, double b) {
  return Function::join(a, b);
}
template <class Function>
Interval join(Interval a, Interval b) {
  return Function::join(a, b);
}
template <class Function, class T, int N>
Dual<T, N> join(const Dual<T, N>& a, const Dual<T, N>& b) {
  Dual<T, N> f;
  f.value = Function::join(a.value, b.value);
  add_scaled(f, Function::slope(a.value, b.value), a);
  add_scaled(f, Function::slope(b.value, a.value), b);
  return f;
}

/// Joins fields in their own units; those after the first as `later` says.
template <class Function, class Real, class Later>
Real fold(std::span<const Real> f, double threshold, const Later& later) {
  const auto operand = [&](const Real& x) { return max(Real(0.0), x * (1 / threshold)); };
  Real joined = operand(f[0]);
  for (const Real& x : f.subspan(1)) joined = join<Function>(joined, operand(later(x)));
  return joined * threshold;
}
template <class Function, class Real>
Real fold(std::span<const Real> f, double threshold) {
  return fold<Function>(f, threshold, [](const Real& x) { return x; });
}

} // namespace r_function

} // namespace kelpie
