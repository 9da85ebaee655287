#include "morph/feature/part_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include <Eigen/Eigenvalues>

#include "base/parallel.h"

namespace kelpie {

namespace {

constexpr int k_voxels_along = 72;
constexpr size_t k_most_parts = 20;
/// A division must free this part of the solid's own box.
constexpr double k_least_gain = 0.015;
/// Pieces of less than this part of the voxels are dropped: splinters.
constexpr double k_least_part = 0.004;
/// Pieces are joined if their common box has at most this many times their boxes' volume.
constexpr double k_joined_volume = 1.2;
/// A turned box must be smaller than the upright one by this.
constexpr double k_turned_volume = 0.8;

using Voxel = std::array<int, 3>;
using Voxels = std::vector<Voxel>;

struct Range {
  Voxel lower, upper;
  explicit Range(const Voxels& voxels) : lower(voxels[0]), upper(voxels[0]) {
    for (const Voxel& v : voxels)
      for (size_t i = 0; i < 3; ++i) lower[i] = std::min(lower[i], v[i]), upper[i] = std::max(upper[i], v[i]);
  }
  int side(size_t axis) const { return upper[axis] - lower[axis] + 1; }
  double volume() const { return double(side(0)) * side(1) * side(2); }
};

/// What hangs together, corners too.
std::vector<Voxels> components(const Voxels& all) {
  if (all.empty()) return {};
  const Range range(all);
  const auto place = [&](const Voxel& v) {
    size_t at = 0;
    for (size_t i = 3; i-- > 0;) at = at * size_t(range.side(i) + 2) + size_t(v[i] - range.lower[i] + 1);
    return at;
  };
  std::vector<char> waiting(size_t(range.side(0) + 2) * size_t(range.side(1) + 2) * size_t(range.side(2) + 2), 0);
  for (const Voxel& v : all) waiting[place(v)] = 1;
  std::vector<Voxels> out;
  Voxels stack;
  for (const Voxel& seed : all) {
    if (!waiting[place(seed)]) continue;
    Voxels& part = out.emplace_back();
    waiting[place(seed)] = 0;
    stack.push_back(seed);
    while (!stack.empty()) {
      const Voxel v = stack.back();
      stack.pop_back();
      part.push_back(v);
      for (int side = 0; side < 27; ++side) {
        const Voxel next{v[0] + side % 3 - 1, v[1] + side / 3 % 3 - 1, v[2] + side / 9 - 1};
        if (char& is_waiting = waiting[place(next)]) is_waiting = 0, stack.push_back(next);
      }
    }
  }
  return out;
}

struct Division {
  std::vector<Voxels> pieces;
  double volume = 0; ///< of the boxes around them
};

Division divided(const Voxels& part, size_t axis, int last) {
  Voxels below, above;
  for (const Voxel& v : part) (v[axis] <= last ? below : above).push_back(v);
  Division out;
  for (const Voxels& half : {below, above})
    for (Voxels& piece : components(half)) out.volume += Range(piece).volume(), out.pieces.push_back(std::move(piece));
  return out;
}

/// By the plane that leaves the least volume.
Division best_division(const Voxels& part) {
  const Range range(part);
  std::vector<std::pair<size_t, int>> planes;
  for (size_t axis = 0; axis < 3; ++axis)
    for (int last = range.lower[axis]; last < range.upper[axis]; ++last) planes.emplace_back(axis, last);
  std::vector<double> volumes(planes.size());
  parallel_for(size_t(0), planes.size(), [&](size_t i) { volumes[i] = divided(part, planes[i].first, planes[i].second).volume; });
  if (planes.empty()) return {{part}, range.volume()};
  const auto [axis, last] = planes[size_t(std::min_element(volumes.begin(), volumes.end()) - volumes.begin())];
  return divided(part, axis, last);
}

struct Part {
  Voxels voxels;
  std::optional<Division> division; ///< the best, once it is known
  double gain() const { return Range(voxels).volume() - division->volume; }
};

void add_pieces(std::vector<Voxels> pieces, size_t least, std::vector<Part>& parts) {
  for (Voxels& piece : pieces)
    if (piece.size() >= least) parts.push_back({std::move(piece), {}});
}

std::vector<Voxels> divide(const Voxels& solid) {
  const double least_gain = k_least_gain * Range(solid).volume();
  const auto least = size_t(k_least_part * double(solid.size())) + 1;
  std::vector<Part> parts;
  add_pieces(components(solid), least, parts);
  while (parts.size() < k_most_parts) {
    for (Part& part : parts)
      if (!part.division) part.division = best_division(part.voxels);
    const auto best = std::max_element(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.gain() < b.gain(); });
    if (best == parts.end() || best->gain() < least_gain) break;
    Division division = std::move(*best->division);
    parts.erase(best);
    add_pieces(std::move(division.pieces), least, parts);
  }
  std::vector<Voxels> out;
  for (Part& part : parts) out.push_back(std::move(part.voxels));
  return out;
}

// --- boxes ---

double volume(const PartBox& box) { return box.size.x * box.size.y * box.size.z; }

/// With given axes, around the voxels' centres and half a voxel more.
PartBox box_along(const Mat3d& axes, const Voxels& voxels) {
  Box3d range;
  for (const Voxel& v : voxels) range.extend(glm::transpose(axes) * Vec3d(v[0], v[1], v[2]));
  return {axes * range.centre(), range.extent() + 1.0, axes};
}

/// The voxels' principal axes, in the order and with the signs that are nearest to x, y and z.
Mat3d principal_axes(const Voxels& voxels) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Voxel& v : voxels) mean += Eigen::Vector3d(v[0], v[1], v[2]) / double(voxels.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Voxel& v : voxels) {
    const Eigen::Vector3d d = Eigen::Vector3d(v[0], v[1], v[2]) - mean;
    spread += d * d.transpose();
  }
  const Eigen::Matrix3d found = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  std::array<int, 3> order{0, 1, 2}, best = order;
  double most = -1;
  do {
    const double fit = std::abs(found(0, order[0])) + std::abs(found(1, order[1])) + std::abs(found(2, order[2]));
    if (fit > most) most = fit, best = order;
  } while (std::next_permutation(order.begin(), order.end()));
  Mat3d axes;
  for (int i = 0; i < 3; ++i) {
    axes[i] = Vec3d(found(0, best[size_t(i)]), found(1, best[size_t(i)]), found(2, best[size_t(i)]));
    if (axes[i][i] < 0) axes[i] = -axes[i];
  }
  return glm::dot(glm::cross(axes[0], axes[1]), axes[2]) > 0 ? axes : Mat3d(1.0);
}

PartBox box_around(const Voxels& voxels) {
  const PartBox upright = box_along(Mat3d(1.0), voxels), turned = box_along(principal_axes(voxels), voxels);
  return volume(turned) < k_turned_volume * volume(upright) ? turned : upright;
}

/// Joins what is one part, as the two halves of a back that leans.
void join(std::vector<Voxels>& parts) {
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t a = 0; a < parts.size() && !changed; ++a)
      for (size_t b = a + 1; b < parts.size() && !changed; ++b) {
        Voxels both = parts[a];
        both.insert(both.end(), parts[b].begin(), parts[b].end());
        if (volume(box_around(both)) > k_joined_volume * (volume(box_around(parts[a])) + volume(box_around(parts[b])))) continue;
        if (components(both).size() > 1) continue;
        parts[a] = std::move(both);
        parts.erase(parts.begin() + std::ptrdiff_t(b));
        changed = true;
      }
  }
}

bool has_inside(const DistanceGrid& grid) {
  const std::array<int, 3> count = grid.sample_count();
  for (int z = 0; z < count[2]; ++z)
    for (int y = 0; y < count[1]; ++y)
      for (int x = 0; x < count[0]; ++x)
        if (grid.sample({x, y, z}) < 0) return true;
  return false;
}

} // namespace

std::vector<PartBox> part_boxes(const DistanceGrid& grid) {
  const Vec3d extent = grid.box().extent();
  const double voxel = std::max({extent.x, extent.y, extent.z}) / k_voxels_along;
  Voxels inside; // and half a voxel around it: thin things hang together
  for (int z = 0; z * voxel < extent.z; ++z)
    for (int y = 0; y * voxel < extent.y; ++y)
      for (int x = 0; x * voxel < extent.x; ++x) {
        const Vec3d p = grid.box().lower + voxel * (Vec3d(x, y, z) + 0.5);
        if (grid.at(Point3<double>{p.x, p.y, p.z}).value < 0.5 * voxel) inside.push_back({x, y, z});
      }
  if (!has_inside(grid)) return {};
  std::vector<Voxels> parts = divide(inside);
  join(parts);
  std::sort(parts.begin(), parts.end(), [](const Voxels& a, const Voxels& b) { return a.size() > b.size(); });
  std::vector<PartBox> boxes;
  for (const Voxels& part : parts) {
    PartBox box = box_around(part);
    box.centre = grid.box().lower + voxel * (box.centre + 0.5), box.size *= voxel;
    boxes.push_back(box);
  }
  return boxes;
}

} // namespace kelpie
