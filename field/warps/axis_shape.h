// What a user says of an axis of a deformation.
#pragma once

#include <vector>

#include "base/vec.h"

namespace kelpie {

/// How the angles of frames are interpolated along an axis.
enum class FrameInterpolation { cosine, linear };

struct AxisShape {
  std::vector<Vec3d> rest, deformed; ///< control points, as many of each
  int degree = 3;
  Vec3d normal{0.0}; ///< the first normal of the rest axis, or what of it is across; zero: any
  struct Frame {
    double at, angle; ///< a part of the rest axis' length; in radians, right-handed about the axis
  };
  std::vector<Frame> frames;
  FrameInterpolation interpolation = FrameInterpolation::cosine;
  double radius = 1, border = 0.25; ///< of the tube; of its border, as a part of the radius
};

} // namespace kelpie
