// What skeletons with an axis share: coordinates along and across it, and lengths that every number type
// can differentiate.
#pragma once

#include <cmath>

#include "base/box.h"
#include "base/dual.h"
#include "base/vec.h"

namespace kelpie {

/// Orthonormal coordinates about a place: two across and one along an axis. Each is a linear form of the
/// point in which every coordinate stands once, so its range over a box is exact.
struct AxisFrame {
  Vec3d origin, u, v, e;

  /// `axis` need not be a unit vector; the zero vector (an animated axis on its way) stands for y.
  AxisFrame(const Vec3d& origin_, const Vec3d& axis) : origin(origin_) {
    const double length = glm::length(axis);
    e = length > 0 ? axis / length : Vec3d(0, 1, 0);
    // Two perpendicular vectors without a branch that an animation could see: the sign only keeps 1 + |e.z| off 0.
    const double sign = std::copysign(1.0, e.z), a = -1 / (sign + e.z), b = e.x * e.y * a;
    u = {1 + sign * e.x * e.x * a, sign * b, -sign * e.x};
    v = {b, sign + e.y * e.y * a, -e.y};
  }
  /// With u along what of `across` is perpendicular to the axis; any u where nothing is.
  AxisFrame(const Vec3d& origin_, const Vec3d& axis, const Vec3d& across) : AxisFrame(origin_, axis) {
    const Vec3d rest = across - e * glm::dot(across, e);
    const double squared = glm::dot(rest, rest);
    if (squared > 1e-12 * glm::dot(across, across)) u = rest / std::sqrt(squared), v = glm::cross(e, u);
  }

  template <class Real>
  static Real along(const Vec3d& direction, const Point3<Real>& p) {
    return direction.x * p.x + direction.y * p.y + direction.z * p.z;
  }
  template <class Real>
  Point3<Real> relative(const Point3<Real>& p) const {
    return {p.x - Real(origin.x), p.y - Real(origin.y), p.z - Real(origin.z)};
  }
  /// (u, v, e) coordinates of p.
  template <class Real>
  Point3<Real> local(const Point3<Real>& p) const {
    const Point3<Real> q = relative(p);
    return {along(u, q), along(v, q), along(e, q)};
  }
  /// The point of which q is `local`.
  template <class Real>
  Point3<Real> global(const Point3<Real>& q) const {
    return {u.x * q.x + v.x * q.y + e.x * q.z + Real(origin.x), u.y * q.x + v.y * q.y + e.y * q.z + Real(origin.y),
            u.z * q.x + v.z * q.y + e.z * q.z + Real(origin.z)};
  }
};

/// How far a unit circle about an axis moves when the axis turns from a to b, or to any vector between them.
inline double tilt(const Vec3d& a, const Vec3d& b) {
  const Vec3d e = AxisFrame{Vec3d(0), a}.e, f = AxisFrame{Vec3d(0), b}.e;
  // Turned by more than a right angle it comes back to itself.
  return glm::dot(e, f) >= 0 ? glm::distance(e, f) : std::sqrt(2.0);
}

/// How far a frame with axis and across turns on its way from one state to another, or between any two states whose vectors are
/// interpolated between theirs, in radii: a point at a distance r from its origin moves by at most r * axis, and by as much as its
/// distance from the axis * about more. No point moves by more than 2 r.
struct FrameTurn {
  double axis, about;
};
inline FrameTurn turn_of(const Vec3d& axis, const Vec3d& across, const Vec3d& other_axis, const Vec3d& other_across) {
  constexpr FrameTurn k_any{2, 0};
  if (axis == other_axis && across == other_across) return {0, 0};
  const auto angle = [](const Vec3d& a, const Vec3d& b) { // between unit vectors; none is interpolated to 0 below a right angle
    return glm::dot(a, b) > 0 ? 2 * std::asin(std::min(1.0, 0.5 * glm::distance(a, b))) : INFINITY;
  };
  const double squared = glm::dot(across, across), other_squared = glm::dot(other_across, other_across);
  if (!(squared > 0 && other_squared > 0)) return k_any;
  const Vec3d e = AxisFrame{Vec3d(0), axis}.e, f = AxisFrame{Vec3d(0), other_axis}.e;
  const Vec3d w = across / std::sqrt(squared), x = other_across / std::sqrt(other_squared);
  const double tilted = angle(e, f), swung = angle(w, x), along = std::abs(glm::dot(e, w));
  // What of `across` is perpendicular to the axis is never shorter than this, and changes its direction about the axis by what
  // either vector turns, over its length.
  const double least = std::sqrt(std::max(0.0, 1 - along * along)) - tilted - swung;
  if (!(least > 0.01)) return k_any;
  return {std::min(2.0, tilted), std::min(2.0, (swung + tilted * std::min(1.0, along + tilted + swung)) / least)};
}

/// In float, with nothing of the box lost to rounding.
inline Box3 rounded_outward(const Box3d& b) {
  const Vec3d size = glm::max(glm::abs(b.lower), glm::abs(b.upper));
  return {Vec3(b.lower - 3e-7 * size), Vec3(b.upper + 3e-7 * size)};
}

// The length of the vector (a, b). Its derivative by a is a / length, the cosine of an angle, which stays
// within [-1, 1] where the chain rule through sqrt would leave nothing.

inline double norm(double a, double b) { return std::sqrt(a * a + b * b); }
inline Interval norm(Interval a, Interval b) { return sqrt(square(a) + square(b)); }

/// a / |(a, b)|; 0 at the origin, where there is none.
inline double cosine(double a, double b) {
  const double length = norm(a, b);
  return length > 0 ? a / length : 0;
}
/// Exact: the cosine rises with a, and tends to 0 as |b| grows.
inline Interval cosine(Interval a, Interval b) {
  const double near = b.lo <= 0 && b.hi >= 0 ? 0 : std::min(std::abs(b.lo), std::abs(b.hi)), far = b.magnitude();
  if (near == 0 && a.lo <= 0 && a.hi >= 0) return {a.lo < 0 || far == 0 ? -1.0 : 0.0, a.hi > 0 || far == 0 ? 1.0 : 0.0};
  return {cosine(a.lo, a.lo < 0 ? near : far), cosine(a.hi, a.hi > 0 ? near : far)};
}

template <class T, int N>
Dual<T, N> norm(const Dual<T, N>& a, const Dual<T, N>& b) {
  Dual<T, N> r;
  r.value = norm(a.value, b.value);
  const T by_a = cosine(a.value, b.value), by_b = cosine(b.value, a.value);
  for (int i = 0; i < N; ++i) r.d[i] = by_a * a.d[i] + by_b * b.d[i];
  return r;
}

} // namespace kelpie
