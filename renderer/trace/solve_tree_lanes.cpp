// The solver for trees, for packets: lanes are rays. Each lane walks along its own segment (s in [-h, h], centred) by
// stretches of its own length (tree_march-inl.h). Over each the field has a line above it (potentials-inl.h), which misses the field by
// the square of the stretch's length.
//
// The lanes evaluate together, and no lane's arithmetic looks at another's.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/trace/solve_tree_lanes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>
#include <cmath>

#include "renderer/lanes/aligned_floats.h"
#include "renderer/lanes/lanes-inl.h"
#include "renderer/lanes/solid_leaf-inl.h"
#include "renderer/lanes/tree_joins-inl.h"
#include "renderer/lanes/tree_leaf-inl.h"
#include "renderer/lanes/warp_lanes-inl.h"
#include "renderer/lanes/warped_ray.h"
#include "renderer/trace/segments-inl.h"
#include "renderer/trace/solve.h"
#include "renderer/trace/tree_march-inl.h"

#ifndef KELPIE_SOLVE_TREE_LANES_ONCE
#define KELPIE_SOLVE_TREE_LANES_ONCE
namespace kelpie {

/// A packet in the frames of the leaves that some lane meets: (x, y, z)(s) = first three + s * last three, a vector
/// each. Of leaves in warped spaces the first alone counts: 0, or far away.
struct LaneTree {
  AlignedFloats frames;
  std::vector<uint32_t> leaves; ///< which they are, `leaf_count` of them
  std::vector<TreeStep> steps;  ///< the tree's, with what is left of their leaves
  AlignedFloats reaches;        ///< of each solid, a vector: 1 where a lane meets it, else 0
  size_t leaf_count = 0, capacity = 0, solid_capacity = 0;

  void begin(size_t n, size_t solids) {
    leaf_count = 0, steps.clear();
    if (capacity < n) frames = aligned_floats(n * 6 * k_packet), leaves.resize(n), capacity = n;
    if (solid_capacity < solids) reaches = aligned_floats(solids * k_packet), solid_capacity = solids;
  }
};

/// After this many evaluations a lane is left to the solver for single rays.
inline constexpr int k_most_tries = 40;

} // namespace kelpie
#endif

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

class TreeLaneSolver {
public:
  TreeLaneSolver(const ShapeCells& shape, const Cell& cell, SolverWork& work, LaneTree& scratch)
      : tree_(shape.tree(cell)), curves_(shape.program, tree_.spaces), threshold_(static_cast<float>(shape.program.threshold)),
        tiny_(cell.epsilon), work_(work), lanes_(scratch) {}

  /// The lanes that hit, in `hit`; those that only the solver for single rays can answer, in `unsure`.
  /// `enough`: where a lane may stop at any point that is inside, up to this t.
  void run(const Vec3& centre, const Segments& segments, V enough, M& hit, M& unsure, V& t) {
    const V3& o = segments.origin;
    const V3& d = segments.direction;
    const V middle = hn::Mul(set(0.5f), hn::Add(segments.t0, segments.t1));
    half_ = hn::Mul(set(0.5f), hn::Sub(segments.t1, segments.t0));
    const V3 m{hn::Sub(hn::MulAdd(middle, d.x, o.x), set(centre.x)), hn::Sub(hn::MulAdd(middle, d.y, o.y), set(centre.y)),
               hn::Sub(hn::MulAdd(middle, d.z, o.z), set(centre.z))};
    live_ = segments.live;
    keep_rays(o, d, middle);
    const V most = set_up(m, d);
    hit = unsure = no_lanes();
    live_ = hn::And(live_, hn::Ge(most, set(threshold_ * (1 - 1e-6f))));
    if (none(live_)) return;
    enough = hn::Sub(enough, middle);
    TreeMarch march(half_, live_, tiny_, 1e-5f * threshold_);
    for (int i = 0; i < k_most_tries && !none(live_); ++i) {
      const TreeMarch::Stretch stretch = march.next();
      const Slope f = evaluate(stretch.middle, stretch.half);
      march.learn(stretch, f.value, f.high, enough);
      live_ = march.live();
    }
    hit = march.hit(), unsure = march.live();
    const V root = march.root();
    if (tree_.traits.bends_sharply) verify(enough, root, hit, unsure);
    t = hn::Max(hn::Add(middle, root), segments.entry);
  }

private:
  /// Lanes whose root is none become unsure. Up to `enough` any place inside was good enough, and so it is where the segment begins.
  void verify(V enough, V root, M& hit, M& unsure) {
    live_ = hn::And(hit, hn::Gt(root, enough));
    if (none(live_)) return;
    const V g = evaluate(root, hn::Zero(k_lanes)).value;
    const V tolerance = set(3e-5f * threshold_);
    const auto is_late = hn::And(hn::Gt(g, tolerance), hn::Gt(root, hn::Neg(half_)));
    const auto is_wrong = hn::And(live_, hn::Or(hn::Lt(g, hn::Neg(tolerance)), is_late));
    hit = hn::AndNot(is_wrong, hit), unsure = hn::Or(unsure, is_wrong);
  }

  /// The rays as numbers, for warps that are computed point by point.
  void keep_rays(const V3& o, const V3& d, V middle) {
    if (curves_.count() == 0) return;
    const V rows[] = {o.x, o.y, o.z, d.x, d.y, d.z, middle};
    for (size_t i = 0; i < 7; ++i) hn::Store(rows[i], k_lanes, rays_[i]);
  }

  /// Where the lanes are at s in the warped spaces.
  void find_curves(V s) const {
    if (curves_.count() == 0) return;
    const auto by_points = [&](size_t c) {
      alignas(64) float at[k_width];
      hn::Store(s, k_lanes, at);
      CurveRows rows;
      for (uint32_t left = bits_of(live_), i = 0; left != 0; left >>= 1, ++i) {
        if (!(left & 1)) continue;
        const Vec3 origin(rays_[0][i], rays_[1][i], rays_[2][i]), direction(rays_[3][i], rays_[4][i], rays_[5][i]);
        rows.set_lane(i, curves_.find(origin, direction, double(rays_[6][i]) + double(at[i]), c));
      }
      return rows.curve();
    };
    HWY_NAMESPACE::find_curves(tree_, {at_time(middle_, direction_, s), direction_}, hn::CountTrue(k_lanes, live_), by_points, found_);
  }

  /// Puts the rays into the frames of the leaves, and leaves out the steps that no lane meets; returns upper bounds of the field
  /// on the segments.
  V set_up(const V3& m, const V3& d) {
    middle_ = m, direction_ = d;
    lanes_.begin(tree_.leaf_count, tree_.solids.leaves.size());
    find_curves(hn::Zero(k_lanes));
    const auto start = [&](const TreeStep& step, Operand& out) {
      const size_t first = lanes_.steps.size();
      lanes_.steps.push_back(step);
      out.first = first;
      step.kind == TreeStep::Kind::solid ? set_up_solid(step, out) : set_up_leaves(step, out);
    };
    const auto join = [&](const TreeStep& step, Operand* operands) {
      operands[0].bounds = join_ranges(step, threshold_, [&](uint32_t i) -> const Range& { return operands[i].bounds; });
      join_steps(step, operands);
    };
    return fold_tree<Operand>(tree_.steps, start, join).bounds.high;
  }

  /// What the steps from `first` on make.
  struct Operand {
    size_t first;
    bool is_nothing, may_be_negative; ///< 0 in all lanes; below 0 in any
    Range bounds;                     ///< of the field on the segments; what it is in their middle is not asked for
  };

  /// Makes operands[0] the joined steps; where one of them is nothing, mostly without a step. What a lane gets is the same, to the last
  /// bit.
  void join_steps(const TreeStep& step, Operand* operands) {
    std::vector<TreeStep>& steps = lanes_.steps;
    Operand& a = operands[0];
    const Operand& b = operands[1];
    const bool may_be_negative = std::any_of(operands, operands + step.count, [](const Operand& o) { return o.may_be_negative; });
    const auto at = [&](size_t i) { return steps.begin() + std::ptrdiff_t(i); };
    const auto be_nothing = [&] { // of any kind, with a step of its own
      steps.erase(at(a.first) + 1, steps.end());
      steps.back() = {}, steps.back().is_subtracted = step.is_subtracted;
      a.is_nothing = true, a.may_be_negative = false;
    };
    switch (step.join) {
    case Join::sum:
    case Join::maximum:
    case Join::r_union:
    case Join::hyper_blend:
      if (step.join != Join::sum && may_be_negative) break;
      if (b.is_nothing) {
        steps.erase(at(b.first), steps.end());
        return;
      }
      if (!a.is_nothing) break;
      steps.erase(at(a.first), at(b.first));
      a.is_nothing = false, a.may_be_negative = b.may_be_negative;
      return;
    case Join::minimum:
    case Join::r_intersection:
      if (!may_be_negative && (a.is_nothing || b.is_nothing)) return be_nothing();
      break;
    case Join::difference:
    case Join::r_difference:
      if (a.is_nothing) return be_nothing();
      break;
    case Join::local_blend: break;
    }
    steps.push_back(step);
    a.is_nothing = false, a.may_be_negative = may_be_negative;
  }

  /// What some leaves are together, and which of them any lane meets.
  void set_up_leaves(const TreeStep& step, Operand& out) {
    const V zero = hn::Zero(k_lanes);
    const size_t first = lanes_.leaf_count;
    V low = zero, high = zero;
    out.may_be_negative = false;
    for (uint32_t i = step.first; i < step.first + step.count; ++i) {
      const auto slot = static_cast<size_t>(tree_.row(leaf_space, i));
      const size_t before = lanes_.leaf_count;
      const V peak = slot == 0 ? set_up_leaf(i, middle_, direction_) : set_up_leaf(i, found_[slot - 1].place, found_[slot - 1].velocity);
      out.may_be_negative |= lanes_.leaf_count > before && !tree_.is_positive(i);
      low = hn::Add(low, hn::Min(peak, zero)), high = hn::Add(high, hn::Max(peak, zero));
    }
    TreeStep& left = lanes_.steps.back();
    left.first = static_cast<uint32_t>(first), left.count = static_cast<uint32_t>(lanes_.leaf_count - first);
    out.is_nothing = left.count == 0;
    out.bounds = {zero, low, high};
  }

  /// The potential at the place of the segment that is nearest to the leaf, or nearer.
  V set_up_leaf(uint32_t i, const V3& m, const V3& d) {
    const auto row = [&](uint32_t r) { return set(tree_.leaves[r * tree_.leaf_count + i]); };
    const V3 p = place_in_frame(row, m), v = velocity_in_frame(row, d);
    const Leaf leaf = Leaf::all(tree_, i);
    const V peak = leaf.potential(square_of_positive(nearest_approach(leaf, p, v, drift_within(row, half_), half_)));
    const auto reaches = hn::And(live_, hn::Ne(peak, hn::Zero(k_lanes)));
    // Where a lane does not meet the leaf, it must not make a difference whether another does: it is far away there.
    const bool is_line = tree_.row(leaf_space, i) == 0;
    const V rows[] = {hn::IfThenElse(reaches, is_line ? p.x : hn::Zero(k_lanes), set(1e15f)), p.y, p.z, v.x, v.y, v.z};
    float* frame = lanes_.frames.get() + 6 * k_width * lanes_.leaf_count;
    hn::Store(rows[0], k_lanes, frame);
    for (size_t r = 1; is_line && r < 6; ++r) hn::Store(rows[r], k_lanes, frame + r * k_width);
    lanes_.leaves[lanes_.leaf_count] = i;
    lanes_.leaf_count += !none(reaches); // not by a branch: nobody can foresee it, and so many leaves are under way at once
    return hn::IfThenElseZero(reaches, peak);
  }

  V3 place_in_base(const SolidLeaf& leaf, V s) const {
    return leaf.slot == 0 ? at_time(middle_, direction_, s) : found_[leaf.slot - 1].place;
  }
  const V3& velocity_in_base(const SolidLeaf& leaf) const { return leaf.slot == 0 ? direction_ : found_[leaf.slot - 1].velocity; }

  /// The same for a solid.
  HWY_NOINLINE void set_up_solid(const TreeStep& step, Operand& out) {
    const SolidLeaf& leaf = tree_.solids.leaves[step.first];
    const V zero = hn::Zero(k_lanes);
    const V3 place = place_in_base(leaf, hn::Zero(k_lanes));
    const V peak = solid_potential(leaf, SolidView(tree_.solids, leaf).range(place, velocity_in_base(leaf), half_, false).near.least());
    const auto reaches = hn::And(live_, hn::Ne(peak, zero));
    hn::Store(hn::IfThenElseZero(reaches, set(1)), k_lanes, lanes_.reaches.get() + step.first * k_width);
    const V met = hn::IfThenElseZero(reaches, peak);
    out.is_nothing = none(reaches), out.may_be_negative = !leaf.potential.is_positive();
    out.bounds = {zero, hn::Min(met, zero), hn::Max(met, zero)};
  }

  /// f - T in the middle of each lane's stretch, and its bounds within.
  Slope evaluate(V s, V h) const { return wants_low_ ? evaluate_as<true>(s, h) : evaluate_as<false>(s, h); }

  template <bool WantsLow>
  Slope evaluate_as(V s, V h) const {
    work_.evaluations += hn::CountTrue(k_lanes, live_);
    find_curves(s);
    const V zero = hn::Zero(k_lanes);
    const auto add_step = [&](const TreeStep& step, Slope& out) {
      out.value = zero, out.high = {zero, zero};
      if constexpr (WantsLow) out.low = {zero, zero};
      if (step.kind == TreeStep::Kind::solid) return add_solid(step, s, h, out);
      for (uint32_t j = step.first; j < step.first + step.count; ++j) add(j, step.is_subtracted, s, h, out);
    };
    const auto join = [&](const TreeStep& step, Slope* operands) { join_slopes<WantsLow>(step, threshold_, operands); };
    Slope f = fold_tree<Slope>(lanes_.steps, add_step, join);
    const V below = set(-threshold_);
    f.value = hn::Add(f.value, below), f.high = f.high + below;
    return f;
  }

  /// A lane that does not meet the solid has 0 of it, whatever the others do.
  HWY_NOINLINE void add_solid(const TreeStep& step, V s, V h, Slope& out) const {
    const auto is_met = hn::Ne(hn::Load(k_lanes, lanes_.reaches.get() + step.first * k_width), hn::Zero(k_lanes));
    if (none(is_met)) return;
    const SolidLeaf& leaf = tree_.solids.leaves[step.first];
    const Slope f = solid_slope(tree_.solids, leaf, wants_low(step.is_subtracted), place_in_base(leaf, s), velocity_in_base(leaf), h);
    const auto met = [&](V x) { return hn::IfThenElseZero(is_met, x); };
    out = {met(f.value), {met(f.high.left), met(f.high.right)}, {met(f.low.left), met(f.low.right)}};
  }

  /// Of leaves that lie below a subtraction, or anywhere in a tree that is not monotone.
  bool wants_low(bool is_subtracted) const { return !tree_.traits.is_monotone || is_subtracted; }

  void add(uint32_t j, bool is_subtracted, V s, V h, Slope& sum) const {
    const uint32_t i = lanes_.leaves[j];
    const float* frame = lanes_.frames.get() + 6 * k_width * j;
    const auto frame_row = [&](size_t r) { return hn::Load(k_lanes, frame + r * k_width); };
    const auto row = [&](uint32_t r) { return set(tree_.leaves[r * tree_.leaf_count + i]); };
    const auto slot = static_cast<size_t>(tree_.row(leaf_space, i));
    V3 place, velocity;
    if (slot > 0) {
      place = place_in_frame(row, found_[slot - 1].place), velocity = velocity_in_frame(row, found_[slot - 1].velocity);
      place.x = hn::Add(place.x, frame_row(0));
    } else {
      const V3 p{frame_row(0), frame_row(1), frame_row(2)};
      velocity = {frame_row(3), frame_row(4), frame_row(5)}, place = at_time(p, velocity, s);
    }
    add_leaf(Leaf::all(tree_, i), tree_.is_positive(i), wants_low(is_subtracted), place, velocity, drift_within(row, h), h, sum);
  }

  TreeView tree_;
  bool wants_low_ = tree_.traits.wants_low();
  WarpedRay curves_;
  float threshold_, tiny_;
  V half_;
  V3 middle_, direction_; ///< where s is 0, from the cell's centre; and by s
  M live_;                ///< lanes without an answer
  SolverWork& work_;
  LaneTree& lanes_;
  alignas(64) float rays_[7][k_width]; ///< origin, direction, t where s is 0
  mutable Curve found_[k_tree_spaces]; ///< by the latest question
};

uint32_t SolveTreeGroup(const ShapeCells& shape, const Cell& cell, const RayLanes& rays, size_t first, SolveCounters& counters, float* t) {
  thread_local LaneTree scratch;
  const Segments segments(rays, first, cell.box);
  if (none(segments.live)) return 0;
  counters.tree_packets.cells += hn::CountTrue(k_lanes, segments.live);
  const V enough = rays.any ? hn::LoadU(k_lanes, rays.t_far + first) : set(-std::numeric_limits<float>::infinity());
  M hit, unsure;
  V at = hn::Zero(k_lanes);
  TreeLaneSolver(shape, cell, counters.tree_packets, scratch).run(cell.centre, segments, enough, hit, unsure, at);
  hn::StoreU(at, k_lanes, t);
  uint32_t hits = bits_of(hit);
  if (!none(unsure)) settle(solve_tree, shape, cell, rays, first, segments, bits_of(unsure), hits, counters.trees, t);
  return hits;
}

uint32_t SolveTreeLanes(const ShapeCells& shape, const Cell& cell, const RayLanes& rays, SolveCounters& counters, float* t) {
  if (rays.count < k_width) return solve_one_by_one(shape, cell, rays, counters, t); // Embree was told to use narrow vectors
  uint32_t hits = 0;
  for (size_t first = 0; first < rays.count; first += k_width)
    hits |= SolveTreeGroup(shape, cell, rays, first, counters, t + first) << first;
  return hits;
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kelpie {

HWY_EXPORT(SolveTreeLanes);

uint32_t solve_tree_lanes(const ShapeCells& shape, const Cell& cell, const RayLanes& rays, SolveCounters& counters, float* t) {
  return HWY_DYNAMIC_DISPATCH(SolveTreeLanes)(shape, cell, rays, counters, t);
}

} // namespace kelpie
#endif
