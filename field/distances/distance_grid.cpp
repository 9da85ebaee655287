#include "field/distances/distance_grid.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>

#include <xxhash.h>

#include "base/parallel.h"
#include "field/distances/far_distances.h"

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

/// The cubic B-spline's weights of the four samples around a place t in [0, 1] of a voxel, and their derivatives by t.
struct Weights {
  std::array<double, 4> value, slope;
  explicit Weights(double t)
      : value{cube(1 - t) / 6, (4 + t * t * (3 * t - 6)) / 6, (1 + t * (3 + t * (3 - 3 * t))) / 6, cube(t) / 6},
        slope{-0.5 * (1 - t) * (1 - t), 0.5 * t * (3 * t - 4), 0.5 * (1 + t * (2 - 3 * t)), 0.5 * t * t} {}

private:
  static double cube(double x) { return x * x * x; }
};

/// Four numbers at once, in the vector units that every machine of the kind has (of GCC and clang).
using Four [[gnu::vector_size(16)]] = float;

Four load(const float* numbers) {
  Four f;
  std::memcpy(&f, numbers, sizeof f);
  return f;
}

/// The least and the largest of many rows of 4 * Groups numbers, each place of a row for itself.
template <int Groups>
class Extremes {
public:
  Extremes() {
    constexpr float k_infinite = std::numeric_limits<float>::infinity();
    least_.fill(Four{k_infinite, k_infinite, k_infinite, k_infinite}), most_.fill(-least_[0]);
  }
  void take(const float* row) {
    for (size_t g = 0; g < Groups; ++g) take(g, load(row + 4 * g));
  }
  void take_rise(const float* from, const float* to) {
    for (size_t g = 0; g < Groups; ++g) take(g, load(to + 4 * g) - load(from + 4 * g));
  }
  Interval of_first(int count) const {
    Interval range{least_[0][0], most_[0][0]};
    for (int i = 1; i < count; ++i) range = hull(range, Interval{least_[size_t(i / 4)][i % 4], most_[size_t(i / 4)][i % 4]});
    return range;
  }

private:
  void take(size_t g, Four x) { least_[g] = x < least_[g] ? x : least_[g], most_[g] = x > most_[g] ? x : most_[g]; }
  std::array<Four, Groups> least_, most_;
};

/// Rounding, as a share of the band: of differences of samples, which are floats.
constexpr double k_rounding = 1e-7;

/// Numbers after the last brick, so that a row may be read somewhat beyond its end.
constexpr size_t k_padding = 32;

/// Boxes of more voxels than this are bounded by the samples alone.
constexpr size_t k_few_voxels = 27;

/// Of count[0] x count[1] x count[2] samples, count[0] up to 4 * Groups, in rows of a brick.
template <int Groups>
GridValue<Interval> range_of(const float* first, int side, const std::array<int, 3>& count, double voxel, double band) {
  Extremes<Groups> values, by_x, by_y, by_z;
  for (int z = 0; z < count[2]; ++z)
    for (int y = 0; y < count[1]; ++y) {
      const float* const row = first + (z * side + y) * side;
      values.take(row);
      by_x.take_rise(row, row + 1);
      if (y + 1 < count[1]) by_y.take_rise(row, row + side);
      if (z + 1 < count[2]) by_z.take_rise(row, row + side * side);
    }
  GridValue<Interval> range;
  range.value = values.of_first(count[0]);
  const double slack = range.value.lo < range.value.hi ? k_rounding * band : 0;
  const auto widened = [&](const Interval& i) { return Interval{i.lo - slack, i.hi + slack}; };
  range.slopes = {widened(by_x.of_first(count[0] - 1)), widened(by_y.of_first(count[0])), widened(by_z.of_first(count[0]))};
  for (Interval& slope : range.slopes) slope = {slope.lo / voxel, slope.hi / voxel};
  range.value = widened(range.value);
  return range;
}

} // namespace

struct DistanceGrid::Far {
  std::once_flag once;
  std::shared_ptr<const FarDistances> made;
};

DistanceGrid::DistanceGrid() : far_(std::make_shared<Far>()) {}

std::shared_ptr<const FarDistances> DistanceGrid::far() const {
  std::call_once(far_->once, [&] { far_->made = std::make_shared<const FarDistances>(*this); });
  return far_->made;
}

DistanceGrid::DistanceGrid(const Box3d& box, double voxel, double band, const Distance& distance) : DistanceGrid() {
  voxel_ = voxel, band_ = static_cast<float>(band); // as samples are
  const Vec3d extent = box.extent() + 2 * voxel;
  Vec3d size;
  for (int i = 0; i < 3; ++i) {
    count_[size_t(i)] = std::max(1, static_cast<int>(std::ceil(extent[i] / (k_cells * voxel))));
    size[i] = count_[size_t(i)] * k_cells * voxel;
  }
  box_ = {box.centre() - 0.5 * size, box.centre() + 0.5 * size};
  fill(distance);
}

/// The samples of a brick's own voxels, cut off at the band, on a way that leads from neighbour to neighbour.
std::vector<float> DistanceGrid::sample_brick(const Place& brick, Distance distance) const {
  std::vector<float> out(k_own);
  int x = 0, y = 0, step_x = 1, step_y = 1;
  for (int z = 0; z < k_cells; ++z) {
    for (int row = 0; row < k_cells; ++row) {
      for (int column = 0; column < k_cells; ++column) {
        const Place at{brick[0] * k_cells + x, brick[1] * k_cells + y, brick[2] * k_cells + z};
        bool is_border = false; // what the box's faces depend on
        for (size_t axis = 0; axis < 3; ++axis) is_border = is_border || at[axis] <= 1 || at[axis] == count_[axis] * k_cells - 1;
        const double d = is_border ? band_ : distance(box_.lower + voxel_ * Vec3d(at[0], at[1], at[2]), band_);
        out[size_t((z * k_cells + y) * k_cells + x)] = static_cast<float>(std::clamp(d, -band_, band_));
        if (column + 1 < k_cells) x += step_x;
      }
      step_x = -step_x;
      if (row + 1 < k_cells) y += step_y;
    }
    step_y = -step_y;
  }
  return out;
}

void DistanceGrid::fill(const Distance& distance) {
  const size_t total = size_t(count_[0]) * size_t(count_[1]) * size_t(count_[2]);
  bricks_.resize(total);
  OwnSamples samples(total);
  // Where the nearest surface is so far away, all samples on which the brick depends are band or -band.
  const double reach = 0.5 * std::sqrt(3.0) * (k_cells + 2) * voxel_ + band_;
  parallel_for(size_t(0), total, [&](size_t i) {
    const Place b = place(i);
    const double d = Distance(distance)(box_.lower + voxel_ * k_cells * (Vec3d(b[0], b[1], b[2]) + 0.5), reach);
    if (std::abs(d) >= reach * (1 - 1e-9))
      bricks_[i].range.value = d > 0 ? band_ : -band_;
    else
      samples[i] = sample_brick(b, distance);
  });
  // What is constant must go on as its neighbours do. Distances need not: across holes of a mesh their sign changes far from it.
  for (;;) {
    const std::vector<Place> torn = torn_bricks(samples);
    if (torn.empty()) break;
    parallel_for(size_t(0), torn.size(), [&](size_t i) { samples[index(torn[i])] = sample_brick(torn[i], distance); });
  }
  keep(samples);
  find_ranges();
}

/// The constant bricks that differ from a neighbour, or from what is outside the box.
std::vector<DistanceGrid::Place> DistanceGrid::torn_bricks(const OwnSamples& samples) const {
  std::vector<Place> torn;
  for (size_t i = 0; i < samples.size(); ++i)
    if (samples[i].empty() && is_torn(place(i), samples)) torn.push_back(place(i));
  return torn;
}

/// Whether a constant brick depends on a neighbour's sample of another value.
bool DistanceGrid::is_torn(const Place& brick, const OwnSamples& samples) const {
  const auto value = static_cast<float>(bricks_[index(brick)].range.value.lo);
  const auto first_of = [](int side) { return side < 0 ? k_cells - 1 : 0; };
  const auto last_of = [](int side) { return side > 0 ? 1 : k_cells - 1; };
  for (int side = 0; side < 27; ++side) {
    const Place by{side % 3 - 1, side / 3 % 3 - 1, side / 9 - 1};
    Place other = brick;
    bool is_outside = false;
    for (size_t i = 0; i < 3; ++i) other[i] += by[i], is_outside = is_outside || other[i] < 0 || other[i] >= count_[i];
    if (is_outside) {
      if (value < 0) return true;
      continue;
    }
    const std::vector<float>& s = samples[index(other)];
    if (s.empty()) {
      if (static_cast<float>(bricks_[index(other)].range.value.lo) != value) return true;
      continue;
    }
    for (int z = first_of(by[2]); z <= last_of(by[2]); ++z)
      for (int y = first_of(by[1]); y <= last_of(by[1]); ++y)
        for (int x = first_of(by[0]); x <= last_of(by[0]); ++x)
          if (s[size_t((z * k_cells + y) * k_cells + x)] != value) return true;
  }
  return false;
}

float DistanceGrid::own_sample(const Place& place, const OwnSamples& samples) const {
  Place brick, local;
  for (size_t i = 0; i < 3; ++i) {
    if (place[i] < 0 || place[i] >= count_[i] * k_cells) return static_cast<float>(band_);
    brick[i] = place[i] / k_cells, local[i] = place[i] % k_cells;
  }
  const std::vector<float>& s = samples[index(brick)];
  if (s.empty()) return static_cast<float>(bricks_[index(brick)].range.value.lo);
  return s[size_t((local[2] * k_cells + local[1]) * k_cells + local[0])];
}

/// Lays the bricks out, each with what it needs of its neighbours.
void DistanceGrid::keep(const OwnSamples& samples) {
  std::vector<size_t> sampled;
  for (size_t i = 0; i < samples.size(); ++i)
    if (!samples[i].empty()) bricks_[i].first = k_volume * sampled.size(), sampled.push_back(i);
  samples_.resize(k_volume * sampled.size() + k_padding);
  parallel_for(size_t(0), sampled.size(), [&](size_t i) {
    const Place brick = place(sampled[i]);
    float* out = samples_.data() + k_volume * i;
    for (int z = -1; z < k_side - 1; ++z)
      for (int y = -1; y < k_side - 1; ++y)
        for (int x = -1; x < k_side - 1; ++x)
          *out++ = own_sample({brick[0] * k_cells + x, brick[1] * k_cells + y, brick[2] * k_cells + z}, samples);
  });
}

double DistanceGrid::sample(const Place& at) const {
  Place brick;
  for (size_t i = 0; i < 3; ++i) brick[i] = at[i] / k_cells;
  const Brick& b = bricks_[index(brick)];
  constexpr size_t k_one_of_each = (size_t(k_side) + 1) * k_side + 1;
  return b.first == Brick::k_none ? b.range.value.lo : double(samples_around(at, b)[k_one_of_each]);
}

std::string DistanceGrid::to_bytes() const {
  std::string rest;
  for (const Brick& b : bricks_) rest += b.first != Brick::k_none ? '*' : b.range.value.lo > 0 ? '+' : '-';
  rest.append(reinterpret_cast<const char*>(samples_.data()), (samples_.size() - k_padding) * sizeof(float));
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
  grid.samples_.resize(sampled * k_volume + k_padding);
  if (sampled > 0) std::memcpy(grid.samples_.data(), bytes.data(), bytes.size());
  grid.find_ranges();
  return grid;
}

/// What the samples of each brick range over.
void DistanceGrid::find_ranges() {
  parallel_for(size_t(0), bricks_.size(), [&](size_t i) {
    if (bricks_[i].first == Brick::k_none) return;
    GridValue<Interval> range = k_nothing;
    extend_by_voxels(place(i), {0, 0, 0}, {k_cells - 1, k_cells - 1, k_cells - 1}, range);
    bricks_[i].range = range;
  });
}

/// The first of the 4 x 4 x 4 samples on which a voxel of a sampled brick depends.
const float* DistanceGrid::samples_around(const Place& voxel, const Brick& brick) const {
  const auto local = [&](size_t axis) { return size_t(voxel[axis] % k_cells); };
  return samples_.data() + brick.first + (local(2) * k_side + local(1)) * k_side + local(0);
}

GridValue<double> DistanceGrid::at(const Point3<double>& p) const {
  if (!box_.contains(Vec3d(p.x, p.y, p.z))) return {band_, {0, 0, 0}};
  const Vec3d u = (Vec3d(p.x, p.y, p.z) - box_.lower) / voxel_;
  Place voxel, brick;
  for (int i = 0; i < 3; ++i) {
    const auto axis = size_t(i);
    voxel[axis] = std::min(static_cast<int>(u[i]), count_[axis] * k_cells - 1), brick[axis] = voxel[axis] / k_cells;
  }
  const Brick& b = bricks_[index(brick)];
  if (b.first == Brick::k_none) return {b.range.value.lo, {0, 0, 0}};
  const float* const s = samples_around(voxel, b);
  const Weights x(u.x - voxel[0]), y(u.y - voxel[1]), z(u.z - voxel[2]);
  const double first = s[0]; // only differences are weighted, so that what is constant stays so to the last bit
  GridValue<double> sum{0, {0, 0, 0}};
  for (size_t k = 0; k < 4; ++k)
    for (size_t j = 0; j < 4; ++j) {
      const float* const row = s + (k * k_side + j) * k_side;
      double value = 0, slope = 0;
      for (size_t i = 0; i < 4; ++i) value += x.value[i] * (row[i] - first), slope += x.slope[i] * (row[i] - first);
      sum.value += z.value[k] * y.value[j] * value;
      sum.slopes[0] += z.value[k] * y.value[j] * slope;
      sum.slopes[1] += z.value[k] * y.slope[j] * value;
      sum.slopes[2] += z.slope[k] * y.value[j] * value;
    }
  for (double& slope : sum.slopes) slope /= voxel_;
  return {first + sum.value, sum.slopes};
}

/// The voxels `from` to `to` of a brick, by the samples on which they depend: a B-spline lies between its coefficients, and its slopes
/// between their differences.
void DistanceGrid::extend_by_voxels(const Place& brick, const Place& from, const Place& to, GridValue<Interval>& out) const {
  const Brick& b = bricks_[index(brick)];
  if (b.first == Brick::k_none) return extend(out, b.range);
  const float* const first = samples_.data() + b.first + (from[2] * k_side + from[1]) * k_side + from[0];
  const Place count{to[0] - from[0] + 4, to[1] - from[1] + 4, to[2] - from[2] + 4};
  extend(out, count[0] <= 4   ? range_of<1>(first, k_side, count, voxel_, band_)
              : count[0] <= 8 ? range_of<2>(first, k_side, count, voxel_, band_)
                              : range_of<3>(first, k_side, count, voxel_, band_));
}

GridValue<Interval> DistanceGrid::at(const Point3<Interval>& p) const {
  const std::array<Interval, 3> in{p.x, p.y, p.z};
  GridValue<Interval> out = k_nothing;
  Place from, to;
  bool is_within = true;
  size_t voxels = 1;
  const GridValue<Interval> outside{band_, {Interval{0.0}, Interval{0.0}, Interval{0.0}}};
  for (int i = 0; i < 3; ++i) {
    const auto axis = size_t(i);
    if (!(in[axis].lo <= box_.upper[i] && in[axis].hi >= box_.lower[i])) return outside;
    is_within = is_within && in[axis].lo >= box_.lower[i] && in[axis].hi <= box_.upper[i];
    const int last = count_[axis] * k_cells - 1;
    const Interval u = (intersect(in[axis], Interval{box_.lower[i], box_.upper[i]}) - Interval{box_.lower[i]}) * (1 / voxel_);
    from[axis] = std::clamp(static_cast<int>(u.lo), 0, last), to[axis] = std::clamp(static_cast<int>(u.hi), 0, last);
    voxels *= size_t(to[axis] - from[axis] + 1);
  }
  if (!is_within) extend(out, outside);
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
          extend_by_voxels(brick, first, last, out);
      }
  if (is_within && voxels <= k_few_voxels && out.value.lo < out.value.hi) out.value = intersect(out.value, mean_value(p, out.slopes));
  return out;
}

/// From the centre of a box, along its slopes.
Interval DistanceGrid::mean_value(const Point3<Interval>& box, const std::array<Interval, 3>& slopes) const {
  const std::array<Interval, 3> in{box.x, box.y, box.z};
  double away = k_rounding * band_;
  for (size_t i = 0; i < 3; ++i) away += 0.5 * in[i].width() * slopes[i].magnitude();
  const auto middle = [](const Interval& i) { return 0.5 * (i.lo + i.hi); };
  const double value = at(Point3<double>{middle(box.x), middle(box.y), middle(box.z)}).value;
  return {value - away, value + away};
}

} // namespace kelpie
