// The solid behind segments and cone-spheres.
#pragma once

#include "field/skeletons/frame.h"

namespace kelpie {

/// The signed distance to a cone-sphere, in its plane of symmetry: y >= 0 from the axis, z along it from the
/// first centre. With the balls of the family at s in [0, length], of radius r(s) = first - sine * s, it is
///   min over s of |(y, z - s)| - r(s),   reached at s = clamp(z - y * sine / cosine, 0, length).
/// Convex, and rising with y; so its range over a rectangle is known from its corners.
struct ConeSphereProfile {
  double length, first, sine, slope; ///< slope: sine / cosine of the cone's half angle

  /// One ball that contains the other is all there is: length 0.
  ConeSphereProfile(double length_, double first_radius, double second_radius) : length(length_), first(first_radius), sine(0), slope(0) {
    if (length <= std::abs(first_radius - second_radius)) {
      lift = first_radius >= second_radius ? 0 : length;
      first = std::max(first_radius, second_radius), length = 0;
    } else {
      sine = (first_radius - second_radius) / length;
      slope = sine / std::sqrt((1 - sine) * (1 + sine));
    }
  }

  double nearest(double y, double z) const { return std::min(std::max(z - y * slope, 0.0), length); }
  double distance(double y, double z) const {
    z -= lift;
    const double s = nearest(y, z);
    return norm(y, z - s) - (first - sine * s);
  }
  /// The derivative by z: that by y is sqrt(1 - its square).
  double rise(double y, double z) const {
    z -= lift;
    const double s = nearest(y, z);
    return s > 0 && s < length ? sine : cosine(z - s, y);
  }
  /// Where along the axis the distance is least, for every y.
  double lowest() const { return lift + (sine >= 0 ? 0 : length); }

  double lift = 0; ///< where along the axis the first ball of the family is
};

inline double distance(const ConeSphereProfile& c, double y, double z) { return c.distance(y, z); }
inline Interval distance(const ConeSphereProfile& c, Interval y, Interval z) {
  return {c.distance(y.lo, std::min(std::max(c.lowest(), z.lo), z.hi)), std::max(c.distance(y.hi, z.lo), c.distance(y.hi, z.hi))};
}
inline double rise(const ConeSphereProfile& c, double y, double z) { return c.rise(y, z); }
/// By convexity the derivative rises with z; for each z it is monotone in y. At the centre of a ball it jumps.
inline Interval rise(const ConeSphereProfile& c, Interval y, Interval z) {
  if (y.lo <= 0 && z.lo <= c.lift + c.length && z.hi >= c.lift) return {-1, 1};
  return {std::min(c.rise(y.lo, z.lo), c.rise(y.hi, z.lo)), std::max(c.rise(y.lo, z.hi), c.rise(y.hi, z.hi))};
}
template <class T, int N>
Dual<T, N> distance(const ConeSphereProfile& c, const Dual<T, N>& y, const Dual<T, N>& z) {
  Dual<T, N> r;
  r.value = distance(c, y.value, z.value);
  const T by_z = rise(c, y.value, z.value), by_y = sqrt(max(T(0.0), T(1.0) - square(by_z)));
  for (int i = 0; i < N; ++i) r.d[i] = by_y * y.d[i] + by_z * z.d[i];
  return r;
}

/// Two balls and the cone that touches both: what the engine solves fastest. Points and segments are the thinnest.
struct ConeSphereSolid {
  Vec3d from, to;
  double from_radius, to_radius;
};

/// Of a segment without the profile, which would see each coordinate more than once: distances along and across the
/// axis, the part along it clamped once, keep intervals narrow.
template <class Real>
Real squared_distance_to_segment(const Vec3d& from, const Vec3d& to, const Point3<Real>& p) {
  const Vec3d axis = to - from;
  const double length = glm::length(axis), inverse = length > 0 ? 1 / length : 0;
  const Vec3d e = axis * inverse;
  const Real x = p.x - Real(from.x), y = p.y - Real(from.y), z = p.z - Real(from.z);
  if (length == 0) return square(x) + square(y) + square(z);
  const Real along = x * e.x + y * e.y + z * e.z;
  const Real across = square(y * e.z - z * e.y) + square(z * e.x - x * e.z) + square(x * e.y - y * e.x);
  return across + square(along - clamp(along, 0, length));
}

template <class Real>
Real squared_distance(const ConeSphereSolid& solid, const Point3<Real>& p) {
  if (solid.from_radius == 0 && solid.to_radius == 0) return squared_distance_to_segment(solid.from, solid.to, p);
  const Vec3d axis = solid.to - solid.from;
  const Point3<Real> q = AxisFrame{solid.from, axis}.local(p);
  const ConeSphereProfile profile{glm::length(axis), solid.from_radius, solid.to_radius};
  return square(max(Real(0.0), distance(profile, norm(q.x, q.y), q.z)));
}

} // namespace kelpie
