// Falloffs: how a potential decreases from the skeleton to the end of its support.
//
// With u = d^2/R^2 and q = max(0, 1 - u), all three are polynomials in q (methods.md section 2):
//   quartic  q^2,   cubic  q^3,   wyvill  1 - 22u/9 + 17u^2/9 - 4u^3/9 = q^2 (5 + 4q)/9.
// So every falloff is q^2 (a + b q): one kernel serves all of them, and since a, b >= 0 and q >= 0
// interval arithmetic on that form is exact.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "base/dual.h"
#include "base/kind.h"

namespace kelpie {

enum class Falloff { quartic, cubic, wyvill };

template <>
struct EnumNames<Falloff> {
  static constexpr std::array<std::pair<std::string_view, Falloff>, 3> values{
      {{"quartic", Falloff::quartic}, {"cubic", Falloff::cubic}, {"wyvill", Falloff::wyvill}}};
};

/// The falloff is q^2 (a + b q).
struct FalloffPolynomial {
  double a, b;
};
constexpr FalloffPolynomial polynomial(Falloff f) {
  switch (f) {
  case Falloff::quartic: return {1, 0};
  case Falloff::cubic: return {0, 1};
  case Falloff::wyvill: return {5.0 / 9, 4.0 / 9};
  }
  return {1, 0};
}

/// Bounds of the second derivative along a unit-speed line, in units of weight / R^2 (design section 2):
/// for w > 0, -c_plus w/R^2 <= f'' <= c_minus w/R^2; for w < 0 the two change places.
struct FalloffCurvature {
  double c_plus, c_minus;
};
constexpr FalloffCurvature curvature(Falloff f) {
  switch (f) {
  case Falloff::quartic: return {4, 8};
  case Falloff::cubic: return {6, 4.8};
  case Falloff::wyvill: return {4.889, 4.745};
  }
  return {4, 8};
}

/// Where the slope |d falloff / d r| is largest, as u = r^2/R^2, and its value there in units of
/// weight / R. The slope rises up to `u` and falls beyond.
struct FalloffSlope {
  double u, most;
};
constexpr FalloffSlope steepest(Falloff f) {
  switch (f) {
  case Falloff::quartic: return {1.0 / 3, 1.5397};
  case Falloff::cubic: return {1.0 / 5, 1.7174};
  case Falloff::wyvill: return {0.2535, 1.5835}; // 11 - 51 u + 30 u^2 = 0
  }
  return {1.0 / 3, 1.5397};
}

/// The falloff at u = d^2/R^2 >= 0; 1 at u = 0, 0 from u = 1 on.
template <class Real>
constexpr Real falloff(Falloff f, const Real& u) {
  const Real q = max(Real(0.0), Real(1.0) - u);
  switch (f) {
  case Falloff::quartic: return square(q);
  case Falloff::cubic: return square(q) * q;
  case Falloff::wyvill: return square(q) * (Real(5.0) + 4.0 * q) * (1.0 / 9);
  }
  return square(q);
}

} // namespace kelpie
