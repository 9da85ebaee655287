// Points in the cells of a grid: which of them an ellipsoid holds.
#pragma once

#include <cmath>
#include <vector>

#include <algorithm>

#include "base/box.h"
#include "morph/liquid/ellipsoid.h"

namespace kelpie {

class ProbeGrid {
public:
  /// The points outlive it.
  explicit ProbeGrid(const std::vector<Vec3d>& points) : points_(points) {
    for (const Vec3d& p : points) box_.extend(p);
    const Vec3d extent = box_.extent() + 1e-6;
    cell_ = std::cbrt(extent.x * extent.y * extent.z * k_points_per_cell / static_cast<double>(points.size() + 1));
    cell_ = std::max(cell_, std::max({extent.x, extent.y, extent.z}) / k_most_cells);
    for (int k = 0; k < 3; ++k) count_[k] = 1 + static_cast<int>(extent[k] / cell_);
    first_.assign(static_cast<size_t>(count_[0]) * count_[1] * count_[2] + 1, 0);
    for (const Vec3d& p : points) ++first_[cell_of(p) + 1];
    for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
    order_.resize(points.size());
    for (uint32_t i = 0; i < points.size(); ++i) order_[next[cell_of(points[i])]++] = i;
  }

  /// Calls visit(index, u) for each point in the ellipsoid, u being where in the unit ball it is.
  template <class Visit>
  void visit_in(const Ellipsoid& b, Visit&& visit) const {
    const Mat3d from_ball = glm::inverse(b.to_ball);
    int low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      const double half = half_extent(from_ball, k);
      low[k] = index_along(b.centre[k] - half, k), high[k] = index_along(b.centre[k] + half, k);
    }
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y) {
        const size_t row = (static_cast<size_t>(z) * count_[1] + y) * count_[0];
        for (uint32_t k = first_[row + low[0]]; k < first_[row + high[0] + 1]; ++k) {
          const Vec3d u = b.to_ball * (points_[order_[k]] - b.centre);
          if (glm::dot(u, u) < 1) visit(order_[k], u);
        }
      }
  }

private:
  static constexpr double k_points_per_cell = 0.5, k_most_cells = 100;

  int index_along(double x, int axis) const {
    return static_cast<int>(std::clamp((x - box_.lower[axis]) / cell_, 0.0, count_[axis] - 1.0));
  }
  size_t cell_of(const Vec3d& p) const {
    return (static_cast<size_t>(index_along(p.z, 2)) * count_[1] + index_along(p.y, 1)) * count_[0] + index_along(p.x, 0);
  }

  const std::vector<Vec3d>& points_;
  Box3d box_;
  double cell_;
  int count_[3];
  std::vector<uint32_t> first_, order_;
};

} // namespace kelpie
