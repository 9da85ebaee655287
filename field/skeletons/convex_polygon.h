// The Euclidean distance to a convex polygon in a plane. Solids of revolution share it (in half of a plane
// through their axis), and so do triangles and prisms (in their own plane).
#pragma once

#include <array>
#include <span>

#include "field/skeletons/frame.h"

namespace kelpie {

/// From the nearest point of a convex polygon to p; 0 inside. Corners in counterclockwise order; any of them may coincide,
/// or all lie on a line.
Vec2d from_nearest(std::span<const Vec2d> corners, const Vec2d& p);

/// A polygon of few corners, in the same order.
struct ConvexPolygon {
  static constexpr size_t k_most = 6;
  std::array<Vec2d, k_most> corners;
  size_t count = 0;

  void push(const Vec2d& p) { corners[count++] = p; }

  std::span<const Vec2d> all() const { return {corners.data(), count}; }
  /// The part with x >= `least`.
  ConvexPolygon above(double least) const;
};

/// A distance and its derivatives by the two coordinates: the unit vector away from the nearest point.
template <class T>
struct PlaneDistance {
  T distance, by_x, by_y;
};

PlaneDistance<double> plane_distance(const ConvexPolygon&, double x, double y);
/// Over a rectangle; exact but for rounding.
PlaneDistance<Interval> plane_distance(const ConvexPolygon&, Interval x, Interval y);

inline double distance(const ConvexPolygon& p, double x, double y) { return plane_distance(p, x, y).distance; }
inline Interval distance(const ConvexPolygon& p, Interval x, Interval y) { return plane_distance(p, x, y).distance; }
template <class T, int N>
Dual<T, N> distance(const ConvexPolygon& p, const Dual<T, N>& x, const Dual<T, N>& y) {
  const PlaneDistance<T> at = plane_distance(p, x.value, y.value);
  Dual<T, N> r;
  r.value = at.distance;
  for (int i = 0; i < N; ++i) r.d[i] = at.by_x * x.d[i] + at.by_y * y.d[i];
  return r;
}

} // namespace kelpie
