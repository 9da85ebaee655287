// Values of the project as JSON.
#pragma once

#include <cmath>

#include <nlohmann/json.hpp>

#include "base/vec.h"

namespace kelpie {

using Json = nlohmann::ordered_json; ///< keys keep their order

inline Json json_point(const Vec3d& v) { return {v.x, v.y, v.z}; }

/// Rounded to whole `steps` of a unit; never -0.
inline double rounded(double x, double steps) { return std::round(steps * x) / steps + 0.0; }
inline Json json_point(const Vec3d& v, double steps) { return {rounded(v.x, steps), rounded(v.y, steps), rounded(v.z, steps)}; }

} // namespace kelpie
