// The path of a part of the liquid.
#pragma once

#include <vector>

#include "base/spline.h"
#include "base/vec.h"

namespace kelpie {

/// A smooth curve over t in [0, 1] along a polyline of at least two points, on which equal steps of t are about equal lengths. Its ends
/// are those of the polyline; corners between them are smoothed.
Spline<Vec3d> flow_path(const std::vector<Vec3d>& way);

} // namespace kelpie
