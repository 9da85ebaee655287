// Solids of revolution: the nearest point lies in the half plane through the axis.
#pragma once

#include "field/skeletons/convex_polygon.h"

namespace kelpie {

/// The distance to the solid that `profile` makes when it is turned about the axis of `frame`; x of the profile is the distance
/// from the axis, y the height. What it has at x < 0 must be the mirror image of the rest, or be hidden by it.
template <class Real>
Real distance_to_revolved(const AxisFrame& frame, const ConvexPolygon& profile, const Point3<Real>& p) {
  const Point3<Real> q = frame.local(p);
  return distance(profile, norm(q.x, q.y), q.z);
}

/// A cone with flat ends at heights 0 and `length`; both halves of its section, so that the axis is no border.
inline ConvexPolygon frustum_profile(double length, double from_radius, double to_radius) {
  ConvexPolygon profile;
  profile.push({-from_radius, 0}), profile.push({from_radius, 0}), profile.push({to_radius, length}), profile.push({-to_radius, length});
  return profile;
}

/// The box around two discs across their common axis (where they coincide, `normal`), grown by `radius`.
inline Box3 frustum_support(const Vec3& from, double from_radius, const Vec3& to, double to_radius, double radius,
                            const Vec3& normal = Vec3(0, 1, 0)) {
  const Vec3d a(from), b(to);
  const AxisFrame frame{a, a == b ? Vec3d(normal) : b - a};
  const Vec3d across = glm::sqrt(glm::max(Vec3d(0), 1.0 - frame.e * frame.e));
  const Vec3d a_reach = across * from_radius + radius, b_reach = across * to_radius + radius;
  Box3d box{a - a_reach, a + a_reach};
  box.extend(Box3d{b - b_reach, b + b_reach});
  return rounded_outward(box);
}

} // namespace kelpie
