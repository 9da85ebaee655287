// The mean of several rotations.
#pragma once

#include <span>
#include <vector>

#include "base/vec.h"

namespace kelpie {

struct RotationMean {
  Mat3d mean{1.0};
  double farthest = 0; ///< the largest angle between the mean and a rotation that counts, in radians
};

/// The intrinsic mean on SO(3): the rotation from which the sum of w_i angle_i^2 is least (Moakher 2002). It is unique where all
/// rotations that count lie within a right angle of one. `weights` are not negative, and sum to 1; of two rotations it is the one that
/// slerp yields.
RotationMean mean_rotation(std::span<const Mat3d> rotations, std::span<const double> weights);

} // namespace kelpie
