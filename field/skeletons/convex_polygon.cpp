#include "field/skeletons/convex_polygon.h"

#include <limits>

namespace kelpie {

Vec2d from_nearest(std::span<const Vec2d> corners, const Vec2d& p) {
  Vec2d nearest(0);
  double least = std::numeric_limits<double>::infinity();
  bool is_inside = true, faces_edge = false;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec2d a = corners[i], e = corners[i + 1 < corners.size() ? i + 1 : 0] - a, q = p - a;
    const double squared = glm::dot(e, e), s = squared > 0 ? glm::dot(q, e) / squared : 0;
    const Vec2d r = q - e * std::min(std::max(s, 0.0), 1.0);
    is_inside &= e.x * q.y - e.y * q.x >= 0;
    if (glm::dot(r, r) < least) least = glm::dot(r, r), nearest = r, faces_edge = s > 0 && s < 1;
  }
  // The border point nearest to one inside is never a corner; on the line of a flat polygon, past its end, it is.
  return is_inside && faces_edge ? Vec2d(0) : nearest;
}

ConvexPolygon ConvexPolygon::above(double least) const {
  ConvexPolygon out;
  for (size_t i = 0; i < count; ++i) {
    const Vec2d a = corners[i], b = corners[i + 1 < count ? i + 1 : 0];
    if (a.x >= least) out.push(a);
    if ((a.x < least) != (b.x < least)) out.push({least, a.y + (b.y - a.y) * (least - a.x) / (b.x - a.x)});
  }
  return out;
}

PlaneDistance<double> plane_distance(const ConvexPolygon& polygon, double x, double y) {
  const Vec2d r = from_nearest(polygon.all(), {x, y});
  return {norm(r.x, r.y), cosine(r.x, r.y), cosine(r.y, r.x)};
}

// The distance is convex: it is largest at a corner of the rectangle;
// where the two are apart, it is least at a corner of either. Then the directions at the rectangle's corners
// span all: along any line the direction turns one way only.
PlaneDistance<Interval> plane_distance(const ConvexPolygon& polygon, Interval x, Interval y) {
  const std::array<Vec2d, 4> rectangle{Vec2d(x.lo, y.lo), Vec2d(x.hi, y.lo), Vec2d(x.hi, y.hi), Vec2d(x.lo, y.hi)};
  PlaneDistance<Interval> r{{std::numeric_limits<double>::infinity(), 0}, {1, -1}, {1, -1}};
  for (const Vec2d& corner : rectangle) {
    const PlaneDistance<double> at = plane_distance(polygon, corner.x, corner.y);
    r.distance = {std::min(r.distance.lo, at.distance), std::max(r.distance.hi, at.distance)};
    r.by_x = {std::min(r.by_x.lo, at.by_x), std::max(r.by_x.hi, at.by_x)};
    r.by_y = {std::min(r.by_y.lo, at.by_y), std::max(r.by_y.hi, at.by_y)};
  }
  bool are_apart = false; // by a line along an edge of either
  Interval px{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}, py = px;
  for (size_t i = 0; i < polygon.count; ++i) {
    const Vec2d a = polygon.corners[i], e = polygon.corners[i + 1 < polygon.count ? i + 1 : 0] - a;
    px = hull(px, a.x), py = hull(py, a.y);
    const double inward = std::max(-e.y * (x.lo - a.x), -e.y * (x.hi - a.x)) + std::max(e.x * (y.lo - a.y), e.x * (y.hi - a.y));
    are_apart |= inward < 0;
    r.distance.lo =
        std::min(r.distance.lo, norm(std::max(std::max(x.lo - a.x, a.x - x.hi), 0.0), std::max(std::max(y.lo - a.y, a.y - y.hi), 0.0)));
  }
  are_apart |= x.lo > px.hi || x.hi < px.lo || y.lo > py.hi || y.hi < py.lo;
  if (!are_apart || r.distance.lo <= 0) return {{0, r.distance.hi}, {-1, 1}, {-1, 1}};
  const Interval by_x = r.by_x, by_y = r.by_y;
  if (by_y.contains(0)) r.by_x = {by_x.lo < 0 ? -1 : by_x.lo, by_x.hi > 0 ? 1 : by_x.hi};
  if (by_x.contains(0)) r.by_y = {by_y.lo < 0 ? -1 : by_y.lo, by_y.hi > 0 ? 1 : by_y.hi};
  return r;
}

} // namespace kelpie
