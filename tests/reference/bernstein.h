// Polynomials of degree 6 on an interval, as Bernstein coefficients.
//
// The form is chosen because it is sound: a polynomial lies between the least and the largest of its
// coefficients, so "no root here" is a fact and not the outcome of sampling; and because it is stable:
// coefficients are values near the interval, however far the ray's origin is.
#pragma once

#include <array>
#include <vector>

namespace reference {

constexpr int k_degree = 6; // the highest among the falloffs: a quadratic, cubed

/// The coefficients of a quadratic on the unit interval; the middle one is its polar form at the ends.
using Quadratic = std::array<double, 3>;

/// The polynomial sum_i c_i B_i(s) of s in [0, 1].
struct Polynomial {
  std::array<double, k_degree + 1> c{};

  double operator()(double s) const;
  double least() const;
  double most() const;
  /// The same polynomial on the part [from, to] of the interval, as one on [0, 1].
  Polynomial part(double from, double to) const;

  friend Polynomial operator+(Polynomial a, const Polynomial& b);
  friend Polynomial operator-(const Polynomial& a);
  friend Polynomial operator-(const Polynomial& a, const Polynomial& b) { return a + (-b); }
  friend Polynomial operator*(Polynomial a, double s);
};

Polynomial constant(double);
/// q^2 (a + b q).
Polynomial square_times_linear(const Quadratic& q, double a, double b);

/// Every s in (0, 1) where the polynomial may change sign, ascending, to about 1e-14. Where it only
/// comes within rounding of 0 (less than `noise`), a point is reported too.
std::vector<double> sign_changes(const Polynomial&, double noise);

} // namespace reference
