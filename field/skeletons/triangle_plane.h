// A triangle in its own plane.
#pragma once

#include "field/skeletons/convex_polygon.h"

namespace kelpie {

struct TrianglePlane {
  AxisFrame frame; ///< its axis is perpendicular to the triangle
  ConvexPolygon triangle;

  TrianglePlane(const Vec3& a, const Vec3& b, const Vec3& c) : frame(Vec3d(a), normal(a, b, c)) {
    for (const Vec3& corner : {a, b, c}) {
      const Point3<double> q = frame.local(Point3<double>{corner.x, corner.y, corner.z});
      triangle.push({q.x, q.y});
    }
  }

  /// The box around the prism that reaches `half` to either side, grown by `radius`.
  Box3 support(double half, double radius) const {
    Box3d box;
    for (size_t i = 0; i < triangle.count; ++i) {
      const Point3<double> p = frame.global(Point3<double>{triangle.corners[i].x, triangle.corners[i].y, 0});
      box.extend(Vec3d(p.x, p.y, p.z));
    }
    const Vec3d reach = glm::abs(frame.e) * half + radius;
    return rounded_outward({box.lower - reach, box.upper + reach});
  }

private:
  /// Where the corners lie on a line there are many: that nearest to y, or x for a line along y.
  static Vec3d normal(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d n = glm::cross(b - a, c - a);
    if (n != Vec3d(0)) return n;
    Vec3d longest = b - a;
    for (const Vec3d& edge : {c - b, a - c})
      if (glm::dot(edge, edge) > glm::dot(longest, longest)) longest = edge;
    return longest == Vec3d(0) ? Vec3d(0, 1, 0) : AxisFrame{a, longest, Vec3d(0, 1, 0)}.u;
  }
};

} // namespace kelpie
