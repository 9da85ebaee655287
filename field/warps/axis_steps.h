// An axis of a deformation in cubic steps: at rest, where it goes, and the way from the one to the other.
#pragma once

#include <vector>

#include "field/warps/axis_curve.h"
#include "field/warps/axis_shape.h"

namespace kelpie {

/// From the deformed axis to the rest axis, over a step: shift, and the rotation from frame to frame less the identity.
struct AxisTurn {
  CubicStep<Vec3d> shift;
  CubicStep<Mat3d> turn;
};

/// Lists by steps, which are the same of both axes.
struct AxisSteps {
  std::vector<CubicStep<Vec3d>> deformed, rest;
  std::vector<AxisTurn> turns;
  std::vector<size_t> ends; ///< of each step: that after the last step of its section, between knots and frames
  std::vector<double> at;   ///< of each node, one more than steps: the part of the rest axis' length
};

/// Frames are as precise as this (entries of a rotation).
inline constexpr double k_frame_precision = 1e-6;

AxisSteps make_steps(const AxisShape&);

/// The largest entry, by its absolute value.
inline double most_entry(const Mat3d& m) {
  double most = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) most = std::max(most, std::abs(m[i][j]));
  return most;
}

} // namespace kelpie
