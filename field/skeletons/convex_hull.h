// The Euclidean distance to the convex hull of points: Gilbert, Johnson and Keerthi 1988, "A fast procedure
// for computing the distance between complex objects in three-dimensional space". No faces are needed, so points may
// move, coincide, or lie in a plane or on a line.
#pragma once

#include <array>
#include <span>

#include "field/skeletons/frame.h"

namespace kelpie {

/// The squared distance, and half its derivatives by the coordinates: what leads to p from the nearest point.
template <class T>
struct SquaredHullDistance {
  T squared;
  std::array<T, 3> half_slopes;
};

/// Of at least one point.
SquaredHullDistance<double> squared_hull_distance(std::span<const Vec3> points, const Point3<double>& p);
/// Over a box: the least distance is exact, the rest as narrow as half the box's diagonal allows.
SquaredHullDistance<Interval> squared_hull_distance(std::span<const Vec3> points, const Point3<Interval>& p);

template <class Real>
Real squared_distance_to_hull(std::span<const Vec3> points, const Point3<Real>& p) {
  return squared_hull_distance(points, p).squared;
}
template <class T, int N>
Dual<T, N> squared_distance_to_hull(std::span<const Vec3> points, const Point3<Dual<T, N>>& p) {
  const SquaredHullDistance<T> at = squared_hull_distance(points, Point3<T>{p.x.value, p.y.value, p.z.value});
  Dual<T, N> r;
  r.value = at.squared;
  for (int i = 0; i < N; ++i) r.d[i] = (at.half_slopes[0] * p.x.d[i] + at.half_slopes[1] * p.y.d[i] + at.half_slopes[2] * p.z.d[i]) * 2.0;
  return r;
}

/// The hull of points.
template <class Points>
struct HullSolid {
  Points points;
};

template <class Points, class Real>
Real squared_distance(const HullSolid<Points>& solid, const Point3<Real>& p) {
  return squared_distance_to_hull(solid.points, p);
}

/// The box around points, grown by `radius`.
Box3 support_of_hull(std::span<const Vec3> points, double radius);

} // namespace kelpie
