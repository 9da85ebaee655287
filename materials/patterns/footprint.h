// What a pixel sees of a surface.
#pragma once

#include "base/vec.h"

namespace kelpie {

/// What a pixel sees of a surface at one point: the parallelogram of two vectors, their full lengths. Zero: only the point.
struct Footprint {
  Vec3 u{0}, v{0};

  bool is_point() const { return u == Vec3(0) && v == Vec3(0); }
};

} // namespace kelpie
