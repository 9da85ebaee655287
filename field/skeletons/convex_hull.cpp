#include "field/skeletons/convex_hull.h"

#include <algorithm>
#include <limits>

namespace kelpie {

namespace {

/// Up to four points, of whose hull the place nearest to the origin is sought.
struct HullSimplex {
  std::array<Vec3d, 4> points;
  size_t count = 0;

  bool has(const Vec3d& p) const { return std::find(points.begin(), points.begin() + count, p) != points.begin() + count; }

  /// Of the corners, edges and faces on which the origin projects, and the inside, the nearest. Drops the points it does not need.
  Vec3d reduce() {
    Best best{points[0], glm::dot(points[0], points[0]), {points[0]}, 1};
    for (size_t i = 1; i < count; ++i) best.offer(points[i], {points[i]}, 1);
    for (size_t i = 0; i < count; ++i)
      for (size_t j = i + 1; j < count; ++j) {
        offer_edge(points[i], points[j], best);
        for (size_t k = j + 1; k < count; ++k) offer_face(points[i], points[j], points[k], best);
      }
    if (count == 4 && is_around_origin()) return Vec3d(0);
    points = best.of, count = best.count;
    return best.nearest;
  }

private:
  struct Best {
    Vec3d nearest;
    double squared;
    std::array<Vec3d, 4> of;
    size_t count;

    void offer(const Vec3d& p, const std::array<Vec3d, 4>& corners, size_t n) {
      if (glm::dot(p, p) < squared) nearest = p, squared = glm::dot(p, p), of = corners, count = n;
    }
  };
  static void offer_edge(const Vec3d& a, const Vec3d& b, Best& best) {
    const Vec3d e = b - a;
    const double s = -glm::dot(a, e), squared = glm::dot(e, e);
    if (s > 0 && s < squared) best.offer(a + e * (s / squared), {a, b}, 2);
  }
  static void offer_face(const Vec3d& a, const Vec3d& b, const Vec3d& c, Best& best) {
    const Vec3d n = glm::cross(b - a, c - a);
    const double squared = glm::dot(n, n);
    if (squared <= 1e-24 * glm::dot(b - a, b - a) * glm::dot(c - a, c - a)) return; // its edges are all of it
    const bool is_over = glm::dot(n, glm::cross(b, c)) > 0 && glm::dot(n, glm::cross(c, a)) > 0 && glm::dot(n, glm::cross(a, b)) > 0;
    if (is_over) best.offer(n * (glm::dot(a, n) / squared), {a, b, c}, 3);
  }
  /// For each face: the origin is on the side of the fourth corner. Four points in a plane are around nothing.
  bool is_around_origin() const {
    for (size_t i = 0; i < 4; ++i) {
      const Vec3d &a = points[i], &b = points[(i + 1) % 4], &c = points[(i + 2) % 4], &d = points[(i + 3) % 4];
      const Vec3d n = glm::cross(b - a, c - a);
      const double height = glm::dot(d - a, n), at_origin = -glm::dot(a, n);
      if (height * height <= 1e-24 * glm::dot(n, n) * glm::dot(d - a, d - a) || (height > 0 ? at_origin < 0 : at_origin > 0)) return false;
    }
    return true;
  }
};

struct HullDistance {
  Vec3d from_nearest{0}; ///< from the nearest point of the hull to the nearest of the box; 0 where they meet
  double least = 0;      ///< a lower bound of its length
};

/// Between the hull of points (at least one) and the box that reaches `half` to all sides of p.
HullDistance distance_to_hull(std::span<const Vec3> points, const Vec3d& p, const Vec3d& half = Vec3d(0)) {
  HullSimplex simplex;
  for (; simplex.count < std::min<size_t>(4, points.size()); ++simplex.count)
    simplex.points[simplex.count] = p - Vec3d(points[simplex.count]);
  HullDistance r{simplex.reduce(), 0};
  // Each round adds the corner of the difference that lies farthest towards the origin, and so comes nearer, or there is none.
  for (int round = 0; round < 200; ++round) {
    const Vec3d v = r.from_nearest;
    const double squared = glm::dot(v, v);
    if (squared <= 0) break;
    Vec3d corner(0);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& point : points) {
      const Vec3d q = p - Vec3d(point);
      if (glm::dot(q, v) < nearest) nearest = glm::dot(q, v), corner = q;
    }
    corner -= glm::sign(v) * half;
    nearest -= glm::dot(glm::abs(v), half);
    r.least = std::max(r.least, nearest / std::sqrt(squared));
    if (squared - nearest <= 1e-15 * squared || simplex.has(corner)) break;
    simplex.points[simplex.count++] = corner;
    const Vec3d next = simplex.reduce();
    if (glm::dot(next, next) >= squared) break; // rounding is all that is left
    r.from_nearest = next;
  }
  return r;
}

} // namespace

SquaredHullDistance<double> squared_hull_distance(std::span<const Vec3> points, const Point3<double>& p) {
  const Vec3d v = distance_to_hull(points, {p.x, p.y, p.z}).from_nearest;
  return {glm::dot(v, v), {v.x, v.y, v.z}};
}
// The least distance is exact. The rest follows from the middle: neither the distance nor what leads to p from the nearest
// point changes faster than p.
SquaredHullDistance<Interval> squared_hull_distance(std::span<const Vec3> points, const Point3<Interval>& p) {
  const Vec3d half = 0.5 * Vec3d(p.x.width(), p.y.width(), p.z.width());
  const Vec3d middle(p.x.middle(), p.y.middle(), p.z.middle()), v = distance_to_hull(points, middle).from_nearest;
  const double reach = glm::length(half) * (1 + 1e-12) + 1e-12 * glm::length(v), most = glm::length(v) + reach;
  const double least = distance_to_hull(points, middle, half).least * (1 - 1e-12);
  SquaredHullDistance<Interval> r{{square(std::min(least, most)), square(most)}, {}};
  for (int i = 0; i < 3; ++i) r.half_slopes[i] = {v[i] - reach, v[i] + reach};
  return r;
}

Box3 support_of_hull(std::span<const Vec3> points, double radius) {
  Box3d box;
  for (const Vec3& p : points) box.extend(Vec3d(p));
  return rounded_outward(box.padded(radius));
}

} // namespace kelpie
