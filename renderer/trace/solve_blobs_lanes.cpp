// The solver for sums of blobs, for packets: lanes are rays. Each lane marches along its own segment
// (s in [-h, h], centred), with steps that suit its own field: a step is taken if the bound of the curvature
// from below (solve_blobs.cpp) rules out a hidden pair of roots in it, and halved if not; where the sign
// changes, regula falsi follows. s is a length: t times the direction's length, which is 1 but for rounding.
// A blob is q(s) = a - (r s - e)^2 with r^2 = k and a = s_i - k times the squared distance of the ray's line,
// which loses far fewer digits to cancellation than a + b s - k s^2 where blobs are small.
//
// The lanes evaluate together, and no lane's arithmetic looks at another's.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/trace/solve_blobs_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>
#include <cmath>

#include "renderer/lanes/aligned_floats.h"
#include "renderer/trace/blob_lanes-inl.h"
#include "renderer/trace/segments-inl.h"
#include "renderer/trace/solve.h"

#ifndef KELPIE_SOLVE_BLOBS_LANES_ONCE
#define KELPIE_SOLVE_BLOBS_LANES_ONCE
namespace kelpie {

/// The quadratics q(s) = a - (r s - e)^2 of the blobs that some lane meets, with potential q^2 (w + v q): what each lane
/// has of its own (a and e; of ellipsoids r too, and where blobs change over time r, w and v), then what the lanes share.
struct LaneBlobs {
  static constexpr size_t k_most_own = 5;
  AlignedFloats own;
  std::vector<float> r, w, v;
  size_t capacity = 0, count = 0;

  void reserve(size_t n) {
    if (capacity >= n) return;
    own = aligned_floats(n * k_most_own * k_packet);
    for (auto* list : {&r, &w, &v}) list->resize(n);
    capacity = n;
  }
};

/// After this many evaluations a lane is left to the solver for single rays.
inline constexpr int k_most_evaluations = 48;
/// No first try is shorter than this part of a segment.
inline constexpr float k_shortest_step = 1.f / 12;

} // namespace kelpie
#endif

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

template <BlobForm F>
class LaneSolver {
  /// Radii and weights change over time, and lanes have times of their own.
  static constexpr bool k_changing = F.moves && !F.is_pure;
  static constexpr bool k_own_r = k_changing || !F.is_round;
  static constexpr size_t k_own = k_changing ? 5 : k_own_r ? 3 : 2;

public:
  LaneSolver(V threshold, V slab_time, SolverWork& work, std::array<LaneBlobs, 2>& active)
      : threshold_(threshold), negligible_(hn::Mul(set(1e-5f), threshold)), slab_time_(slab_time), work_(work), active_(active) {}

  /// The lanes that hit, in `hit`; those that only the solver for single rays can answer, in `unsure`.
  /// `enough`: where a lane may stop at any point that is inside, up to this t.
  void run(BlobList blobs, const Segments& segments, V enough, M& hit, M& unsure, V& t) {
    const V3& o = segments.origin;
    V3 d = segments.direction;
    const V speed = hn::Sqrt(dot(d, d)), middle = hn::Mul(set(0.5f), hn::Add(segments.t0, segments.t1));
    half_ = hn::Mul(hn::Mul(set(0.5f), hn::Sub(segments.t1, segments.t0)), speed);
    const V3 m{hn::MulAdd(middle, d.x, o.x), hn::MulAdd(middle, d.y, o.y), hn::MulAdd(middle, d.z, o.z)};
    d = {hn::Div(d.x, speed), hn::Div(d.y, speed), hn::Div(d.z, speed)};
    const V most = set_up(blobs, m, d, segments.live);
    hit = unsure = no_lanes();
    live_ = hn::And(segments.live, hn::Ge(most, hn::Mul(threshold_, set(1 - 1e-6f))));
    if (none(live_)) return;
    V root;
    march(hn::Mul(hn::Sub(enough, middle), speed), hit, unsure, root);
    t = hn::Max(hn::Add(middle, hn::Div(root, speed)), segments.entry);
  }

private:
  /// Fills the list of active blobs; returns upper bounds of the field on the segments.
  V set_up(BlobList blobs, const V3& m, const V3& d, M live) {
    for (LaneBlobs& half : active_) half.reserve(blobs.count + 1), half.count = 0;
    const V zero = hn::Zero(k_lanes), minus_half = hn::Neg(half_);
    V curvature = zero, most = zero;
    for (size_t i = 0; i < blobs.count && !blobs.is_padding(i); ++i) {
      const auto standing = [&](BlobRow row) { return blobs.row(row)[i]; };
      // At the lanes' times, if it moves.
      const auto number = [&](BlobRow row) {
        if constexpr (F.moves) return hn::MulAdd(set(blobs.row(F.change_of(row))[i]), slab_time_, set(standing(row)));
        return set(standing(row));
      };
      const V3 c{hn::Sub(number(blob_x), m.x), hn::Sub(number(blob_y), m.y), hn::Sub(number(blob_z), m.z)};
      const V s = set(standing(blob_s));
      const auto on_line = [&] {
        if constexpr (F.is_round) {
          return BlobOnLine::of_ball(s, k_changing ? number(blob_k) : set(standing(blob_k)), c, d);
        } else {
          const auto shape = ShapeLanes::of([&](BlobShapeRow row) {
            const V at_start = set(blobs.row(F.row_of(row))[i]);
            if constexpr (k_changing) return hn::MulAdd(set(blobs.row(F.change_of(row))[i]), slab_time_, at_start);
            return at_start;
          });
          return BlobOnLine::of_ellipsoid(s, shape, c, d);
        }
      };
      const auto [along, k, a] = on_line();
      // q is largest at the place nearest to the centre.
      const V off = hn::Sub(hn::Min(hn::Max(along, minus_half), half_), along);
      const V q = hn::NegMulAdd(k, hn::Mul(off, off), a);
      const auto reaches = hn::And(live, hn::Gt(q, zero));
      const float r = std::sqrt(standing(blob_k)); // not if k_own_r
      const V own_r = k_own_r ? hn::Sqrt(k) : set(r);
      // Where a lane does not meet the blob, it must not make a difference whether another does: q < 0 there.
      LaneBlobs& list = active_[i % 2];
      put(list, hn::IfThenElse(reaches, a, set(-1)), hn::IfThenElseZero(reaches, hn::Mul(own_r, along)), r);
      float* own = list.own.get() + k_own * k_width * list.count;
      if constexpr (k_own_r) hn::Store(own_r, k_lanes, own + 2 * k_width);
      if constexpr (F.is_pure) {
        curvature = hn::Add(curvature, hn::IfThenElseZero(reaches, hn::Mul(s, k)));
        most = hn::Add(most, hn::IfThenElseZero(reaches, hn::Mul(q, q)));
      } else if constexpr (k_changing) {
        const V w = number(blob_a), v = number(blob_b);
        hn::Store(w, k_lanes, own + 3 * k_width), hn::Store(v, k_lanes, own + 4 * k_width);
        curvature = hn::Add(curvature, hn::IfThenElseZero(reaches, hn::Mul(most_bend(w, v), k)));
        const V peak = hn::Mul(hn::Mul(q, q), hn::MulAdd(v, q, w));
        most = hn::Add(most, hn::IfThenElseZero(reaches, hn::Max(peak, zero)));
      } else {
        const float w = standing(blob_a), v = standing(blob_b);
        list.w[list.count] = w, list.v[list.count] = v;
        const float bend = most_bend(k_square_curvature, w) + most_bend(k_cube_curvature, v);
        curvature = hn::Add(curvature, hn::IfThenElseZero(reaches, hn::Mul(set(bend), k)));
        const V peak = hn::Mul(hn::Mul(q, q), hn::MulAdd(set(v), q, set(w)));
        most = hn::Add(most, hn::IfThenElseZero(reaches, hn::Max(peak, zero)));
      }
      list.count += !none(reaches); // as a branch it is often mispredicted: 12 to 20 % of the ray's time
    }
    for (int i : {0, 1}) // so that they may be read in pairs
      for (; active_[i].count < active_[1 - i].count; ++active_[i].count) put(active_[i], set(-1), zero, 0);
    curvature_ = hn::Mul(set(k_wider * (F.is_pure ? most_bend(k_square_curvature, 1.f) : 1.f)), curvature);
    return most;
  }

  /// Writes behind the last blob.
  static void put(LaneBlobs& list, V a, V e, float r) {
    float* own = list.own.get() + k_own * k_width * list.count;
    hn::Store(a, k_lanes, own), hn::Store(e, k_lanes, own + k_width);
    for (size_t i = 2; i < k_own; ++i) hn::Store(hn::Zero(k_lanes), k_lanes, own + i * k_width);
    list.r[list.count] = r, list.w[list.count] = list.v[list.count] = 0;
  }

  static V term(const LaneBlobs& list, size_t i, V s, V f) {
    const float* own = list.own.get() + k_own * k_width * i;
    V r;
    if constexpr (k_own_r)
      r = hn::Load(k_lanes, own + 2 * k_width);
    else
      r = set(list.r[i]);
    const V off = hn::MulSub(r, s, hn::Load(k_lanes, own + k_width));
    const V q = hn::Max(hn::NegMulAdd(off, off, hn::Load(k_lanes, own)), hn::Zero(k_lanes));
    if constexpr (F.is_pure)
      return hn::MulAdd(q, q, f);
    else if constexpr (k_changing)
      return hn::MulAdd(hn::Mul(q, q), hn::MulAdd(hn::Load(k_lanes, own + 4 * k_width), q, hn::Load(k_lanes, own + 3 * k_width)), f);
    else
      return hn::MulAdd(hn::Mul(q, q), hn::MulAdd(set(list.v[i]), q, set(list.w[i])), f);
  }

  /// f - T, each lane at its place.
  V at(V s) const {
    work_.evaluations += hn::CountTrue(k_lanes, live_);
    V even = hn::Neg(threshold_), odd = hn::Zero(k_lanes);
    for (size_t i = 0; i < active_[0].count; ++i) even = term(active_[0], i, s, even), odd = term(active_[1], i, s, odd);
    return hn::Add(even, odd);
  }

  /// How far g, negative here, cannot have come from a hidden pair of roots if it does not change: bound = 0.
  V next_step(V g) const {
    const V step = hn::Sqrt(hn::Div(hn::Mul(set(-8), g), hn::Max(curvature_, set(1e-30f))));
    return hn::Max(step, hn::Mul(set(2 * k_shortest_step), half_));
  }

  /// Where g, below 0 at both ends of a step, may exceed the negligible inside it: see may_hide in solve_blobs.cpp.
  M may_hide(V g0, V g1, V bulge) const {
    const V rise = hn::Sub(g1, g0), quarter = set(0.25f);
    const V inner = hn::MulAdd(quarter, hn::Add(bulge, hn::Div(hn::Mul(rise, rise), bulge)), hn::Mul(set(0.5f), hn::Add(g0, g1)));
    return hn::And(hn::And(hn::Ge(bulge, hn::Mul(set(4), negligible_)), hn::Lt(hn::Abs(rise), bulge)), hn::Ge(inner, negligible_));
  }

  /// C w^2 / 2
  V bulge(V width) const { return hn::Mul(hn::Mul(set(0.5f), curvature_), hn::Mul(width, width)); }

  /// Whether a step from g0 < 0 to g >= 0 is so long that the first of several roots may not be the one that is found.
  M is_too_long(V g0, V g, V width) const {
    const V arch = bulge(hn::Mul(width, hn::Div(g0, hn::Sub(g0, g)))); // up to where the chord is 0
    return hn::And(hn::Ge(arch, hn::Mul(set(4), negligible_)), hn::Gt(arch, hn::Mul(set(-0.5f), g0)));
  }

  void march(V enough, M& hit, M& unsure, V& root) {
    const V zero = hn::Zero(k_lanes), one_half = set(0.5f);
    V from = hn::Neg(half_), g_from = at(from); // up to here there is no root
    V step = next_step(g_from);
    V lo = from, g_lo = g_from, hi = half_, g_hi = zero; // the bracket, with values weighted by the Illinois rule
    M bracketed = no_lanes(), was_below = bracketed, was_above = bracketed;
    hit = hn::AndNot(hn::Lt(g_from, zero), live_), root = from;
    live_ = hn::AndNot(hit, live_);
    for (int i = 1; i < k_most_evaluations && !none(live_); ++i) {
      const V secant = hn::Sub(lo, hn::Div(hn::Mul(hn::Sub(hi, lo), g_lo), hn::Sub(g_hi, g_lo)));
      const V x = hn::IfThenElse(bracketed, secant, hn::Min(hn::Add(from, step), half_));
      const V g = at(x), width = hn::Sub(x, from);
      const auto below = hn::Lt(g, zero), marching = hn::AndNot(bracketed, live_);

      const auto inside = hn::And(hn::Gt(x, lo), hn::Lt(x, hi));
      const auto close = hn::Le(hn::Abs(g), hn::Mul(set(1e-6f), threshold_));
      const auto found = hn::AndNot(hn::AndNot(close, inside), hn::And(bracketed, live_));
      root = hn::IfThenElse(found, hn::Min(hn::Max(x, lo), hi), root);

      const auto is_clear = hn::AndNot(may_hide(g_from, g, bulge(width)), below);
      const auto passes = hn::And(live_, is_clear);
      const auto crosses = hn::AndNot(hn::Or(below, is_too_long(g_from, g, width)), marching);
      const auto retries = hn::AndNot(hn::Or(passes, crosses), marching);
      const auto ends = hn::And(hn::And(marching, passes), hn::Ge(x, half_));
      const auto will_do = hn::And(hn::AndNot(below, marching), hn::Le(x, enough));
      root = hn::IfThenElse(will_do, x, root);

      const auto goes_up = hn::And(bracketed, below), goes_down = hn::AndNot(below, bracketed);
      g_hi = hn::IfThenElse(hn::And(goes_up, was_below), hn::Mul(one_half, g_hi), g_hi);
      g_lo = hn::IfThenElse(hn::And(goes_down, was_above), hn::Mul(one_half, g_lo), g_lo);
      was_below = goes_up, was_above = goes_down;
      const auto lower = hn::Or(hn::And(marching, passes), goes_up), upper = hn::Or(crosses, goes_down);
      lo = hn::IfThenElse(lower, x, lo), g_lo = hn::IfThenElse(lower, g, g_lo);
      hi = hn::IfThenElse(upper, x, hi), g_hi = hn::IfThenElse(upper, g, g_hi);
      from = hn::IfThenElse(passes, x, from), g_from = hn::IfThenElse(passes, g, g_from);
      step = hn::IfThenElse(retries, hn::Mul(one_half, width), hn::Min(next_step(g), hn::Add(width, width)));
      bracketed = hn::Or(bracketed, crosses);

      hit = hn::Or(hit, hn::Or(found, will_do));
      live_ = hn::AndNot(hn::Or(hn::Or(found, will_do), ends), live_);
    }
    // Two more roots may hide before the root, unless the bound is negative up to it.
    const V arch = bulge(hn::Sub(root, from));
    const auto hidden = hn::And(hn::Gt(arch, hn::Neg(g_from)), hn::Ge(arch, hn::Mul(set(4), negligible_)));
    unsure = hn::Or(live_, hn::And(hn::And(hit, bracketed), hn::AndNot(hn::Le(root, enough), hidden)));
  }

  V threshold_, negligible_, slab_time_;
  V half_;
  V curvature_; ///< C: f'' >= -C on the segment
  M live_;      ///< lanes without an answer
  SolverWork& work_;
  /// Blobs of even and of odd number, two sums, or the additions would wait for each other. (By number, not by
  /// place in the list: that depends on the other lanes, and with it would the rounding.)
  std::array<LaneBlobs, 2>& active_;
};

template <BlobForm F>
uint32_t SolveGroup(const ShapeCells& shape, const Cell& cell, const RayLanes& rays, size_t first, SolveCounters& counters, float* t) {
  thread_local std::array<LaneBlobs, 2> active;
  const Segments segments(rays, first, cell.box);
  if (none(segments.live)) return 0;
  counters.blob_packets.cells += hn::CountTrue(k_lanes, segments.live);
  const V enough = rays.any ? hn::LoadU(k_lanes, rays.t_far + first) : set(-std::numeric_limits<float>::infinity());
  M hit, unsure;
  V at = hn::Zero(k_lanes);
  V slab_time = hn::Zero(k_lanes), threshold = set(static_cast<float>(shape.program.threshold));
  if (shape.program.motion) {
    const V since = hn::Mul(hn::Sub(segments.time, set(shape.slab_start)), set(shape.slabs));
    slab_time = hn::Min(hn::Max(since, hn::Zero(k_lanes)), set(1));
    const double change = shape.program.motion->end.threshold - shape.program.threshold;
    if (change != 0) threshold = hn::MulAdd(set(static_cast<float>(change)), slab_time, threshold);
  }
  LaneSolver<F>(threshold, slab_time, counters.blob_packets, active).run(cell.blobs, segments, enough, hit, unsure, at);
  hn::StoreU(at, k_lanes, t);
  uint32_t hits = bits_of(hit);
  if (!none(unsure)) settle(solve_blobs, shape, cell, rays, first, segments, bits_of(unsure), hits, counters.blobs, t);
  return hits;
}

uint32_t SolveBlobsLanes(const ShapeCells& shape, const Cell& cell, const RayLanes& rays, SolveCounters& counters, float* t) {
  if (rays.count < k_width) return solve_one_by_one(shape, cell, rays, counters, t); // Embree was told to use narrow vectors
  return for_form(cell.blobs.form, [&]<BlobForm F>() {
    uint32_t hits = 0;
    for (size_t first = 0; first < rays.count; first += k_width)
      hits |= SolveGroup<F>(shape, cell, rays, first, counters, t + first) << first;
    return hits;
  });
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kelpie {

HWY_EXPORT(SolveBlobsLanes);

uint32_t solve_blobs_lanes(const ShapeCells& shape, const Cell& cell, const RayLanes& rays, SolveCounters& counters, float* t) {
  return HWY_DYNAMIC_DISPATCH(SolveBlobsLanes)(shape, cell, rays, counters, t);
}

} // namespace kelpie
#endif
