// Blobs as fits see them: ellipsoids.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "base/vec.h"

namespace kelpie {

/// W q^2, q = 1 - |u|^2, u = to_ball (p - centre).
struct Ellipsoid {
  Vec3d centre{0};
  Mat3d to_ball{1};
  double log_weight = 0;
};

/// A sum of such, or what one of them adds.
struct BlobValue {
  double value = 0;
  Vec3d gradient{0}; ///< with respect to p
};

inline void add_value(const Ellipsoid& b, const Vec3d& p, BlobValue& sum) {
  const Vec3d u = b.to_ball * (p - b.centre);
  const double q = 1 - glm::dot(u, u);
  if (q <= 0) return;
  const double wq = std::exp(b.log_weight) * q;
  sum.value += wq * q;
  sum.gradient -= 4 * wq * (u * b.to_ball); // the transpose times u
}

} // namespace kelpie
