#include "morph/liquid/flow_path.h"

#include <algorithm>

namespace kelpie {

namespace {

constexpr int k_pieces = 16;

/// The polyline is cut into equal steps and each point drawn towards its neighbours so many times, and all of that again.
constexpr int k_path_rounds = 2, k_smoothings = 4;

std::vector<Vec3d> cut_evenly(const std::vector<Vec3d>& way) {
  std::vector<double> along{0};
  for (size_t k = 1; k < way.size(); ++k) along.push_back(along.back() + glm::length(way[k] - way[k - 1]));
  std::vector<Vec3d> points{way.front()};
  size_t k = 0;
  for (int i = 1; i < k_pieces; ++i) {
    const double wanted = along.back() * i / k_pieces;
    while (k + 2 < way.size() && along[k + 1] < wanted) ++k;
    const double length = along[k + 1] - along[k];
    points.push_back(length > 0 ? glm::mix(way[k], way[k + 1], std::clamp((wanted - along[k]) / length, 0.0, 1.0)) : way[k]);
  }
  points.push_back(way.back());
  return points;
}

void smooth(std::vector<Vec3d>& points) {
  const std::vector<Vec3d> before = points;
  for (size_t k = 1; k + 1 < points.size(); ++k) points[k] = 0.25 * before[k - 1] + 0.5 * before[k] + 0.25 * before[k + 1];
}

} // namespace

Spline<Vec3d> flow_path(const std::vector<Vec3d>& way) {
  if (way.size() == 2) return Spline<Vec3d>::catmull_rom(way);
  std::vector<Vec3d> points = way;
  for (int round = 0; round < k_path_rounds; ++round) {
    points = cut_evenly(points);
    for (int i = 0; i < k_smoothings; ++i) smooth(points);
  }
  return Spline<Vec3d>::catmull_rom(cut_evenly(points));
}

} // namespace kelpie
