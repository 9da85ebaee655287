// Lanes are blobs, gathered by their numbers.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/program/bound_blobs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "field/potential/falloff_terms.h"
#include "renderer/program/bound_blobs.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<float, k_blob_bound_slack>;
using V = hn::Vec<Lanes>;
using M = hn::Mask<Lanes>;
constexpr Lanes k_lanes{};
constexpr hn::RebindToUnsigned<Lanes> k_number_lanes{};
constexpr hn::RebindToSigned<Lanes> k_index_lanes{};
constexpr size_t k_width = hn::MaxLanes(Lanes{});

inline V set(float v) { return hn::Set(k_lanes, v); }
inline V length2(V x, V y, V z) { return hn::Add(hn::Mul(x, x), hn::Add(hn::Mul(y, y), hn::Mul(z, z))); }

/// The numbers from the i-th on; past the end blob 0, which is for the caller to leave out. (A masked load wants aligned
/// memory, and before AVX it reads all of it.)
inline hn::Vec<hn::RebindToUnsigned<Lanes>> numbers_from(std::span<const uint32_t> list, size_t i) {
  if (i + k_width <= list.size()) return hn::LoadU(k_number_lanes, list.data() + i);
  alignas(64) uint32_t last[k_width] = {};
  std::copy(list.begin() + static_cast<ptrdiff_t>(i), list.end(), last);
  return hn::Load(k_number_lanes, last);
}

/// The slope of q^2 is largest at this u = d^2/R^2, that of q^3 before it, and that of any mixture between.
constexpr float k_square_steepest = static_cast<float>(k_square_slope.u), k_cube_steepest = static_cast<float>(k_cube_slope.u);
constexpr float k_square_most = static_cast<float>(k_square_slope.most), k_cube_most = static_cast<float>(k_cube_slope.most);

/// The potential q^2 (a + b q) of some blobs, q = 1 - k d^2, and |its slope|, with a and b by their absolute values.
struct Potentials {
  V a, b, k;

  V q(V d2) const { return hn::Max(hn::Zero(k_lanes), hn::Sub(set(1), hn::Mul(d2, k))); }
  V at(V d2) const {
    const V s = q(d2);
    return hn::Mul(hn::Mul(s, s), hn::Add(a, hn::Mul(b, s)));
  }
  V slope(V d2) const {
    const V s = q(d2), bend = hn::Add(hn::Mul(set(2), hn::Abs(a)), hn::Mul(hn::Mul(set(3), hn::Abs(b)), s));
    return hn::Mul(hn::Mul(hn::Mul(set(2), hn::Sqrt(d2)), hn::Mul(k, s)), bend);
  }
  /// The slope rises before where either term is steepest, and falls beyond both.
  V steepest_between(V near2, V far2) const {
    const V peak = hn::Mul(hn::Add(hn::Mul(set(k_square_most), hn::Abs(a)), hn::Mul(set(k_cube_most), hn::Abs(b))), hn::Sqrt(k));
    const M rising = hn::Lt(hn::Mul(far2, k), set(k_cube_steepest)), falling = hn::Gt(hn::Mul(near2, k), set(k_square_steepest));
    return hn::IfThenElse(hn::Or(rising, falling), slope(hn::IfThenElse(rising, far2, near2)), peak);
  }
};

Interval BoundBlobSum(const BlobArrays& s, std::span<const uint32_t> list, const Vec3& centre, const Vec3& half, uint32_t* kept,
                      size_t& count) {
  V lo = hn::Zero(k_lanes), hi = lo, at_centre = lo, slope = lo;
  count = 0;
  for (size_t i = 0; i < list.size(); i += k_width) {
    const auto is_one = hn::FirstN(k_number_lanes, list.size() - i);
    const auto numbers = numbers_from(list, i);
    const auto index = hn::BitCast(k_index_lanes, numbers);
    const auto gather = [&](const std::vector<float>& values) { return hn::GatherIndex(k_lanes, values.data(), index); };
    const V dx = hn::Abs(hn::Sub(gather(s.x), set(centre.x))), dy = hn::Abs(hn::Sub(gather(s.y), set(centre.y))),
            dz = hn::Abs(hn::Sub(gather(s.z), set(centre.z)));
    const V zero = hn::Zero(k_lanes), hx = set(half.x), hy = set(half.y), hz = set(half.z);
    const V near2 = length2(hn::Max(hn::Sub(dx, hx), zero), hn::Max(hn::Sub(dy, hy), zero), hn::Max(hn::Sub(dz, hz), zero));
    const V radius = gather(s.radius), radius2 = hn::Mul(radius, radius);
    const M reaches = hn::And(hn::RebindMask(k_lanes, is_one), hn::Lt(near2, radius2));
    if (hn::AllFalse(k_lanes, reaches)) continue;
    count += hn::CompressStore(numbers, hn::RebindMask(k_number_lanes, reaches), k_number_lanes, kept + count);
    const V far2 = length2(hn::Add(dx, hx), hn::Add(dy, hy), hn::Add(dz, hz));
    const Potentials blobs{gather(s.a), gather(s.b), gather(s.k)};
    const V at_near = blobs.at(near2), at_far = blobs.at(far2);
    const auto add = [&](V& sum, V term) { sum = hn::Add(sum, hn::IfThenElseZero(reaches, term)); };
    add(lo, hn::Min(at_near, at_far)), add(hi, hn::Max(at_near, at_far));
    add(at_centre, blobs.at(length2(dx, dy, dz)));
    add(slope, blobs.steepest_between(near2, hn::Min(far2, radius2)));
  }
  const auto total = [](V v) { return hn::GetLane(hn::SumOfLanes(k_lanes, v)); };
  const float reach = total(slope) * glm::length(half), middle = total(at_centre);
  return intersect(Interval{total(lo), total(hi)}, Interval{middle - reach, middle + reach});
}

/// Numbers between two.
struct Between {
  V lo, hi;

  Between(V a, V b) : lo(hn::Min(a, b)), hi(hn::Max(a, b)) {}
  V magnitude() const { return hn::Max(hn::Abs(lo), hn::Abs(hi)); }
};

/// The potentials of blobs whose k, a and b are not one number each.
struct MovingPotentials {
  Between a, b, k;

  /// Over the squared distances [near2, far2].
  Between range(V near2, V far2) const {
    const V zero = hn::Zero(k_lanes), one = set(1);
    const V most = hn::Max(zero, hn::NegMulAdd(near2, k.lo, one)), least = hn::Max(zero, hn::NegMulAdd(far2, k.hi, one));
    const V most2 = hn::Mul(most, most), least2 = hn::Mul(least, least);
    const V lo = hn::Add(a.lo, hn::Min(hn::Mul(b.lo, least), hn::Mul(b.lo, most)));
    const V hi = hn::Add(a.hi, hn::Max(hn::Mul(b.hi, least), hn::Mul(b.hi, most)));
    Between r(zero, zero);
    r.lo = hn::Min(hn::Mul(lo, most2), hn::Mul(lo, least2)), r.hi = hn::Max(hn::Mul(hi, most2), hn::Mul(hi, least2));
    return r;
  }
  V steepest_between(V near2, V far2) const {
    const Potentials most{a.magnitude(), b.magnitude(), k.hi};
    const V peak = hn::Mul(hn::MulAdd(set(k_square_most), most.a, hn::Mul(set(k_cube_most), most.b)), hn::Sqrt(k.hi));
    const M rising = hn::Lt(hn::Mul(far2, k.hi), set(k_cube_steepest)), falling = hn::Gt(hn::Mul(near2, k.lo), set(k_square_steepest));
    const V d2 = hn::IfThenElse(rising, far2, near2), q = hn::Max(hn::Zero(k_lanes), hn::NegMulAdd(d2, k.lo, set(1)));
    const V bend = hn::MulAdd(set(2), most.a, hn::Mul(hn::Mul(set(3), most.b), q));
    const V slope = hn::Mul(hn::Mul(hn::Mul(set(2), hn::Sqrt(d2)), hn::Mul(k.hi, q)), bend);
    return hn::IfThenElse(hn::Or(rising, falling), slope, peak);
  }
};

/// As above, from the middle of each blob's way, in a box that is wider by half of it. Unless they change only the centres
/// differ, which takes half as long.
template <bool k_change>
Interval bound_moving(const BlobArrays& s, const BlobArrays& e, std::span<const uint32_t> list, const Vec3& centre, const Vec3& half,
                      uint32_t* kept, size_t& count) {
  V lo = hn::Zero(k_lanes), hi = lo, mean_lo = lo, mean_hi = lo;
  count = 0;
  for (size_t i = 0; i < list.size(); i += k_width) {
    const auto is_one = hn::FirstN(k_number_lanes, list.size() - i);
    const auto numbers = numbers_from(list, i);
    const auto index = hn::BitCast(k_index_lanes, numbers);
    const auto start = [&](std::vector<float> BlobArrays::*m) { return hn::GatherIndex(k_lanes, (s.*m).data(), index); };
    const auto between = [&](std::vector<float> BlobArrays::*m) {
      return Between(start(m), hn::GatherIndex(k_lanes, (e.*m).data(), index));
    };
    const V zero = hn::Zero(k_lanes), one_half = set(0.5f), wider = set(0.5f * (1 + 1e-5f));
    const auto off = [&](const Between& x, float c) { return hn::Abs(hn::Sub(hn::Mul(one_half, hn::Add(x.lo, x.hi)), set(c))); };
    const auto reach = [&](const Between& x, float h) { return hn::MulAdd(wider, hn::Sub(x.hi, x.lo), set(h)); };
    const Between x = between(&BlobArrays::x), y = between(&BlobArrays::y), z = between(&BlobArrays::z);
    const V dx = off(x, centre.x), dy = off(y, centre.y), dz = off(z, centre.z);
    const V hx = reach(x, half.x), hy = reach(y, half.y), hz = reach(z, half.z);
    const V near2 = length2(hn::Max(hn::Sub(dx, hx), zero), hn::Max(hn::Sub(dy, hy), zero), hn::Max(hn::Sub(dz, hz), zero));
    const V radius = k_change ? between(&BlobArrays::radius).hi : start(&BlobArrays::radius), radius2 = hn::Mul(radius, radius);
    const M reaches = hn::And(hn::RebindMask(k_lanes, is_one), hn::Lt(near2, radius2));
    if (hn::AllFalse(k_lanes, reaches)) continue;
    count += hn::CompressStore(numbers, hn::RebindMask(k_number_lanes, reaches), k_number_lanes, kept + count);
    const V far2 = length2(hn::Add(dx, hx), hn::Add(dy, hy), hn::Add(dz, hz)), centre2 = length2(dx, dy, dz);
    const V steepest_to2 = hn::Min(far2, radius2), way = hn::Sqrt(length2(hx, hy, hz));
    const auto add = [&](V& sum, V term) { sum = hn::Add(sum, hn::IfThenElseZero(reaches, term)); };
    const auto add_ranges = [&](const Between& range, const Between& middle, V steepest) {
      const V most_change = hn::Mul(steepest, way);
      add(lo, range.lo), add(hi, range.hi);
      add(mean_lo, hn::Sub(middle.lo, most_change)), add(mean_hi, hn::Add(middle.hi, most_change));
    };
    if constexpr (k_change) {
      const MovingPotentials blobs{between(&BlobArrays::a), between(&BlobArrays::b), between(&BlobArrays::k)};
      add_ranges(blobs.range(near2, far2), blobs.range(centre2, centre2), blobs.steepest_between(near2, steepest_to2));
    } else {
      const Potentials blobs{start(&BlobArrays::a), start(&BlobArrays::b), start(&BlobArrays::k)};
      const V middle = blobs.at(centre2);
      add_ranges({blobs.at(near2), blobs.at(far2)}, {middle, middle}, blobs.steepest_between(near2, steepest_to2));
    }
  }
  const auto total = [](V v) { return hn::GetLane(hn::SumOfLanes(k_lanes, v)); };
  return intersect(Interval{total(lo), total(hi)}, Interval{total(mean_lo), total(mean_hi)});
}

/// A symmetric matrix in each lane.
struct Shape {
  V xx, yy, zz, xy, xz, yz;

  template <class Of>
  static Shape of(Of&& number) {
    return {number(&BlobShapes::xx), number(&BlobShapes::yy), number(&BlobShapes::zz),
            number(&BlobShapes::xy), number(&BlobShapes::xz), number(&BlobShapes::yz)};
  }
  struct Vector {
    V x, y, z;
  };
  Vector operator()(const Vector& d) const {
    const auto row = [&](V a, V b, V c) { return hn::MulAdd(a, d.x, hn::MulAdd(b, d.y, hn::Mul(c, d.z))); };
    return {row(xx, xy, xz), row(xy, yy, yz), row(xz, yz, zz)};
  }
  Shape magnitude() const { return {hn::Abs(xx), hn::Abs(yy), hn::Abs(zz), hn::Abs(xy), hn::Abs(xz), hn::Abs(yz)}; }
};

/// The same of ellipsoids, where their matrices take the box: each is a ball of radius 1 there, and the box within a box around its image.
/// Of what moves the matrix and the place are within half of their changes from those in the middle.
template <bool k_moves>
Interval bound_ellipsoids(const BlobArrays& s, const BlobArrays& e, std::span<const uint32_t> list, const Vec3& centre, const Vec3& half,
                          uint32_t* kept, size_t& count) {
  constexpr float k_rounding = 4e-7f; // of places that are far in radii
  const V zero = hn::Zero(k_lanes), one = set(1), one_half = set(0.5f), wider = set(0.5f * (1 + 1e-5f));
  V lo = zero, hi = zero, mean_lo = zero, mean_hi = zero;
  count = 0;
  for (size_t i = 0; i < list.size(); i += k_width) {
    const auto is_one = hn::FirstN(k_number_lanes, list.size() - i);
    const auto numbers = numbers_from(list, i);
    const auto index = hn::BitCast(k_index_lanes, numbers);
    const auto between = [&](const std::vector<float>& a, const std::vector<float>& b) {
      const V start = hn::GatherIndex(k_lanes, a.data(), index);
      if constexpr (k_moves) return Between(start, hn::GatherIndex(k_lanes, b.data(), index));
      return Between(start, start);
    };
    const auto middle_of = [&](const Between& x) { return k_moves ? hn::Mul(one_half, hn::Add(x.lo, x.hi)) : x.lo; };
    const auto spread_of = [&](const Between& x) { return k_moves ? hn::Mul(wider, hn::Sub(x.hi, x.lo)) : zero; };
    const auto shape_of = [&](auto&& number) {
      return Shape::of([&](std::vector<float> BlobShapes::*m) { return number(between(s.shapes.*m, e.shapes.*m)); });
    };
    const Between x = between(s.x, e.x), y = between(s.y, e.y), z = between(s.z, e.z);
    const Shape::Vector d{hn::Sub(middle_of(x), set(centre.x)), hn::Sub(middle_of(y), set(centre.y)), hn::Sub(middle_of(z), set(centre.z))};
    const Shape::Vector far_d{hn::Abs(d.x), hn::Abs(d.y), hn::Abs(d.z)};
    const Shape::Vector h{hn::Add(spread_of(x), set(half.x)), hn::Add(spread_of(y), set(half.y)), hn::Add(spread_of(z), set(half.z))};
    const Shape shape = shape_of(middle_of), sizes = shape.magnitude();
    const Shape::Vector u = shape(d), reach = sizes(h), rounding = sizes(far_d);
    Shape::Vector w{hn::MulAdd(set(k_rounding), rounding.x, reach.x), hn::MulAdd(set(k_rounding), rounding.y, reach.y),
                    hn::MulAdd(set(k_rounding), rounding.z, reach.z)};
    if constexpr (k_moves) {
      const Shape::Vector by_shape = shape_of(spread_of)({hn::Add(far_d.x, h.x), hn::Add(far_d.y, h.y), hn::Add(far_d.z, h.z)});
      w = {hn::Add(w.x, by_shape.x), hn::Add(w.y, by_shape.y), hn::Add(w.z, by_shape.z)};
    }
    const Shape::Vector off{hn::Abs(u.x), hn::Abs(u.y), hn::Abs(u.z)};
    const V near2 = length2(hn::Max(hn::Sub(off.x, w.x), zero), hn::Max(hn::Sub(off.y, w.y), zero), hn::Max(hn::Sub(off.z, w.z), zero));
    const M reaches = hn::And(hn::RebindMask(k_lanes, is_one), hn::Lt(near2, one));
    if (hn::AllFalse(k_lanes, reaches)) continue;
    count += hn::CompressStore(numbers, hn::RebindMask(k_number_lanes, reaches), k_number_lanes, kept + count);
    const V far2 = length2(hn::Add(off.x, w.x), hn::Add(off.y, w.y), hn::Add(off.z, w.z)), centre2 = length2(u.x, u.y, u.z);
    const MovingPotentials blobs{between(s.a, e.a), between(s.b, e.b), Between(one, one)};
    const Between range = blobs.range(near2, far2), middle = blobs.range(centre2, centre2);
    const V most_change = hn::Mul(blobs.steepest_between(near2, hn::Min(far2, one)), hn::Sqrt(length2(w.x, w.y, w.z)));
    const auto add = [&](V& sum, V term) { sum = hn::Add(sum, hn::IfThenElseZero(reaches, term)); };
    add(lo, range.lo), add(hi, range.hi);
    add(mean_lo, hn::Sub(middle.lo, most_change)), add(mean_hi, hn::Add(middle.hi, most_change));
  }
  const auto total = [](V v) { return hn::GetLane(hn::SumOfLanes(k_lanes, v)); };
  return intersect(Interval{total(lo), total(hi)}, Interval{total(mean_lo), total(mean_hi)});
}

Interval BoundEllipsoidSum(const BlobArrays& s, const BlobArrays& e, bool moves, std::span<const uint32_t> list, const Vec3& centre,
                           const Vec3& half, uint32_t* kept, size_t& count) {
  return moves ? bound_ellipsoids<true>(s, e, list, centre, half, kept, count)
               : bound_ellipsoids<false>(s, e, list, centre, half, kept, count);
}

Interval BoundMovingBlobSum(const BlobArrays& s, const BlobArrays& e, bool change, std::span<const uint32_t> list, const Vec3& centre,
                            const Vec3& half, uint32_t* kept, size_t& count) {
  return change ? bound_moving<true>(s, e, list, centre, half, kept, count) : bound_moving<false>(s, e, list, centre, half, kept, count);
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kelpie {

HWY_EXPORT(BoundBlobSum);
HWY_EXPORT(BoundMovingBlobSum);
HWY_EXPORT(BoundEllipsoidSum);

Interval bound_blob_sum(const BlobArrays& blobs, std::span<const uint32_t> list, const Vec3& centre, const Vec3& half, uint32_t* kept,
                        size_t& count) {
  if (!blobs.are_round()) return HWY_DYNAMIC_DISPATCH(BoundEllipsoidSum)(blobs, blobs, false, list, centre, half, kept, count);
  return HWY_DYNAMIC_DISPATCH(BoundBlobSum)(blobs, list, centre, half, kept, count);
}

Interval bound_moving_blob_sum(const BlobArrays& start, const BlobArrays& end, bool change, std::span<const uint32_t> list,
                               const Vec3& centre, const Vec3& half, uint32_t* kept, size_t& count) {
  if (!start.are_round()) return HWY_DYNAMIC_DISPATCH(BoundEllipsoidSum)(start, end, true, list, centre, half, kept, count);
  return HWY_DYNAMIC_DISPATCH(BoundMovingBlobSum)(start, end, change, list, centre, half, kept, count);
}

} // namespace kelpie
#endif
