// Signed distances on a lattice, in bricks near the surface.
//
// The distance that a grid yields is the cubic B-spline of its samples: that function, and no other, is what is bounded and rendered, so
// bounds are exact whatever the mesh is like. It is twice continuously differentiable, so that mirrors show no voxels; `band` away from the
// surface it is the constant band, or -band. A B-spline does not pass through its samples: it is smoother than they are, by less than a
// voxel. How far it is from a mesh's own distance is measured in tests/distance_test.cpp.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/box.h"
#include "base/dual.h"

namespace kelpie {

/// A value and its derivatives by the coordinates.
template <class T>
struct GridValue {
  T value;
  std::array<T, 3> slopes;
};

class FarDistances;

class DistanceGrid {
public:
  /// A signed distance at a place; of what is farther than `most` only the sign matters, and that it is at least that far. Each brick
  /// asks a copy of it, from place to neighbouring place: it may remember the last one.
  using Distance = std::function<double(const Vec3d& p, double most)>;

  /// Samples `distance` at the corners of the voxels of a box, which is grown to whole bricks and by one voxel. At its border all is
  /// outside. Several threads call `distance` at once.
  DistanceGrid(const Box3d& box, double voxel, double band, const Distance& distance);

  /// What can be read again, by this program on this machine.
  std::string to_bytes() const;
  /// Nothing if it is not what to_bytes() made.
  static std::optional<DistanceGrid> from_bytes(std::string_view);

  GridValue<double> at(const Point3<double>& p) const;
  /// Over a box: as the samples around it range; values over a few voxels by the slopes, too.
  GridValue<Interval> at(const Point3<Interval>& p) const;

  /// Outside, everything is `band`.
  const Box3d& box() const { return box_; }
  double voxel() const { return voxel_; }
  double band() const { return band_; }
  /// How many samples there are along each axis, the first one at the box's lower corner, and one of them: a coefficient of the spline.
  /// Beyond them all are `band`.
  std::array<int, 3> sample_count() const { return {count_[0] * k_cells, count_[1] * k_cells, count_[2] * k_cells}; }
  double sample(const std::array<int, 3>& place) const;
  /// How its distances go on beyond the band (field/distances/far_distances.h); made when it is first asked for.
  std::shared_ptr<const FarDistances> far() const;
  size_t bytes() const { return samples_.size() * sizeof(float) + bricks_.size() * sizeof(Brick); }

private:
  /// Voxels of a brick along each axis, and samples: those of its own, and what the spline needs of its neighbours' (one before, two
  /// after).
  static constexpr int k_cells = 8, k_side = k_cells + 3;
  static constexpr size_t k_volume = size_t(k_side) * k_side * k_side, k_own = size_t(k_cells) * k_cells * k_cells;

  using Place = std::array<int, 3>;
  struct Brick {
    static constexpr size_t k_none = ~size_t(0);
    size_t first = k_none;     ///< into the samples; none: constant
    GridValue<Interval> range; ///< over all of it
  };
  /// The shape of a grid, as it is written.
  struct Header {
    std::array<char, 8> magic{'k', 'e', 'l', 'p', 's', 'd', 'f', '2'};
    std::array<double, 6> box{};
    double voxel = 0, band = 0;
    std::array<int32_t, 4> count{};
    uint64_t hash = 0; ///< of all that follows
  };
  struct Far; ///< made once
  /// The samples of each brick's own voxels; of one that is constant none.
  using OwnSamples = std::vector<std::vector<float>>;

  DistanceGrid();
  Place place(size_t index) const {
    const auto nx = size_t(count_[0]), ny = size_t(count_[1]);
    return {int(index % nx), int(index / nx % ny), int(index / nx / ny)};
  }
  std::vector<float> sample_brick(const Place& brick, Distance) const;
  void fill(const Distance&);
  void keep(const OwnSamples&);
  void find_ranges();
  std::vector<Place> torn_bricks(const OwnSamples&) const;
  bool is_torn(const Place& brick, const OwnSamples&) const;
  float own_sample(const Place& place, const OwnSamples&) const;

  size_t index(const Place& brick) const {
    return (size_t(brick[2]) * size_t(count_[1]) + size_t(brick[1])) * size_t(count_[0]) + size_t(brick[0]);
  }
  const float* samples_around(const Place& voxel, const Brick&) const;
  void extend_by_voxels(const Place& brick, const Place& from, const Place& to, GridValue<Interval>& out) const;
  Interval mean_value(const Point3<Interval>& box, const std::array<Interval, 3>& slopes) const;

  Box3d box_;
  double voxel_ = 1, band_ = 1;
  Place count_{}; ///< of bricks
  std::vector<Brick> bricks_;
  std::vector<float> samples_; ///< bricks of k_volume, from one before the brick on: x, then y, then z; in scene units
  std::shared_ptr<Far> far_;
};

/// The distance of a grid at a point of any number type.
inline double distance_in(const DistanceGrid& grid, const Point3<double>& p) { return grid.at(p).value; }
inline Interval distance_in(const DistanceGrid& grid, const Point3<Interval>& p) { return grid.at(p).value; }
template <class T, int N>
Dual<T, N> distance_in(const DistanceGrid& grid, const Point3<Dual<T, N>>& p) {
  const GridValue<T> at = grid.at(Point3<T>{p.x.value, p.y.value, p.z.value});
  Dual<T, N> r;
  r.value = at.value;
  for (int i = 0; i < N; ++i) r.d[i] = at.slopes[0] * p.x.d[i] + at.slopes[1] * p.y.d[i] + at.slopes[2] * p.z.d[i];
  return r;
}

} // namespace kelpie
