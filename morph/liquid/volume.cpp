#include "morph/liquid/volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace kelpie {

namespace {

constexpr double k_most_gain = 64;

constexpr size_t k_point_cells = 100'000;
constexpr size_t k_extent_cells = 1'000'000;

/// Adds the blob's potential at the cells x = first..last of the row through (y, z) at distance^2 `yz` of its centre.
void add_row(const Blob& b, const FalloffPolynomial& p, float x0, float step, float yz, int first, int last, float* row) {
  const float inverse = 1 / (b.radius * b.radius);
  const float a = static_cast<float>(p.a) * b.weight, c = static_cast<float>(p.b) * b.weight;
  for (int i = first; i <= last; ++i) {
    const float dx = x0 + step * static_cast<float>(i) - b.centre.x;
    const float q = std::max(0.f, 1 - (dx * dx + yz) * inverse);
    row[i] += q * q * (a + c * q);
  }
}

/// The same of an ellipsoid, from where its matrix takes the first place of the row and how far a step goes there.
void add_row(const Blob& b, const FalloffPolynomial& p, const Vec3& start, const Vec3& step, int first, int last, float* row) {
  const float a = static_cast<float>(p.a) * b.weight, c = static_cast<float>(p.b) * b.weight;
  for (int i = first; i <= last; ++i) {
    const Vec3 u = start + static_cast<float>(i) * step;
    const float q = std::max(0.f, 1 - glm::dot(u, u));
    row[i] += q * q * (a + c * q);
  }
}

Box3 support(const BlobCloud& cloud) {
  Box3 box;
  for (const Blob& b : cloud) box.extend(kelpie::support(b));
  return box;
}

/// The first and the last of the slices that are left without the outermost hundredth of their sum at either end.
std::pair<size_t, size_t> bulk_of(const std::vector<size_t>& slices) {
  const size_t left_out = std::accumulate(slices.begin(), slices.end(), size_t(0)) / 100;
  size_t first = 0, last = slices.size() - 1;
  for (size_t sum = slices[first]; sum <= left_out; sum += slices[++first]) {
  }
  for (size_t sum = slices[last]; sum <= left_out; sum += slices[--last]) {
  }
  return {first, last};
}

} // namespace

VolumeGrid::VolumeGrid(const Box3& box, size_t cells) : origin_(box.lower) {
  const Vec3 extent = glm::max(box.extent(), Vec3(1e-3f * box.diagonal() + 1e-30f));
  step_ = std::cbrt(extent.x * extent.y * extent.z / static_cast<float>(cells));
  for (int k = 0; k < 3; ++k) count_[k] = 1 + static_cast<size_t>(extent[k] / step_);
  origin_ += 0.5f * step_;
}

std::vector<float> VolumeGrid::potentials(const BlobCloud& cloud) const {
  std::vector<float> sums(count_[0] * count_[1] * count_[2], 0.f);
  for (const Blob& b : cloud) {
    const Box3 box = kelpie::support(b);
    int first[3], last[3];
    for (int k = 0; k < 3; ++k) {
      const float most = static_cast<float>(count_[k] - 1);
      first[k] = static_cast<int>(std::clamp(std::ceil((box.lower[k] - origin_[k]) / step_), 0.f, most));
      last[k] = static_cast<int>(std::clamp(std::floor((box.upper[k] - origin_[k]) / step_), 0.f, most));
    }
    const FalloffPolynomial p = polynomial(b.falloff);
    const Mat3 to_ball(to_unit_ball(b).matrix());
    for (int z = first[2]; z <= last[2]; ++z)
      for (int y = first[1]; y <= last[1]; ++y) {
        const float dy = origin_.y + step_ * static_cast<float>(y) - b.centre.y,
                    dz = origin_.z + step_ * static_cast<float>(z) - b.centre.z;
        float* const row = sums.data() + (z * count_[1] + y) * count_[0];
        if (!is_round(b)) {
          add_row(b, p, to_ball * Vec3(origin_.x - b.centre.x, dy, dz), to_ball * Vec3(step_, 0, 0), first[0], last[0], row);
          continue;
        }
        const float yz = dy * dy + dz * dz, left = b.radius * b.radius - yz;
        if (left <= 0) continue;
        const float half = std::sqrt(left) / step_, middle = (b.centre.x - origin_.x) / step_;
        add_row(b, p, origin_.x, step_, yz, std::max(first[0], static_cast<int>(std::floor(middle - half))),
                std::min(last[0], static_cast<int>(std::ceil(middle + half))), row);
      }
  }
  return sums;
}

double VolumeGrid::volume(const BlobCloud& cloud) const {
  const std::vector<float> sums = potentials(cloud);
  return static_cast<double>(std::count_if(sums.begin(), sums.end(), [](float f) { return f > 1; }));
}

CloudExtent VolumeGrid::extent(const BlobCloud& cloud) const {
  CloudExtent e;
  std::array<std::vector<size_t>, 3> slices; // how many cells inside each slice across an axis has
  for (size_t k = 0; k < 3; ++k) slices[k].resize(count_[k]);
  for_each_cell_inside(cloud, [&](const Vec3& lower, const Vec3& upper) {
    e.box.extend(Box3{lower, upper});
    e.volume += double(step_) * double(step_) * double(step_);
    const Vec3 cell = (lower - origin_) / step_ + 1.f;
    for (size_t k = 0; k < 3; ++k) ++slices[k][std::min(static_cast<size_t>(cell[k]), count_[k] - 1)];
  });
  for (size_t k = 0; k < 3 && !e.box.is_empty(); ++k) {
    const auto [first, last] = bulk_of(slices[k]);
    e.bulk.lower[k] = origin_[k] + step_ * (static_cast<float>(first) - 0.5f);
    e.bulk.upper[k] = origin_[k] + step_ * (static_cast<float>(last) + 0.5f);
  }
  return e;
}

CloudExtent extent_of(const BlobCloud& cloud) { return VolumeGrid(support(cloud), k_extent_cells).extent(cloud); }

std::vector<Vec3> points_inside(const BlobCloud& cloud) {
  std::vector<Vec3> points;
  VolumeGrid(support(cloud), k_point_cells).for_each_cell_inside(cloud, [&](const Vec3& lower, const Vec3& upper) {
    points.push_back(0.5f * (lower + upper));
  });
  return points;
}

double VolumeGrid::gain_for_volume(const BlobCloud& cloud, double wanted) const {
  std::vector<float> sums = potentials(cloud);
  // {gain * f > 1} is {f > 1/gain}: the threshold that `wanted` cells exceed is an order statistic.
  const size_t rank = std::min(static_cast<size_t>(std::max(wanted, 0.0)), sums.size() - 1);
  std::nth_element(sums.begin(), sums.begin() + static_cast<std::ptrdiff_t>(rank), sums.end(), std::greater<>());
  const double threshold = sums[rank];
  return std::clamp(threshold > 0 ? 1 / threshold : k_most_gain, 1 / k_most_gain, k_most_gain);
}

} // namespace kelpie
