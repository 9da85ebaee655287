// Whether a renderer's answer to a ray is right, as the design defines it: the field is followed along
// the same float32 ray in double precision; a hit is *missed* when f - T > 1e-4 T for longer than 1e-5
// scene sizes before the answer, and *false* when f - T < -1e-4 T throughout that distance around it.
#pragma once

#include "tests/reference/along_ray.h"

namespace reference {

struct Tolerance {
  double field = 1e-4;  ///< in thresholds
  double length = 1e-5; ///< in scene sizes
};

enum class Verdict { right, missed, false_hit };

/// `t_answer` is infinity when the renderer saw nothing. The ray's direction is a unit vector (to float32
/// precision); the profile covers the ray from its entry into the scene's box to its exit.
Verdict judge(const Profile&, double threshold, double scene_size, double t_answer, Tolerance = {});

/// Whether it is right that the part of a ray that the profile covers meets something (is dark), or nothing.
bool is_right_shadow(const Profile&, double threshold, double scene_size, bool is_dark, Tolerance = {});

} // namespace reference
