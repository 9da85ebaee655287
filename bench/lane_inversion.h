// The time of axial deformation in SIMD lanes.
#pragma once

#include <span>

#include "renderer/lanes/lane_warp.h"

namespace kelpie {

/// CPU seconds that one vector of places takes through a warp (Form::axial): inversions, rest points and velocities. Each waits for the
/// one before, as along a ray.
double time_lane_inversion(std::span<const LaneWarp> warps, const LaneAxis* axes, float size);

} // namespace kelpie
