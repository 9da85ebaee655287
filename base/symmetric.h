// Symmetric 3 x 3 matrices.
#pragma once

#include "base/vec.h"

namespace kelpie {

/// Its six numbers; at first the identity. Of what is positive definite so is any mean, which never stretches more than the one that
/// stretches most, nor less than the one that stretches least.
struct SymmetricMat3 {
  float xx = 1, yy = 1, zz = 1, xy = 0, xz = 0, yz = 0;

  Vec3d operator()(const Vec3d& d) const {
    return {xx * d.x + xy * d.y + xz * d.z, xy * d.x + yy * d.y + yz * d.z, xz * d.x + yz * d.y + zz * d.z};
  }
  bool is_identity() const { return *this == SymmetricMat3{}; }
  Mat3d matrix() const { return {{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}; }

  friend bool operator==(const SymmetricMat3&, const SymmetricMat3&) = default;
};

} // namespace kelpie
