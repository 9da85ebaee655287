// The faces of a convex hull.
#pragma once

#include <span>
#include <vector>

#include "field/skeletons/frame.h"

namespace kelpie {

/// A convex polygon in the plane across the axis of `frame`, which leads out of the hull: corners in (u, v), counterclockwise.
struct HullFace {
  AxisFrame frame;
  std::vector<Vec2d> corners;
};

/// Of at least one point. Points in a plane have a face on either side; on a line, or in one place, a flat one. A corner lies
/// off its face by 2e-7 of the size at most, so that corners rounded to float may share one; faces may overlap.
std::vector<HullFace> hull_faces(std::span<const Vec3> points);

} // namespace kelpie
