// Union, intersection and difference whose fields are smooth except where the surfaces cross: R-functions,
// for Booleans below a blend. Where only the sign is asked for they are max and min, which have the same
// surface and the same normals, and cost less.
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
  /// Not quite monotone: term by term, met with the mean-value form.
  static Interval join(Interval a, Interval b) {
    const Interval natural = u(a, b) + k(a) * rest(b) + k(b) * rest(a);
    const double reach = 0.5 * (slope(a, b).magnitude() * a.width() + slope(b, a).magnitude() * b.width());
    const double at_middle = join(a.middle(), b.middle());
    return intersect(natural, Interval{at_middle - reach, at_middle + reach});
  }
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

/// Joins operands given by at(i), in scene units of the potential.
template <class Function, class Real, class At>
Real fold(size_t count, double threshold, const At& at) {
  const auto operand = [&](size_t i) { return max(Real(0.0), at(i) * (1 / threshold)); };
  Real f = operand(0);
  for (size_t i = 1; i < count; ++i) f = join<Function>(f, operand(i));
  return f * threshold;
}

} // namespace r_function

template <class Mode>
struct RUnion {
  static constexpr std::string_view k_name = "r_union";
  static constexpr std::string_view k_doc =
      R"(All that is inside one of its children, for use below a blend: its field has no crease off the surface.

    f = T + (a + b + sqrt(a^2 + b^2)) / (2 - sqrt 2),   a = f_A - T, b = f_B - T, T the threshold of the shape

Where no blend stands above it only the surface matters, and it is the `union`. Below a blend it is the formula in a
localised form, which is f_A where f_B is 0; the surface is the same. Negative values count as 0 there. Several
children are joined from the first to the last. Source: methods.md section 2.)";

  typename Mode::Children children;

  static constexpr auto parameters() { return std::tuple{parameter("children", &RUnion::children, "the fields to unite").required()}; }

  static constexpr bool k_is_clamped = true;
  static constexpr bool k_scales_with_threshold = true;

  template <class Real>
  Real combine(std::span<const Real> f, double threshold, Demand mine) const {
    if (mine == Demand::value) return r_function::fold<r_function::Unite, Real>(f.size(), threshold, [&](size_t i) { return f[i]; });
    Real most = f[0];
    for (const Real& x : f.subspan(1)) most = max(most, x);
    return most;
  }

  /// Where the sign is asked for, what is outside throughout; for the value, only what is 0.
  void keep(std::span<const Interval> f, double threshold, Demand mine, std::span<char> kept) const {
    for (size_t i = 0; i < f.size(); ++i) kept[i] = mine == Demand::sign ? f[i].hi >= threshold : f[i].hi > 0;
  }
  Demand demand_of_operands(Demand mine, size_t /*count*/) const { return mine; }
};

template <class Mode>
struct RIntersection {
  static constexpr std::string_view k_name = "r_intersection";
  static constexpr std::string_view k_doc =
      R"(All that is inside every one of its children, for use below a blend: its field has no crease off the surface.

    f = T + (a + b - sqrt(a^2 + b^2)) / (2 + sqrt 2),   a = f_A - T, b = f_B - T, T the threshold of the shape

Where no blend stands above it only the surface matters, and it is the `intersection`. Below a blend it is the formula
in a localised form, which is 0 where a child is; the surface is the same. Negative values count as 0 there. Several
children are joined from the first to the last. Source: methods.md section 2.)";

  typename Mode::Children children;

  static constexpr auto parameters() {
    return std::tuple{parameter("children", &RIntersection::children, "the fields to intersect").required()};
  }

  static constexpr bool k_is_clamped = true;
  static constexpr bool k_scales_with_threshold = true;

  template <class Real>
  Real combine(std::span<const Real> f, double threshold, Demand mine) const {
    if (mine == Demand::value) return r_function::fold<r_function::Intersect, Real>(f.size(), threshold, [&](size_t i) { return f[i]; });
    Real least = f[0];
    for (const Real& x : f.subspan(1)) least = min(least, x);
    return least;
  }

  /// Where the sign is asked for, what is inside throughout is dropped; for the value nothing is: an operand
  /// that does not reach is the constant 0.
  void keep(std::span<const Interval> f, double threshold, Demand mine, std::span<char> kept) const {
    for (size_t i = 0; i < f.size(); ++i) kept[i] = mine == Demand::value || f[i].lo <= threshold;
    if (std::find(kept.begin(), kept.end(), char(true)) == kept.end()) kept[0] = true; // full: "inside" must be said
  }
  Demand demand_of_operands(Demand mine, size_t /*count*/) const { return mine; }
};

template <class Mode>
struct RDifference {
  static constexpr std::string_view k_name = "r_difference";
  static constexpr std::string_view k_doc =
      R"(The first child without the others, for use below a blend: its field has no crease off the surface.

    f = the R-intersection of f_A and max(0, 2T - f_B),   T the threshold of the shape

Where no blend stands above it only the surface matters, and it is the `difference`. Below a blend it is the localised
form of `r_intersection`. Several children are carved away from the second to the last. Source: methods.md section 2.)";

  typename Mode::Children children;

  static constexpr auto parameters() {
    return std::tuple{parameter("children", &RDifference::children, "what to carve, then what to carve away").required()};
  }

  static constexpr bool k_is_clamped = true;
  static constexpr bool k_scales_with_threshold = true;

  template <class Real>
  Real combine(std::span<const Real> f, double threshold, Demand mine) const {
    const auto operand = [&](size_t i) { return i == 0 ? f[0] : Real(2 * threshold) - f[i]; };
    if (mine == Demand::value) return r_function::fold<r_function::Intersect, Real>(f.size(), threshold, operand);
    Real least = f[0];
    for (size_t i = 1; i < f.size(); ++i) least = min(least, operand(i));
    return max(Real(0.0), least);
  }

  /// What is carved away is dropped where it is outside throughout, if the sign is asked for; else never.
  void keep(std::span<const Interval> f, double threshold, Demand mine, std::span<char> kept) const {
    kept[0] = true;
    for (size_t i = 1; i < f.size(); ++i) kept[i] = mine == Demand::value || f[i].hi >= threshold;
  }
  Demand demand_of_operands(Demand mine, size_t /*count*/) const { return mine; }
};

} // namespace kelpie
