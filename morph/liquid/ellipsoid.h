// Blobs as fits see them: ellipsoids. Lengths are in units of the shape's diagonal.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec.h"

namespace kelpie {

/// W q^2, q = 1 - |u|^2, u = to_ball (p - centre).
struct Ellipsoid {
  Vec3d centre{0};
  Mat3d to_ball{1};
  double log_weight = 0;
};

/// What a blob adds to the sum at a point, or the sum.
struct BlobValue {
  double value = 0;
  Vec3d gradient{0}; ///< with respect to the point
};

/// `u` is where in the unit ball of the blob, whose weight is `weight`, the point is.
inline void add_value(const Ellipsoid& b, double weight, const Vec3d& u, BlobValue& sum) {
  const double q = 1 - glm::dot(u, u);
  if (q <= 0) return;
  sum.value += weight * q * q;
  sum.gradient -= 4 * weight * q * (u * b.to_ball); // the transpose times u
}

/// Half the box around it, along an axis.
inline double half_extent(const Mat3d& from_ball, int axis) {
  return std::sqrt(from_ball[0][axis] * from_ball[0][axis] + from_ball[1][axis] * from_ball[1][axis] +
                   from_ball[2][axis] * from_ball[2][axis]);
}

/// The radius of a ball that holds the ellipsoid: at most sqrt(3) times its longest half axis.
inline double reach_of(const Ellipsoid& b) {
  const Mat3d from_ball = glm::inverse(b.to_ball);
  return std::sqrt(glm::dot(from_ball[0], from_ball[0]) + glm::dot(from_ball[1], from_ball[1]) + glm::dot(from_ball[2], from_ball[2]));
}

/// How steep a field counts as at least: as that of a ball of 0.4 diagonals. Where it is flat, its gradient says nothing.
inline constexpr double k_least_steepness = 10;

/// Distance of a point with that value from {f = 1}, to first order; positive inside.
inline double distance_estimate(const BlobValue& f) { return (f.value - 1) / std::max(glm::length(f.gradient), k_least_steepness); }

} // namespace kelpie
