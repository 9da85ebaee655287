// Every falloff q^2 (a + b q) is a sum of q^2, the quartic one, and q^3, the cubic one: what bounds these two bounds it, with a and b of
// any sign.
#pragma once

#include "field/potential/falloff.h"

namespace kelpie {

inline constexpr FalloffCurvature k_square_curvature = curvature(Falloff::quartic), k_cube_curvature = curvature(Falloff::cubic);
inline constexpr FalloffSlope k_square_slope = steepest(Falloff::quartic), k_cube_slope = steepest(Falloff::cubic);

/// The second derivative of a term of this weight is at least minus this / R^2 along a unit-speed line.
constexpr float most_bend(FalloffCurvature c, float weight) {
  const float down = static_cast<float>(c.c_plus) * weight, up = -static_cast<float>(c.c_minus) * weight;
  return down < up ? up : down;
}

} // namespace kelpie
