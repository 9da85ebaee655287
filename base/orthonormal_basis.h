#pragma once

#include <cmath>

#include "base/vec.h"

namespace kelpie {

/// Three unit vectors at right angles around a given one, and the coordinates that they span: "local" (Duff et al. 2017).
struct OrthonormalBasis {
  Vec3 x, y, z;

  explicit OrthonormalBasis(const Vec3& unit_z) : z(unit_z) {
    const float sign = std::copysign(1.f, z.z), a = -1 / (sign + z.z), b = z.x * z.y * a;
    x = {1 + sign * z.x * z.x * a, sign * b, -sign * z.x};
    y = {b, sign + z.y * z.y * a, -z.y};
  }
  /// x lies along a direction, as far as that is at right angles to z; if it is not at all, anyhow.
  OrthonormalBasis(const Vec3& unit_z, const Vec3& along) : OrthonormalBasis(unit_z) {
    const Vec3 across = glm::cross(z, along);
    const float length = glm::length(across);
    if (length > 1e-4f * glm::length(along)) y = across / length, x = glm::cross(y, z);
  }
  Vec3 world_from_local(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
  Vec3 local_from_world(const Vec3& v) const { return {glm::dot(v, x), glm::dot(v, y), glm::dot(v, z)}; }
};

} // namespace kelpie
