#include "field/distances/distance_grid.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <xxhash.h>

#include "base/parallel.h"

namespace kelpie {

namespace {

const GridValue<Interval> k_nothing{{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()},
                                    {Interval{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()},
                                     Interval{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()},
                                     Interval{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}}};

void extend(GridValue<Interval>& out, const GridValue<Interval>& by) {
  out.value = hull(out.value, by.value);
  for (size_t i = 0; i < 3; ++i) out.slopes[i] = hull(out.slopes[i], by.slopes[i]);
}

double lerp(double a, double b, double t) { return a + (b - a) * t; }

} // namespace

DistanceGrid::DistanceGrid(const Box3d& box, double voxel, double band, const Distance& distance)
    : voxel_(voxel), band_(static_cast<float>(band)) { // as samples are
  const Vec3d extent = box.extent() + 2 * voxel;
  Vec3d size;
  for (int i = 0; i < 3; ++i) {
    count_[size_t(i)] = std::max(1, static_cast<int>(std::ceil(extent[i] / (k_cells * voxel))));
    size[i] = count_[size_t(i)] * k_cells * voxel;
  }
  box_ = {box.centre() - 0.5 * size, box.centre() + 0.5 * size};
  fill(distance);
}

/// Every sample of a brick, cut off at the band. Bricks that share samples make the same numbers of them.
std::vector<float> DistanceGrid::sample(const Place& brick, const Distance& distance) const {
  std::vector<float> out(k_volume);
  size_t i = 0;
  for (int z = 0; z < k_side; ++z)
    for (int y = 0; y < k_side; ++y)
      for (int x = 0; x < k_side; ++x) {
        const Place at{brick[0] * k_cells + x, brick[1] * k_cells + y, brick[2] * k_cells + z};
        bool is_border = false;
        for (size_t axis = 0; axis < 3; ++axis) is_border = is_border || at[axis] == 0 || at[axis] == count_[axis] * k_cells;
        const double d = is_border ? band_ : distance(box_.lower + voxel_ * Vec3d(at[0], at[1], at[2]), band_);
        out[i++] = static_cast<float>(std::clamp(d, -band_, band_));
      }
  return out;
}

void DistanceGrid::fill(const Distance& distance) {
  const size_t total = size_t(count_[0]) * size_t(count_[1]) * size_t(count_[2]);
  bricks_.resize(total);
  std::vector<std::vector<float>> samples(total);
  const double reach = 0.5 * std::sqrt(3.0) * k_cells * voxel_ + band_;
  parallel_for(size_t(0), total, [&](size_t i) {
    const Place b = place(i);
    const double d = distance(box_.lower + voxel_ * k_cells * (Vec3d(b[0], b[1], b[2]) + 0.5), reach);
    if (std::abs(d) >= reach * (1 - 1e-9))
      bricks_[i].range.value = d > 0 ? band_ : -band_;
    else
      samples[i] = sample(b, distance);
  });
  // What is constant must go on as its neighbours do. Distances need not: across holes of a mesh their sign changes far from it.
  for (;;) {
    const std::vector<Place> torn = torn_bricks(samples);
    if (torn.empty()) break;
    parallel_for(size_t(0), torn.size(), [&](size_t i) { samples[index(torn[i])] = sample(torn[i], distance); });
  }
  for (size_t i = 0; i < total; ++i)
    if (!samples[i].empty()) {
      bricks_[i].first = samples_.size();
      samples_.insert(samples_.end(), samples[i].begin(), samples[i].end());
      samples[i] = {};
    }
  find_ranges();
}

/// The constant bricks that differ from a neighbour, or from what is outside the box.
std::vector<DistanceGrid::Place> DistanceGrid::torn_bricks(const std::vector<std::vector<float>>& samples) const {
  std::vector<Place> torn;
  for (int z = 0; z < count_[2]; ++z)
    for (int y = 0; y < count_[1]; ++y)
      for (int x = 0; x < count_[0]; ++x) {
        const Place at{x, y, z};
        if (!samples[index(at)].empty()) continue;
        const auto value = static_cast<float>(bricks_[index(at)].range.value.lo);
        bool is_torn = false;
        for (size_t axis = 0; axis < 3; ++axis)
          for (const int side : {-1, 1}) {
            Place other = at;
            other[axis] += side;
            if (other[axis] < 0 || other[axis] >= count_[axis]) {
              is_torn = is_torn || value < 0;
              continue;
            }
            const std::vector<float>& s = samples[index(other)];
            if (s.empty()) {
              is_torn = is_torn || static_cast<float>(bricks_[index(other)].range.value.lo) != value;
              continue;
            }
            const size_t strides[] = {1, k_side, size_t(k_side) * k_side};
            const size_t u = strides[(axis + 1) % 3], v = strides[(axis + 2) % 3], start = side < 0 ? strides[axis] * k_cells : 0;
            for (size_t i = 0; i < k_side; ++i)
              for (size_t j = 0; j < k_side; ++j) is_torn = is_torn || s[start + i * u + j * v] != value;
          }
        if (is_torn) torn.push_back(at);
      }
  return torn;
}

std::string DistanceGrid::to_bytes() const {
  std::string rest;
  for (const Brick& b : bricks_) rest += b.first != Brick::k_none ? '*' : b.range.value.lo > 0 ? '+' : '-';
  rest.append(reinterpret_cast<const char*>(samples_.data()), samples_.size() * sizeof(float));
  Header header;
  header.box = {box_.lower.x, box_.lower.y, box_.lower.z, box_.upper.x, box_.upper.y, box_.upper.z};
  header.voxel = voxel_, header.band = band_, header.count = {count_[0], count_[1], count_[2], 0};
  header.hash = XXH3_64bits(rest.data(), rest.size());
  return std::string(reinterpret_cast<const char*>(&header), sizeof header) + rest;
}

std::optional<DistanceGrid> DistanceGrid::from_bytes(std::string_view bytes) {
  Header header;
  if (bytes.size() < sizeof header) return {};
  std::memcpy(&header, bytes.data(), sizeof header);
  bytes.remove_prefix(sizeof header);
  if (header.magic != Header{}.magic || header.hash != XXH3_64bits(bytes.data(), bytes.size())) return {};
  DistanceGrid grid;
  grid.box_ = {{header.box[0], header.box[1], header.box[2]}, {header.box[3], header.box[4], header.box[5]}};
  grid.voxel_ = header.voxel, grid.band_ = header.band, grid.count_ = {header.count[0], header.count[1], header.count[2]};
  constexpr int k_most = 1 << 16; // so that their product is a number
  if (!(grid.voxel_ > 0) || !(grid.band_ > 0)) return {};
  for (int i = 0; i < 3; ++i) {
    const int count = grid.count_[size_t(i)];
    const double bricks = grid.box_.extent()[i] / (k_cells * grid.voxel_);
    if (count < 1 || count > k_most || !(std::abs(bricks - count) < 1e-3)) return {};
  }
  const size_t total = size_t(grid.count_[0]) * size_t(grid.count_[1]) * size_t(grid.count_[2]);
  if (bytes.size() < total) return {};
  grid.bricks_.resize(total);
  size_t sampled = 0;
  for (size_t i = 0; i < total; ++i) {
    grid.bricks_[i].range.value = bytes[i] == '-' ? -grid.band_ : grid.band_;
    if (bytes[i] == '*') grid.bricks_[i].first = k_volume * sampled++;
  }
  bytes.remove_prefix(total);
  if (bytes.size() != sampled * k_volume * sizeof(float)) return {};
  grid.samples_.resize(sampled * k_volume);
  if (sampled > 0) std::memcpy(grid.samples_.data(), bytes.data(), bytes.size());
  grid.find_ranges();
  return grid;
}

/// What the samples of each brick range over.
void DistanceGrid::find_ranges() {
  for (size_t i = 0; i < bricks_.size(); ++i)
    if (bricks_[i].first != Brick::k_none) {
      bricks_[i].range = k_nothing;
      extend_by_samples(place(i), {0, 0, 0}, {k_cells - 1, k_cells - 1, k_cells - 1}, bricks_[i].range);
    }
}

DistanceGrid::Corners DistanceGrid::corners(const Place& voxel) const {
  Place brick, local;
  for (size_t i = 0; i < 3; ++i) brick[i] = voxel[i] / k_cells, local[i] = voxel[i] % k_cells;
  const Brick& b = bricks_[index(brick)];
  Corners c;
  if (b.first == Brick::k_none) {
    c.fill(b.range.value.lo);
    return c;
  }
  const float* s = samples_.data() + b.first + (size_t(local[2]) * k_side + size_t(local[1])) * k_side + size_t(local[0]);
  for (size_t i = 0; i < 8; ++i) c[i] = s[(i & 1) + (i >> 1 & 1) * k_side + (i >> 2) * k_side * k_side];
  return c;
}

GridValue<double> DistanceGrid::at(const Point3<double>& p) const {
  if (!box_.contains(Vec3d(p.x, p.y, p.z))) return {band_, {0, 0, 0}};
  const Vec3d u = (Vec3d(p.x, p.y, p.z) - box_.lower) / voxel_;
  Place voxel;
  Vec3d t;
  for (int i = 0; i < 3; ++i) {
    voxel[size_t(i)] = std::min(static_cast<int>(u[i]), count_[size_t(i)] * k_cells - 1);
    t[i] = u[i] - voxel[size_t(i)];
  }
  const Corners c = corners(voxel);
  const auto along_x = [&](size_t i) { return lerp(c[i], c[i + 1], t.x); };
  const auto along_y = [&](size_t i) { return lerp(c[i], c[i + 2], t.y); };
  const double y0 = along_x(0), y1 = along_x(2), y2 = along_x(4), y3 = along_x(6);
  const double z0 = lerp(y0, y1, t.y), z1 = lerp(y2, y3, t.y);
  const double by_x = lerp(along_y(1) - along_y(0), along_y(5) - along_y(4), t.z);
  const double by_y = lerp(y1 - y0, y3 - y2, t.z), by_z = z1 - z0;
  return {lerp(z0, z1, t.z), {by_x / voxel_, by_y / voxel_, by_z / voxel_}};
}

/// `place`: within the voxel, from 0 to 1. What is linear in each coordinate has its extremes at the corners.
void DistanceGrid::extend_by_voxel(const Place& voxel, const std::array<Interval, 3>& place, GridValue<Interval>& out) const {
  const Corners c = corners(voxel);
  const auto end = [&](size_t axis, size_t which) { return which ? place[axis].hi : place[axis].lo; };
  for (size_t i = 0; i < 8; ++i) {
    const double x = end(0, i & 1), y = end(1, i >> 1 & 1), z = end(2, i >> 2);
    const double value = lerp(lerp(lerp(c[0], c[1], x), lerp(c[2], c[3], x), y), lerp(lerp(c[4], c[5], x), lerp(c[6], c[7], x), y), z);
    const double by_x = lerp(lerp(c[1] - c[0], c[3] - c[2], y), lerp(c[5] - c[4], c[7] - c[6], y), z);
    const double by_y = lerp(lerp(c[2] - c[0], c[3] - c[1], x), lerp(c[6] - c[4], c[7] - c[5], x), z);
    const double by_z = lerp(lerp(c[4] - c[0], c[5] - c[1], x), lerp(c[6] - c[2], c[7] - c[3], x), y);
    extend(out, {value, {Interval{by_x / voxel_}, Interval{by_y / voxel_}, Interval{by_z / voxel_}}});
  }
}

/// The voxels `from` to `to` of a brick.
void DistanceGrid::extend_by_samples(const Place& brick, const Place& from, const Place& to, GridValue<Interval>& out) const {
  const Brick& b = bricks_[index(brick)];
  if (b.first == Brick::k_none) return extend(out, b.range);
  const float* s = samples_.data() + b.first;
  const size_t strides[] = {1, k_side, size_t(k_side) * k_side};
  float least = std::numeric_limits<float>::infinity(), most = -least;
  std::array<float, 3> slope_least{least, least, least}, slope_most{most, most, most};
  for (int z = from[2]; z <= to[2] + 1; ++z)
    for (int y = from[1]; y <= to[1] + 1; ++y)
      for (int x = from[0]; x <= to[0] + 1; ++x) {
        const float* at = s + size_t(x) + size_t(y) * strides[1] + size_t(z) * strides[2];
        least = std::min(least, *at), most = std::max(most, *at);
        const Place place{x, y, z};
        for (size_t axis = 0; axis < 3; ++axis) {
          if (place[axis] > to[axis]) continue;
          const float rise = at[strides[axis]] - *at;
          slope_least[axis] = std::min(slope_least[axis], rise), slope_most[axis] = std::max(slope_most[axis], rise);
        }
      }
  GridValue<Interval> range;
  range.value = {least, most};
  constexpr double k_rounding = 1e-7; // differences of floats
  for (size_t axis = 0; axis < 3; ++axis) {
    const double slack = k_rounding * band_;
    range.slopes[axis] = {(slope_least[axis] - slack) / voxel_, (slope_most[axis] + slack) / voxel_};
  }
  extend(out, range);
}

GridValue<Interval> DistanceGrid::at(const Point3<Interval>& p) const {
  const std::array<Interval, 3> in{p.x, p.y, p.z};
  GridValue<Interval> out = k_nothing;
  Place from, to;
  std::array<Interval, 3> u;
  bool is_within = true;
  size_t voxels = 1;
  const GridValue<Interval> outside{band_, {Interval{0.0}, Interval{0.0}, Interval{0.0}}};
  for (int i = 0; i < 3; ++i) {
    const auto axis = size_t(i);
    if (!(in[axis].lo <= box_.upper[i] && in[axis].hi >= box_.lower[i])) return outside;
    is_within = is_within && in[axis].lo >= box_.lower[i] && in[axis].hi <= box_.upper[i];
    const int last = count_[axis] * k_cells - 1;
    u[axis] = (intersect(in[axis], Interval{box_.lower[i], box_.upper[i]}) - Interval{box_.lower[i]}) * (1 / voxel_);
    from[axis] = std::clamp(static_cast<int>(u[axis].lo), 0, last), to[axis] = std::clamp(static_cast<int>(u[axis].hi), 0, last);
    voxels *= size_t(to[axis] - from[axis] + 1);
  }
  if (!is_within) extend(out, outside);
  if (voxels <= 8) {
    Place at;
    for (at[2] = from[2]; at[2] <= to[2]; ++at[2])
      for (at[1] = from[1]; at[1] <= to[1]; ++at[1])
        for (at[0] = from[0]; at[0] <= to[0]; ++at[0]) {
          std::array<Interval, 3> place;
          for (size_t i = 0; i < 3; ++i) place[i] = {std::clamp(u[i].lo - at[i], 0.0, 1.0), std::clamp(u[i].hi - at[i], 0.0, 1.0)};
          extend_by_voxel(at, place, out);
        }
    return out;
  }
  Place brick;
  for (brick[2] = from[2] / k_cells; brick[2] <= to[2] / k_cells; ++brick[2])
    for (brick[1] = from[1] / k_cells; brick[1] <= to[1] / k_cells; ++brick[1])
      for (brick[0] = from[0] / k_cells; brick[0] <= to[0] / k_cells; ++brick[0]) {
        Place first, last;
        bool is_whole = true;
        for (size_t i = 0; i < 3; ++i) {
          first[i] = std::max(0, from[i] - brick[i] * k_cells), last[i] = std::min(k_cells - 1, to[i] - brick[i] * k_cells);
          is_whole = is_whole && first[i] == 0 && last[i] == k_cells - 1;
        }
        if (is_whole)
          extend(out, bricks_[index(brick)].range);
        else
          extend_by_samples(brick, first, last, out);
      }
  return out;
}

} // namespace kelpie
