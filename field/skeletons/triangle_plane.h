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

  /// How far the plane's unit normal, or its opposite, turns between two states of the corners, and any two states interpolated between
  /// them. The normal is a quadratic polynomial of the time, so within what its Bernstein coefficients span.
  static double turn(const std::array<Vec3d, 3>& p, const std::array<Vec3d, 3>& q) {
    const Vec3d b = p[1] - p[0], c = p[2] - p[0], other_b = q[1] - q[0], other_c = q[2] - q[0];
    if (p == q) return 0;
    std::array<Vec3d, 3> normals{glm::cross(b, c), glm::cross(b, other_c) + glm::cross(other_b, c), glm::cross(other_b, other_c)};
    double most = 0;
    for (Vec3d& n : normals)
      if (const double length = glm::length(n); length > 0)
        n /= length;
      else
        return std::sqrt(2.0); // perhaps it jumps
    for (size_t i = 0; i < 3; ++i) {
      const Vec3d &m = normals[i], &n = normals[(i + 1) % 3];
      most = std::max(most, glm::dot(m, n) > 0 ? glm::distance(m, n) : std::sqrt(2.0));
    }
    return most;
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
