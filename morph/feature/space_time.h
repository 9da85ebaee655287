// Space-time blending of two shapes (methods.md section 3; Pasko, Pasko and Kunii 2004; Pasko, Pasko, Ikeda and Kunii 2002).
//
// With one more dimension tau the shapes are two half-cylinders, of the source at tau < 0 and of the target at tau > 1, and the shape
// between is the section at tau of their bounded blend. So what has no counterpart neither fades nor breaks: matter flows there.
//
//   f_a = a /\ (-tau) - s D(a^2 + tau^2, max(0, tau + p/2)^2),        f_b the same of b and 1 - tau
//   F   = f_a \/ f_b + a_0 D((f_a / a_1)^2 + (f_b / a_2)^2, (f_3 / a_3)^2),     f_3 = (tau + p) /\ (1 + p - tau)
//   x \/ y = x + y + sqrt(x^2 + y^2),    x /\ y = x + y - sqrt(x^2 + y^2)
//   D(q, c) = (1 - r)^3 / (1 + r) with r = q / (q + c)
//
// a and b are the distances to the shapes, positive inside, in units of about their mean radius; tau = -p + (1 + 2 p) t, so that both
// ends lie where f_3 = 0 and the sections are exactly the shapes.
#pragma once

#include <cmath>

#include "field/operators/operator.h"
#include "field/skeletons/frame.h"
#include "morph/feature/feature_weights.h"

namespace kelpie::space_time {

/// What users may say of a blend.
struct Settings {
  double influence[3] = {1, 1, 1}; ///< a_1, a_2, a_3: how far the source, the target and the time between reach
  double passage = 3;              ///< p: how long the shapes stay before and after, in the time that they are apart
};

/// What fits two shapes.
struct Blend {
  double unit = 1;         ///< the length in which distances are measured
  double displacement = 4; ///< a_0: how much matter flows between
  friend bool operator==(const Blend&, const Blend&) = default;
};

// --- R-functions, which rise with both operands ---

inline double both(double x, double y) { return x + y - norm(x, y); }
inline double either_of(double x, double y) { return x + y + norm(x, y); }
inline Interval both(Interval x, Interval y) { return {both(x.lo, y.lo), both(x.hi, y.hi)}; }
inline Interval either_of(Interval x, Interval y) { return {either_of(x.lo, y.lo), either_of(x.hi, y.hi)}; }

template <class T, int N>
Dual<T, N> joined(T value, double sign, const Dual<T, N>& x, const Dual<T, N>& y) {
  Dual<T, N> f;
  f.value = value;
  add_scaled(f, T(1.0) + cosine(x.value, y.value) * sign, x);
  add_scaled(f, T(1.0) + cosine(y.value, x.value) * sign, y);
  return f;
}
template <class T, int N>
Dual<T, N> both(const Dual<T, N>& x, const Dual<T, N>& y) {
  return joined(both(x.value, y.value), -1.0, x, y);
}
template <class T, int N>
Dual<T, N> either_of(const Dual<T, N>& x, const Dual<T, N>& y) {
  return joined(either_of(x.value, y.value), 1.0, x, y);
}

// --- D(q, c) = c^3 / ((q + c)^2 (2 q + c)) for q >= 0: 1 at q = 0, falls with q, rises with c ---

inline double bump(double q, double c) { return c > 0 ? c * c * c / ((q + c) * (q + c) * (2 * q + c)) : 0; }
inline Interval bump(Interval q, Interval c) { return {bump(q.hi, c.lo), bump(q.lo, c.hi)}; }
/// By q: it becomes flatter with q.
inline double bump_slope(double q, double c) { return c > 0 ? -2 * bump(q, c) * (1 / (q + c) + 1 / (2 * q + c)) : 0; }
inline Interval bump_slope(Interval q, double c) { return {bump_slope(q.lo, c), bump_slope(q.hi, c)}; }
template <class T, int N>
Dual<T, N> bump(const Dual<T, N>& q, double c) {
  return chain(q, bump(q.value, T(c)), bump_slope(q.value, c));
}

// --- the blend; `Number` is a number, or over a stretch of time an interval ---

/// When it is, seen from both ends.
template <class Number>
struct Time {
  Number after_a, before_b; ///< tau, 1 - tau
  Number bound;             ///< f_3
  Number fade;              ///< 0 at both ends, 1 before halfway

  Time(const Number& t, const Settings& s) {
    const double whole = 1 + 2 * s.passage;
    after_a = t * whole - Number(s.passage), before_b = Number(1 + s.passage) - t * whole;
    bound = max(Number(0.0), both(after_a + Number(s.passage), before_b + Number(s.passage)));
    const Number x = clamp(min(t, Number(1.0) - t) * std::max(whole, 4.0), 0, 1);
    fade = x * x * (Number(3.0) - x * 2.0);
  }
};

/// The half-cylinder of a shape that ends after `time`.
template <class Real, class Number>
Real half_cylinder(const Real& shape, const Number& time, const Settings& s) {
  constexpr double k_shrinking = 0.2; // s: without it there is too much of both shapes in the middle
  const Number c = square(max(Number(0.0), time + Number(s.passage / 2)));
  return both(shape, Real(-time)) - bump(square(shape) + Real(square(time)), c) * k_shrinking;
}

/// Both half-cylinders at a place.
template <class Real>
struct Halves {
  Real a, b;

  template <class Number>
  Halves(const Real& in_a, const Real& in_b, const Time<Number>& time, const Blend& blend, const Settings& s)
      : a(half_cylinder(in_a * (1 / blend.unit), time.after_a, s)), b(half_cylinder(in_b * (1 / blend.unit), time.before_b, s)) {}
};

/// What the half-cylinders and the flow between them make at a place.
template <class Real>
struct Matter {
  Real shapes, flow; ///< f_a \/ f_b, D

  Real distance(const Blend& blend) const { return (shapes + flow * blend.displacement) * blend.unit; }
};

template <class Real, class Number>
Matter<Real> matter(const Halves<Real>& f, const Time<Number>& time, const Settings& s) {
  const Real q = square(f.a * (1 / s.influence[0])) + square(f.b * (1 / s.influence[1]));
  return {either_of(f.a, f.b), bump(q, square(time.bound * (1 / s.influence[2])))};
}

/// The section at t in [0, 1], positive inside; `a` and `b` are the distances to the source and the target. It is a at t = 0, b at
/// t = 1, and between them no distance, but as steep as one at the surface where a_0 does not count.
template <class Real, class Number>
Real section(const Real& a, const Real& b, const Number& t, const Blend& blend, const Settings& s) {
  const Time<Number> time(t, s);
  const Real blended = matter(Halves<Real>(a, b, time, blend, s), time, s).distance(blend);
  const auto from = [&](const Real& end) { return end * Real(Number(1.0) - time.fade) + blended * Real(time.fade); };
  const Interval when = range_of(t);
  return when.hi <= 0.5 ? from(a) : when.lo >= 0.5 ? from(b) : either(from(a), from(b));
}

/// The share of the source in what is there (Sanchez et al. 2015, transfinite interpolation): inside one half-cylinder all is its own.
inline double share_of_source(double a, double b, double t, const Blend& blend, const Settings& s) {
  const Halves<double> f(a, b, Time<double>(t, s), blend, s);
  if (f.a > 0 || f.b > 0) return f.a > f.b;
  const double sum = f.a + f.b;
  return sum < 0 ? f.b / sum : 0.5;
}

// --- several ---

/// t of two objects with weights v and w that are not both 0.
inline double part_of_way(double v, double w) { return w / (v + w); }
inline Interval part_of_way(Interval v, Interval w) {
  const double least = v.hi + w.lo > 0 ? w.lo / (v.hi + w.lo) : 0, most = v.lo + w.hi > 0 ? w.hi / (v.lo + w.hi) : 1;
  return {least, most};
}

/// The mean by weights that are not negative, and not all 0.
template <class Real>
Real mean(std::span<const double> weights, std::span<const Real> values) {
  if (values.size() == 1) return values[0];
  double sum = 0;
  for (const double w : weights) sum += w;
  Real mean(0.0);
  for (size_t i = 0; i < values.size(); ++i) mean = mean + values[i] * (weights[i] / sum);
  return mean;
}
inline Interval mean(std::span<const Interval> weights, std::span<const Interval> values) {
  return feature_weights::mean_range(weights, values);
}

} // namespace kelpie::space_time
