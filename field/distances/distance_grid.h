// Signed distances on a lattice, in bricks near the surface.
//
// The distance that a grid yields is the trilinear interpolation of its samples: that function, and no other, is what is
// bounded and rendered, so bounds are exact whatever the mesh is like. It is continuous; `band` away from the surface it is the
// constant band, or -band. How far it is from a mesh's own distance is measured in tests/distance_test.cpp.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/box.h"
#include "base/interval.h"

namespace kelpie {

/// A value and its derivatives by the coordinates.
template <class T>
struct GridValue {
  T value;
  std::array<T, 3> slopes;
};

class DistanceGrid {
public:
  /// A signed distance at a place; of what is farther than `most` only the sign matters, and that it is at least that far.
  using Distance = std::function<double(const Vec3d& p, double most)>;

  /// Samples `distance` at the corners of the voxels of a box, which is grown to whole bricks and by one voxel. At its border all is
  /// outside. Several threads call `distance` at once.
  DistanceGrid(const Box3d& box, double voxel, double band, const Distance& distance);

  /// What can be read again, by this program on this machine.
  std::string to_bytes() const;
  /// Nothing if it is not what to_bytes() made.
  static std::optional<DistanceGrid> from_bytes(std::string_view);

  /// Where voxels meet, the slopes are those of one of them.
  GridValue<double> at(const Point3<double>& p) const;
  /// Over a box: exact over up to eight voxels, then as the samples are.
  GridValue<Interval> at(const Point3<Interval>& p) const;

  /// Outside, everything is `band`.
  const Box3d& box() const { return box_; }
  double voxel() const { return voxel_; }
  double band() const { return band_; }
  size_t bytes() const { return samples_.size() * sizeof(float) + bricks_.size() * sizeof(Brick); }

private:
  static constexpr int k_cells = 8, k_side = k_cells + 1; ///< voxels and samples of a brick along each axis
  static constexpr size_t k_volume = size_t(k_side) * k_side * k_side;

  using Place = std::array<int, 3>;
  struct Brick {
    static constexpr size_t k_none = ~size_t(0);
    size_t first = k_none;     ///< into the samples; none: constant
    GridValue<Interval> range; ///< over all of it
  };
  /// The shape of a grid, as it is written.
  struct Header {
    std::array<char, 8> magic{'k', 'e', 'l', 'p', 's', 'd', 'f', '1'};
    std::array<double, 6> box{};
    double voxel = 0, band = 0;
    std::array<int32_t, 4> count{};
    uint64_t hash = 0; ///< of all that follows
  };
  /// The eight corners of a voxel: x, then y, then z.
  using Corners = std::array<double, 8>;

  DistanceGrid() = default;
  Place place(size_t index) const {
    const auto nx = size_t(count_[0]), ny = size_t(count_[1]);
    return {int(index % nx), int(index / nx % ny), int(index / nx / ny)};
  }
  std::vector<float> sample(const Place& brick, const Distance&) const;
  void fill(const Distance&);
  void find_ranges();
  std::vector<Place> torn_bricks(const std::vector<std::vector<float>>& samples) const;

  size_t index(const Place& brick) const {
    return (size_t(brick[2]) * size_t(count_[1]) + size_t(brick[1])) * size_t(count_[0]) + size_t(brick[0]);
  }
  Corners corners(const Place& voxel) const;
  void extend_by_voxel(const Place& voxel, const std::array<Interval, 3>& place, GridValue<Interval>& out) const;
  void extend_by_samples(const Place& brick, const Place& from, const Place& to, GridValue<Interval>& out) const;

  Box3d box_;
  double voxel_ = 1, band_ = 1;
  Place count_{}; ///< of bricks
  std::vector<Brick> bricks_;
  std::vector<float> samples_; ///< bricks of k_volume: x, then y, then z; in scene units
};

} // namespace kelpie
