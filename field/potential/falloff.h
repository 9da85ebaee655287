// Falloffs: how a potential decreases from the skeleton to the end of its support.
//
// With u = d^2/R^2 and q = max(0, 1 - u), all three are polynomials in q (methods.md section 2):
//   quartic  q^2,   cubic  q^3,   wyvill  1 - 22u/9 + 17u^2/9 - 4u^3/9 = q^2 (5 + 4q)/9.
// So every falloff is q^2 (a + b q): one kernel serves all of them, and since a, b >= 0 and q >= 0
// interval arithmetic on that form is exact.
#pragma once

#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "base/dual.h"
#include "base/kind.h"

namespace kelpie {

/// The page of the manual.
inline constexpr std::string_view k_falloff_doc = R"(How a potential falls from its skeleton to its end.

With d the distance from the skeleton, u = (d / radius)^2 and q = 1 - u, the potential is weight * falloff(u), 0 from u = 1 on:

    cubic     q^3                                              the default
    wyvill    1 - 22u/9 + 17u^2/9 - 4u^3/9 = q^2 (5 + 4q) / 9
    quartic   q^2

A lone skeleton of weight 2 has its surface, at the threshold 1, at 0.454 radius with `cubic`, 0.5 with `wyvill`, 0.541 with `quartic`;
`surface_radius` says where it is to be. All three end without a jump in their slope, so normals are continuous where one influence ends upon
another. What is reflected bends with the second derivative, which in units of weight / radius^2 jumps there by 8 with `quartic`, a kink
that polished metal shows, by 4.4 with `wyvill`, and not at all with `cubic`. Source of `wyvill`:
Wyvill, McPheeters, Wyvill, "Data structure for soft objects", 1986; methods.md section 2.)";

enum class Falloff { quartic, cubic, wyvill };

template <>
struct EnumNames<Falloff> {
  static constexpr std::array<std::pair<std::string_view, Falloff>, 3> values{
      {{"quartic", Falloff::quartic}, {"cubic", Falloff::cubic}, {"wyvill", Falloff::wyvill}}};
};

/// Of skeletons. Its second derivative does not jump where its support ends, so reflections have no kinks there.
inline constexpr Falloff k_default_falloff = Falloff::cubic;
/// Of skeletons: twice the default threshold, so that one by itself has a surface.
inline constexpr float k_default_weight = 2;

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

/// The u at which the falloff is `value`, in (0, 1): falloff(f, inverse_falloff(f, v)) = v. By Newton's method on q^2 (a + b q), which is
/// convex, from q = 1 down.
inline double inverse_falloff(Falloff f, double value) {
  const auto [a, b] = polynomial(f);
  double q = 1;
  for (int i = 0; i < 64; ++i) {
    const double next = q - (q * q * (a + b * q) - value) / (q * (2 * a + 3 * b * q));
    if (!(next < q)) break;
    q = next;
  }
  return 1 - q;
}

/// What every skeleton says of its parameter `surface_radius`.
inline constexpr std::string_view k_surface_radius_doc =
    "how far from the skeleton its surface lies where nothing else is near; `radius` follows from it, `weight` and the shape's threshold, "
    "which must be less";

/// The radius of influence of a skeleton whose own surface, where weight * falloff is `threshold`, lies at `surface_radius` from it.
/// 0 < threshold < weight.
inline double radius_of_influence(Falloff f, double surface_radius, double weight, double threshold) {
  return surface_radius / std::sqrt(inverse_falloff(f, threshold / weight));
}

} // namespace kelpie
