#include "field/skeletons/hull_faces.h"

#include <algorithm>
#include <array>

namespace kelpie {

namespace {

double cross(const Vec2d& a, const Vec2d& b) { return a.x * b.y - a.y * b.x; }

/// The corners of the convex hull in a plane, counterclockwise (Andrew's monotone chain).
std::vector<Vec2d> convex_corners(std::vector<Vec2d> points) {
  std::sort(points.begin(), points.end(), [](const Vec2d& a, const Vec2d& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  std::vector<Vec2d> hull;
  const auto half = [&](auto first, auto last) {
    const size_t start = hull.size();
    for (; first != last; ++first) {
      while (hull.size() >= start + 2 && cross(hull.back() - hull[hull.size() - 2], *first - hull.back()) <= 0) hull.pop_back();
      hull.push_back(*first);
    }
    hull.pop_back(); // the other half begins with it
  };
  half(points.begin(), points.end());
  half(points.rbegin(), points.rend());
  return hull;
}

class FaceFinder {
public:
  explicit FaceFinder(std::span<const Vec3> points) : farthest_(points[0]) {
    for (const Vec3& p : points)
      if (std::find(points_.begin(), points_.end(), Vec3d(p)) == points_.end()) points_.push_back(Vec3d(p));
    for (const Vec3d& p : points_) farthest_ = glm::distance(p, points_[0]) > glm::distance(farthest_, points_[0]) ? p : farthest_;
    size_ = glm::distance(farthest_, points_[0]);
  }

  /// Every plane through three points that has all others on one side.
  std::vector<HullFace> run() {
    const size_t n = points_.size();
    for (size_t i = 0; i < n; ++i)
      for (size_t j = i + 1; j < n; ++j)
        for (size_t k = j + 1; k < n; ++k) {
          const Vec3d normal = glm::cross(points_[j] - points_[i], points_[k] - points_[i]);
          if (glm::length(normal) <= 1e-12 * size_ * size_) continue; // on a line
          for (const double side : {1.0, -1.0}) add({points_[i], points_[j], points_[k]}, glm::normalize(normal) * side);
        }
    if (faces_.empty()) add_line();
    return std::move(faces_);
  }

private:
  double tolerance() const { return 2e-7 * size_; }

  /// The face through three points, if there is one and it is not yet known.
  void add(const std::array<Vec3d, 3>& through, const Vec3d& normal) {
    const Vec3d& origin = through[0];
    const auto height = [&](const Vec3d& p) { return glm::dot(p - origin, normal); };
    if (std::any_of(points_.begin(), points_.end(), [&](const Vec3d& p) { return height(p) > tolerance(); })) return;
    for (const HullFace& face : faces_) {
      const auto is_in = [&](const Vec3d& p) { return std::abs(glm::dot(p - face.frame.origin, face.frame.e)) <= tolerance(); };
      if (glm::dot(face.frame.e, normal) > 0 && std::all_of(through.begin(), through.end(), is_in)) return;
    }
    HullFace face{AxisFrame{origin, normal}, {}};
    for (const Vec3d& p : points_)
      if (height(p) >= -tolerance()) face.corners.push_back({glm::dot(p - origin, face.frame.u), glm::dot(p - origin, face.frame.v)});
    face.corners = convex_corners(std::move(face.corners));
    faces_.push_back(std::move(face));
  }

  /// Points on a line, seen from either side. Its ends are farthest apart.
  void add_line() {
    Vec3d a = points_[0];
    for (const Vec3d& p : points_) a = glm::distance(p, farthest_) > glm::distance(a, farthest_) ? p : a;
    const Vec3d along = farthest_ - a;
    const Vec3d across = AxisFrame{a, along}.u;
    for (const double side : {1.0, -1.0}) faces_.push_back({AxisFrame{a, across * side, along}, {Vec2d(0), Vec2d(glm::length(along), 0)}});
  }

  std::vector<Vec3d> points_;
  Vec3d farthest_; ///< from the first
  double size_ = 0;
  std::vector<HullFace> faces_;
};

} // namespace

std::vector<HullFace> hull_faces(std::span<const Vec3> points) { return FaceFinder(points).run(); }

} // namespace kelpie
