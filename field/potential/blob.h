// A blob: the point skeleton in the form in which clouds hold it by the hundred thousand.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "base/affine.h"
#include "base/box.h"
#include "base/symmetric.h"
#include "field/potential/falloff.h"

namespace kelpie {

/// The potential weight * falloff(|shape (p - centre)|^2 / radius^2): a ball of influence, or an ellipsoid.
struct Blob {
  Vec3 centre{0};
  float radius = 1; ///< of influence, in scene units; of an ellipsoid that of the ball of equal volume
  float weight = 1;
  Falloff falloff = Falloff::quartic;
  SymmetricMat3 shape{}; ///< positive definite, of determinant 1; the identity: a ball
};

using BlobCloud = std::vector<Blob>;

inline bool is_round(const Blob& b) { return b.shape.is_identity(); }

/// Takes p - centre into the unit ball where p is in the ellipsoid: shape / radius.
SymmetricMat3 to_unit_ball(const Blob&);

/// The longest and the shortest of an ellipsoid's half axes.
struct HalfAxes {
  float longest, shortest;
};
HalfAxes half_axes(const Blob&);

/// |shape d|^2 / radius^2 of what is d away from the centre: 1 where the influence ends.
inline double squared_place(const Blob& b, const Vec3d& d) {
  const Vec3d in_ball = is_round(b) ? d : b.shape(d);
  return glm::dot(in_ball, in_ball) / (double(b.radius) * b.radius);
}
/// How far the influence reaches in a direction, which need not be a unit vector.
inline double reach_towards(const Blob& b, const Vec3d& d) {
  const double place2 = squared_place(b, d);
  return place2 > 0 ? glm::length(d) / std::sqrt(place2) : double(b.radius);
}

/// The box outside which the blob is 0.
Box3 support(const Blob&);

/// Makes the blob the ellipsoid of the points with |m (p - centre)| <= 1; false, and it stays as it is, if `m` has no inverse, or one
/// half axis is more than `k_longest_blob` times as long as another.
bool set_ellipsoid(Blob&, const Mat3d& m);
inline constexpr double k_longest_blob = 1e3;

/// The shape that is this part of the way from one to another, 0 to 1.
SymmetricMat3 between(const SymmetricMat3& a, const SymmetricMat3& b, float part);

/// The blob as seen through a map; nothing where set_ellipsoid() fails.
std::optional<Blob> mapped(Blob, const Affine&);

} // namespace kelpie
