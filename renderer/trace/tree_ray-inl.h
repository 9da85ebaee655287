// A ray in the tree of a cell: what the field is along it. Included once a target.
#if defined(KELPIE_TREE_RAY_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_TREE_RAY_INL
#undef KELPIE_TREE_RAY_INL
#else
#define KELPIE_TREE_RAY_INL
#endif

#include "renderer/lanes/solid_leaf-inl.h"
#include "renderer/lanes/tree_joins-inl.h"
#include "renderer/lanes/tree_leaf-inl.h"
#include "renderer/lanes/warp_lanes-inl.h"
#include "renderer/lanes/warped_ray.h"
#include "renderer/trace/root_search-inl.h"
#include "renderer/trace/solve.h"

#ifndef KELPIE_TREE_RAY_ONCE
#define KELPIE_TREE_RAY_ONCE
namespace kelpie {

/// The room that a ray takes: of each leaf…
struct RayRoom {
  std::vector<float> x, y, z, vx, vy, vz; ///< …the ray in its frame where s is 0, and by s: where it is a line
  std::vector<float> peak;                ///< …its potential on the segment, at most; 0: the ray does not meet it
  std::vector<float> solid_peak;          ///< the same of solids
  std::vector<TreeStep> steps;            ///< the tree's, with what the ray meets of their leaves…
  std::vector<uint32_t> met;              ///< …which are these

  void resize(size_t leaves, size_t solids) {
    if (solid_peak.size() < solids) solid_peak.resize(solids);
    if (peak.size() >= leaves) return;
    for (auto* list : {&x, &y, &z, &vx, &vy, &vz, &peak}) list->resize(leaves);
  }
};

} // namespace kelpie
#endif

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

/// Places on the ray count by s, which is 0 in the middle of its segment; the segment is [-half, half].
class TreeRay {
public:
  TreeRay(const FieldProgram& program, const TreeView& tree, const Cell& cell, const RaySegment& ray, RayRoom& room)
      : tree_(tree), curves_(program, tree.spaces), threshold_(static_cast<float>(program.threshold)), segment_(ray),
        middle_(0.5f * (ray.t0 + ray.t1)), half_(0.5f * (ray.t1 - ray.t0)), room_(room) {
    const Vec3d place = Vec3d(ray.origin) + double(middle_) * Vec3d(ray.direction) - Vec3d(cell.centre);
    line_ = {vector(Vec3(place)), vector(ray.direction)};
  }

  float middle() const { return middle_; } ///< t where s is 0
  float half() const { return half_; }
  float threshold() const { return threshold_; }

  /// Puts the ray into the frames of the leaves; false if the field does not reach the threshold on the segment.
  bool set_up() {
    room_.resize(tree_.leaf_count, tree_.solids.leaves.size());
    find_curves(hn::Zero(k_lanes), 1, found_);
    bool any = false;
    for (size_t i = 0; i < tree_.leaf_count; i += k_width) any |= set_up_leaves(i);
    for (size_t i = 0; i < tree_.solids.leaves.size(); ++i) any |= set_up_solid(i);
    if (!any && !segment_.from_inside) return false;
    keep_steps();
    const Bounds field = bounds();
    return segment_.from_inside ? field.low <= threshold_ * (1 + 1e-6f) : field.high >= threshold_ * (1 - 1e-6f);
  }

  /// g = ±(f - T), negative before the surface, at stretches of the ray, a stretch a lane.
  Look look(V s, V h) {
    const Slope f = segment_.from_inside || tree_.traits.wants_low() ? slope<true>(s, h) : slope<false>(s, h);
    const V t = set(threshold_);
    if (!segment_.from_inside) return {hn::Sub(f.value, t), f.high + hn::Neg(t)};
    return {hn::Sub(t, f.value), {hn::Sub(t, f.low.left), hn::Sub(t, f.low.right)}};
  }

private:
  static V3 vector(const Vec3& p) { return {set(p.x), set(p.y), set(p.z)}; }
  static V3 choose(M first, const V3& a, const V3& b) {
    return {hn::IfThenElse(first, a.x, b.x), hn::IfThenElse(first, a.y, b.y), hn::IfThenElse(first, a.z, b.z)};
  }
  Curve at(V s) const { return {at_time(line_.place, line_.velocity, s), line_.velocity}; }

  /// Where the ray is at s in all warped spaces; so many lanes count, and if it is one then all are the same.
  void find_curves(V s, size_t lanes, Curve* curves) const {
    if (curves_.count() == 0) return;
    const auto by_points = [&](size_t i) {
      alignas(64) float places[k_width];
      hn::Store(s, k_lanes, places);
      CurveRows rows;
      for (size_t j = 0; j < lanes; ++j)
        rows.set_lane(j, curves_.find(segment_.origin, segment_.direction, double(middle_) + double(places[j]), i));
      for (size_t j = lanes; j < k_width; ++j)
        for (auto& row : rows.numbers) row[j] = row[0];
      return rows.curve();
    };
    HWY_NAMESPACE::find_curves(tree_, at(s), lanes, by_points, curves);
  }

  Curve in_base(uint32_t slot, V s, const Curve* curves) const { return slot == 0 ? at(s) : curves[slot - 1]; }
  /// The same in the spaces of leaves, a leaf a lane.
  Curve in_bases(V slots, V s) const {
    Curve ray = at(s);
    for (size_t i = 0; i < curves_.count(); ++i) {
      const M is_here = hn::Eq(slots, set(static_cast<float>(i + 1)));
      ray = {choose(is_here, found_[i].place, ray.place), choose(is_here, found_[i].velocity, ray.velocity)};
    }
    return ray;
  }

  /// Leaves i, i + 1, …: their potentials where the segment is nearest to them, or nearer; whether any is not 0.
  HWY_INLINE bool set_up_leaves(size_t i) {
    const auto row = [&](uint32_t r) { return hn::LoadU(k_lanes, tree_.leaves + r * tree_.leaf_count + i); };
    const Curve ray = in_bases(row(leaf_space), hn::Zero(k_lanes));
    const V3 p = place_in_frame(row, ray.place), v = velocity_in_frame(row, ray.velocity);
    hn::StoreU(p.x, k_lanes, &room_.x[i]), hn::StoreU(p.y, k_lanes, &room_.y[i]), hn::StoreU(p.z, k_lanes, &room_.z[i]);
    hn::StoreU(v.x, k_lanes, &room_.vx[i]), hn::StoreU(v.y, k_lanes, &room_.vy[i]), hn::StoreU(v.z, k_lanes, &room_.vz[i]);
    const Leaf leaf = Leaf::each(tree_, i);
    const V h = set(half_), peak = leaf.potential(square_of_positive(nearest_approach(leaf, p, v, drift_within(row, h), h)));
    hn::StoreU(peak, k_lanes, &room_.peak[i]);
    return !none(hn::Ne(peak, hn::Zero(k_lanes)));
  }

  /// The same for a solid.
  HWY_NOINLINE bool set_up_solid(size_t i) {
    const SolidLeaf& leaf = tree_.solids.leaves[i];
    const Curve ray = in_base(leaf.slot, hn::Zero(k_lanes), found_);
    const V nearest = SolidView(tree_.solids, leaf).range(ray.place, ray.velocity, set(half_), false).near.least();
    room_.solid_peak[i] = hn::GetLane(solid_potential(leaf, nearest));
    return room_.solid_peak[i] != 0;
  }

  /// The tree's steps, without the leaves that the ray does not meet.
  void keep_steps() {
    room_.steps.assign(tree_.steps.begin(), tree_.steps.end());
    room_.met.resize(tree_.leaf_count);
    uint32_t count = 0;
    for (TreeStep& step : room_.steps) {
      if (step.kind != TreeStep::Kind::leaves) continue;
      const uint32_t end = step.first + step.count, first = count;
      for (uint32_t i = step.first; i < end; ++i) { // not by a branch, which nobody could foresee
        room_.met[count] = i;
        count += room_.peak[i] != 0;
      }
      step.first = first, step.count = count - first;
    }
  }

  struct Bounds {
    float low, high;
  };

  /// Of the field on the segment, of which by now each leaf's peak is known.
  Bounds bounds() const {
    const auto push = [&](const TreeStep& step, Bounds& out) {
      out = {0, 0};
      const auto add = [&](float peak) { out.low += std::min(peak, 0.f), out.high += std::max(peak, 0.f); };
      if (step.kind == TreeStep::Kind::solid) return add(room_.solid_peak[step.first]);
      for (uint32_t i = step.first; i < step.first + step.count; ++i) add(room_.peak[room_.met[i]]);
    };
    return fold_tree<Bounds>(room_.steps, push, [&](const TreeStep& step, Bounds* operands) { join_bounds(step, operands); });
  }

  void join_bounds(const TreeStep& step, Bounds* operands) const {
    Bounds &a = operands[0], &b = operands[1];
    if (step.join == Join::sum) {
      a = {a.low + b.low, a.high + b.high};
    } else if (step.join == Join::maximum) {
      a = {std::max(a.low, b.low), std::max(a.high, b.high)};
    } else if (step.join == Join::minimum) {
      a = {std::min(a.low, b.low), std::min(a.high, b.high)};
    } else {
      const V zero = hn::Zero(k_lanes);
      const Range r = join_rare_ranges(step, threshold_, [&](uint32_t i) {
        return Range{zero, set(operands[i].low), set(operands[i].high)};
      });
      a = {hn::GetLane(r.low), hn::GetLane(r.high)};
    }
  }

  template <bool WantsLow>
  Slope slope(V s, V h) {
    find_curves(s, k_width, found_);
    const V zero = hn::Zero(k_lanes);
    const auto push = [&](const TreeStep& step, Slope& out) {
      out.value = zero, out.high = {zero, zero};
      if constexpr (WantsLow) out.low = {zero, zero};
      if (step.kind == TreeStep::Kind::solid) return add_solid(step, s, h, out);
      for (uint32_t i = step.first; i < step.first + step.count; ++i) add(room_.met[i], WantsLow && wants_low(step), s, h, out);
    };
    const auto join = [&](const TreeStep& step, Slope* operands) { join_slopes<WantsLow>(step, threshold_, operands); };
    return fold_tree<Slope>(room_.steps, push, join);
  }

  /// Of what lies below a subtraction, or not if the ray comes from inside; or anywhere in a tree that is not monotone.
  bool wants_low(const TreeStep& step) const { return !tree_.traits.is_monotone || step.is_subtracted != segment_.from_inside; }

  void add(uint32_t i, bool wants_low, V s, V h, Slope& sum) const {
    const auto row = [&](uint32_t r) { return set(tree_.leaves[r * tree_.leaf_count + i]); };
    const auto slot = static_cast<size_t>(tree_.row(leaf_space, i));
    V3 place, velocity;
    if (slot > 0) {
      place = place_in_frame(row, found_[slot - 1].place), velocity = velocity_in_frame(row, found_[slot - 1].velocity);
    } else {
      velocity = {set(room_.vx[i]), set(room_.vy[i]), set(room_.vz[i])};
      place = at_time({set(room_.x[i]), set(room_.y[i]), set(room_.z[i])}, velocity, s);
    }
    add_leaf(Leaf::all(tree_, i), tree_.is_positive(i), wants_low, place, velocity, drift_within(row, h), h, sum);
  }

  HWY_NOINLINE void add_solid(const TreeStep& step, V s, V h, Slope& out) const {
    if (room_.solid_peak[step.first] == 0) return;
    const SolidLeaf& leaf = tree_.solids.leaves[step.first];
    const Curve ray = in_base(leaf.slot, s, found_);
    out = solid_slope(tree_.solids, leaf, wants_low(step), ray.place, ray.velocity, h);
  }

  TreeView tree_;
  WarpedRay curves_;
  float threshold_;
  const RaySegment& segment_;
  float middle_, half_;
  Curve line_; ///< the ray where s is 0, from the cell's centre
  RayRoom& room_;
  Curve found_[k_tree_spaces]; ///< where it is in the warped spaces, by the latest question
};

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
