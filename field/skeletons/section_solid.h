// Solids that a plane section makes: turned about an axis in its plane, or extruded across it.
#pragma once

#include "field/skeletons/convex_polygon.h"

namespace kelpie {

/// Made by turned() or extruded(), then given a section. The section's plane has coordinates x and y: distance from the
/// frame's axis and height where it is turned, u and v where it is extruded.
struct SectionSolid {
  AxisFrame frame;
  bool is_turned;
  double half_height = 0;                    ///< how far it is extruded, either way along the axis
  double x_low = 0, x_high = 0, y_reach = 0; ///< a rectangle: x in [x_low, x_high], |y| <= y_reach
  ConvexPolygon polygon{};                   ///< if it has corners, the section instead of the rectangle
  double growth = 0;                         ///< the solid is all that is nearer than this
  bool is_convex = true;

  /// What a turned section has at x < 0 must be the mirror image of the rest, or be hidden by it.
  static SectionSolid turned(const AxisFrame& frame) { return {frame, true}; }
  static SectionSolid extruded(const AxisFrame& frame, double half_height) { return {frame, false, half_height}; }

  SectionSolid with_rectangle(double low, double high, double reach) const {
    SectionSolid r = *this;
    r.x_low = low, r.x_high = high, r.y_reach = reach;
    r.is_convex = !is_turned || low == -high;
    return r;
  }
  SectionSolid with_polygon(const ConvexPolygon& p, bool makes_convex = true) const {
    SectionSolid r = *this;
    r.polygon = p, r.is_convex = makes_convex;
    return r;
  }
  SectionSolid grown_by(double distance) const {
    SectionSolid r = *this;
    r.growth = distance;
    return r;
  }
};

/// How far x is outside [low, high].
template <class Real>
Real beyond(const Real& x, double low, double high) {
  // At a point, |x - low| without the kink, which nobody sees squared.
  return low == high ? x - Real(low) : max(Real(0.0), max(x - Real(high), Real(low) - x));
}

template <class Real>
Real squared_distance(const SectionSolid& s, const Point3<Real>& p) {
  const Point3<Real> q = s.frame.local(p);
  const Real x = s.is_turned ? norm(q.x, q.y) : q.x, y = s.is_turned ? q.z : q.y;
  if (s.growth > 0) { // turned, by a rectangle: no other kind grows
    const Real d = norm(beyond(x, s.x_low, s.x_high), beyond(y, -s.y_reach, s.y_reach));
    return square(max(Real(0.0), d - Real(s.growth)));
  }
  const Real in_plane = s.polygon.count > 0 ? square(distance(s.polygon, x, y))
                                            : square(beyond(x, s.x_low, s.x_high)) + square(beyond(y, -s.y_reach, s.y_reach));
  return s.is_turned ? in_plane : in_plane + square(beyond(q.z, -s.half_height, s.half_height));
}

/// Part of a circle about the axis of `frame`, `half_angle` to either side of its u.
struct ArcSolid {
  AxisFrame frame;
  double arc_radius, half_angle;
};

template <class Real>
Real squared_distance(const ArcSolid& arc, const Point3<Real>& p) {
  const Point3<Real> q = arc.frame.local(p);
  const Real y = max(q.y, -q.y); // the arc is the same on both sides
  const double r = arc.arc_radius, c = std::cos(arc.half_angle), s = std::sin(arc.half_angle);
  const Real to_circle = square(norm(q.x, q.y) - Real(r)), to_end = square(q.x - Real(r * c)) + square(y - Real(r * s));
  const Interval past_end = arc.half_angle > 0 ? range_of(c * y - s * q.x) : Interval{1}; // the sine of the angle, times a length
  return square(q.z) + (past_end.lo > 0 ? to_end : past_end.hi <= 0 ? to_circle : either(to_end, to_circle));
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

// How far solids move between two states, and any two states interpolated between them (MovingSkeleton in field/kinds.h).

/// The convex hull of two discs across their common axis.
inline double displacement_of_frustum(const Vec3d& from, double from_radius, const Vec3d& to, double to_radius, //
                                      const Vec3d& other_from, double other_from_radius, const Vec3d& other_to, double other_to_radius) {
  const double ends = std::max(glm::distance(from, other_from) + std::abs(from_radius - other_from_radius),
                               glm::distance(to, other_to) + std::abs(to_radius - other_to_radius));
  const double widest = std::max({from_radius, to_radius, other_from_radius, other_to_radius});
  return ends + (widest > 0 ? widest * tilt(to - from, other_to - other_from) : 0);
}

/// A block; half its edges along u, v and the axis of its frame.
inline double displacement_of_block(const Vec3d& centre, const Vec3d& half, const Vec3d& other_centre, const Vec3d& other_half,
                                    const FrameTurn& turn) {
  const Vec3d most = glm::max(half, other_half);
  const double corner = glm::length(most), turned = turn.axis * corner + turn.about * norm(most.x, most.y);
  return glm::distance(centre, other_centre) + glm::distance(half, other_half) + std::min(2 * corner, turned);
}

} // namespace kelpie
