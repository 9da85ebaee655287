// Vectors: the names under which the project uses GLM.
#pragma once

#include <glm/glm.hpp>

namespace kelpie {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using Vec2d = glm::dvec2;
using Vec3d = glm::dvec3;
using Vec2i = glm::ivec2;
using Mat3 = glm::mat3;
using Mat3d = glm::dmat3;

/// Three coordinates of any number type (double, Interval, Dual…): what a field is evaluated at.
template <class Real>
struct Point3 {
  Real x, y, z;
};

} // namespace kelpie
