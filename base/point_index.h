// Nearest points, by nanoflann.
#pragma once

#include <span>
#include <vector>

#include <nanoflann.hpp>

#include "base/vec.h"

namespace kelpie {

inline const Vec3d& place_of(const Vec3d& p) { return p; }

/// A k-d tree over points that outlive it: places, or whatever has one by `const Vec3d& place_of(point)`.
template <class Point>
class PointIndex {
public:
  explicit PointIndex(std::span<const Point> points) : cloud_{points}, tree_(3, cloud_) { tree_.buildIndex(); }

  /// The index of the point nearest to `p`; there must be one.
  size_t nearest(const Vec3d& p) const {
    size_t index = 0;
    double squared = 0;
    tree_.knnSearch(&p.x, 1, &index, &squared);
    return index;
  }

  /// Calls `visit(index, distance)` for every point within `radius` of `p`.
  template <class Visit>
  void visit_within(const Vec3d& p, double radius, Visit&& visit) const {
    std::vector<std::pair<size_t, double>> found;
    tree_.radiusSearch(&p.x, radius * radius, found, nanoflann::SearchParams(0, 0, false));
    for (const auto& hit : found) visit(hit.first, std::sqrt(hit.second));
  }

  /// Calls `visit(index, distance)` for the `count` points nearest to `p`, from the nearest on.
  template <class Visit>
  void visit_nearest(const Vec3d& p, size_t count, Visit&& visit) const {
    std::vector<size_t> indices(count);
    std::vector<double> squares(count);
    const size_t found = tree_.knnSearch(&p.x, count, indices.data(), squares.data());
    for (size_t i = 0; i < found; ++i) visit(indices[i], std::sqrt(squares[i]));
  }

private:
  struct Cloud {
    std::span<const Point> points;
    size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(size_t i, size_t axis) const { return place_of(points[i])[int(axis)]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, size_t>;

  Cloud cloud_;
  Tree tree_;
};

} // namespace kelpie
