// Dual numbers: a value with its derivatives, by forward mode.
//
// Dual<double, 3> yields a field and its gradient; Dual<Interval, 3> bounds the gradient over a box (a
// local Lipschitz constant that nobody has to state); Dual<Interval, 1> bounds the derivative along a
// stretch of ray.
#pragma once

#include <array>

#include "base/interval.h"

namespace kelpie {

template <class T, int N>
struct Dual {
  T value{};
  std::array<T, N> d{};

  constexpr Dual() = default;
  constexpr Dual(double v) : value(v) {} // NOLINT: a number is a dual number
  constexpr Dual(T v, std::array<T, N> dv) : value(v), d(dv) {}
  /// The i-th independent variable.
  static constexpr Dual variable(T v, int i) {
    Dual x;
    x.value = v;
    x.d[i] = T(1.0);
    return x;
  }
};

/// A function of one dual number, by the chain rule: value g(a), derivative slope g'(a).
template <class T, int N>
constexpr Dual<T, N> chain(const Dual<T, N>& a, T value, T slope) {
  Dual<T, N> r;
  r.value = value;
  for (int i = 0; i < N; ++i) r.d[i] = slope * a.d[i];
  return r;
}

template <class T, int N>
constexpr Dual<T, N> operator-(const Dual<T, N>& a) {
  return chain(a, -a.value, T(-1.0));
}
template <class T, int N>
constexpr Dual<T, N> operator+(const Dual<T, N>& a, const Dual<T, N>& b) {
  Dual<T, N> r;
  r.value = a.value + b.value;
  for (int i = 0; i < N; ++i) r.d[i] = a.d[i] + b.d[i];
  return r;
}
template <class T, int N>
constexpr Dual<T, N> operator-(const Dual<T, N>& a, const Dual<T, N>& b) {
  Dual<T, N> r;
  r.value = a.value - b.value;
  for (int i = 0; i < N; ++i) r.d[i] = a.d[i] - b.d[i];
  return r;
}
template <class T, int N>
constexpr Dual<T, N> operator*(const Dual<T, N>& a, const Dual<T, N>& b) {
  Dual<T, N> r;
  r.value = a.value * b.value;
  for (int i = 0; i < N; ++i) r.d[i] = a.value * b.d[i] + a.d[i] * b.value;
  return r;
}
template <class T, int N>
constexpr Dual<T, N> operator/(const Dual<T, N>& a, const Dual<T, N>& b) {
  Dual<T, N> r;
  r.value = a.value / b.value;
  for (int i = 0; i < N; ++i) r.d[i] = (a.d[i] - r.value * b.d[i]) / b.value;
  return r;
}
template <class T, int N>
constexpr Dual<T, N> operator*(const Dual<T, N>& a, double b) {
  return chain(a, a.value * b, T(b));
}
template <class T, int N>
constexpr Dual<T, N> operator*(double a, const Dual<T, N>& b) {
  return b * a;
}
template <class T, int N>
constexpr Dual<T, N> operator+(const Dual<T, N>& a, double b) {
  return a + Dual<T, N>(b);
}
template <class T, int N>
constexpr Dual<T, N> operator+(double a, const Dual<T, N>& b) {
  return b + a;
}
template <class T, int N>
constexpr Dual<T, N> operator-(const Dual<T, N>& a, double b) {
  return a - Dual<T, N>(b);
}
template <class T, int N>
constexpr Dual<T, N> operator-(double a, const Dual<T, N>& b) {
  return Dual<T, N>(a) - b;
}

template <class T, int N>
constexpr Dual<T, N> max(const Dual<T, N>& a, const Dual<T, N>& b) {
  if (surely_greater(a.value, b.value)) return a;
  if (surely_greater(b.value, a.value)) return b;
  Dual<T, N> r;
  r.value = max(a.value, b.value);
  for (int i = 0; i < N; ++i) r.d[i] = either(a.d[i], b.d[i]);
  return r;
}
template <class T, int N>
constexpr Dual<T, N> min(const Dual<T, N>& a, const Dual<T, N>& b) {
  return -max(-a, -b);
}
template <class T, int N>
constexpr Dual<T, N> square(const Dual<T, N>& a) {
  return chain(a, square(a.value), 2.0 * a.value);
}
/// At 0 the slope is unbounded: Interval yields everything, a number yields a slope of 0.
template <int N>
inline Dual<double, N> sqrt(const Dual<double, N>& a) {
  const double s = std::sqrt(a.value);
  return chain(a, s, s > 0 ? 0.5 / s : 0.0);
}
template <int N>
inline Dual<Interval, N> sqrt(const Dual<Interval, N>& a) {
  const Interval s = sqrt(a.value);
  return chain(a, s, s.lo > 0 ? Interval{0.5 / s.hi, 0.5 / s.lo} : Interval::everything());
}

template <class T, int N>
inline Dual<T, N> cos(const Dual<T, N>& a) {
  return chain(a, cos(a.value), -sin(a.value));
}
template <class T, int N>
inline Dual<T, N> sin(const Dual<T, N>& a) {
  return chain(a, sin(a.value), cos(a.value));
}

/// `max(0, x)` and friends with a plain number on one side.
template <class T, int N>
constexpr Dual<T, N> max(double a, const Dual<T, N>& b) {
  return max(Dual<T, N>(a), b);
}
template <class T, int N>
constexpr Dual<T, N> min(double a, const Dual<T, N>& b) {
  return min(Dual<T, N>(a), b);
}

/// A set that holds both: for numbers the first one.
template <class T, int N>
constexpr Dual<T, N> either(const Dual<T, N>& a, const Dual<T, N>& b) {
  Dual<T, N> r;
  r.value = either(a.value, b.value);
  for (int i = 0; i < N; ++i) r.d[i] = either(a.d[i], b.d[i]);
  return r;
}

/// The values of any number type.
constexpr Interval range_of(double a) { return a; }
constexpr Interval range_of(Interval a) { return a; }
template <class T, int N>
constexpr Interval range_of(const Dual<T, N>& a) {
  return range_of(a.value);
}

/// a, of which it is known that it lies in `range`. Derivatives stay.
constexpr double within(double a, Interval) { return a; }
constexpr Interval within(Interval a, Interval range) { return intersect(a, range); }
template <class T, int N>
constexpr Dual<T, N> within(Dual<T, N> a, Interval range) {
  a.value = within(a.value, range);
  return a;
}

template <class Real>
constexpr Real clamp(const Real& x, double lo, double hi) {
  return max(Real(lo), min(Real(hi), x));
}

} // namespace kelpie
