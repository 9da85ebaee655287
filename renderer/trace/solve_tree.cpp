// The solver for trees, for single rays. Along a ray the distance to a convex solid is convex, so its tangent at
// the middle of a stretch bounds it from below over the stretch, and the larger of its ends from above (solids that
// are not convex: solid_leaf-inl.h). With these every leaf, and by the operators (each monotone in each operand) the field, has a bound
// over a stretch that misses the field by the square of the stretch's length. 16 stretches are bounded at once in SIMD lanes. A stretch
// that the bound does not clear is looked into 16 times finer. Nothing is missed, nothing is guessed.
//
// Where only one ray and one place are asked for, the lanes are the leaves.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/trace/solve_tree.cpp"
#include <hwy/aligned_allocator.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <cmath>

#include "renderer/lanes/solid_leaf-inl.h"
#include "renderer/lanes/tree_joins-inl.h"
#include "renderer/lanes/tree_leaf-inl.h"
#include "renderer/lanes/warp_lanes-inl.h"
#include "renderer/lanes/warped_ray.h"
#include "renderer/trace/bracketed_root.h"
#include "renderer/trace/solve.h"
#include "renderer/trace/tree_values.h"

#ifndef KELPIE_SOLVE_TREE_ONCE
#define KELPIE_SOLVE_TREE_ONCE
namespace kelpie {

/// Numbers of each leaf.
struct TreeRay {
  std::vector<float> x0, y0, z0, x1, y1, z1; ///< a ray in the leaf's frame, (x, y, z)(s) = 0 + 1 s: where it is a line
  std::vector<float> px, py, pz, vx, vy, vz; ///< place and velocity in the leaf's space, by the latest question: where not
  std::vector<float> value;                  ///< by the latest question
  std::vector<char> is_active;               ///< the leaf reaches the segment
  std::vector<float> solid_value;            ///< of each solid, by the latest question
  std::vector<char> is_solid_active;
  std::vector<WarpedRay::Place> places; ///< of each warped space

  void resize(size_t n, size_t solids, size_t spaces) {
    places.resize(spaces), solid_value.resize(solids), is_solid_active.resize(solids);
    if (x0.size() >= n) return;
    for (auto* list : {&x0, &y0, &z0, &x1, &y1, &z1, &px, &py, &pz, &vx, &vy, &vz, &value}) list->resize(n);
    is_active.resize(n);
  }
};

inline constexpr size_t k_stretches = 16;
/// Each level is 16 times finer: finer than any float at the last.
inline constexpr int k_most_levels = 7;

} // namespace kelpie
#endif

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

constexpr size_t k_vectors = k_stretches / k_width;

/// 16 numbers, or ranges.
struct Row {
  V v[k_vectors];
};
struct Ranges {
  Range v[k_vectors];
};

class TreeSolver {
public:
  TreeSolver(const FieldProgram& program, const TreeView& tree, const Cell& cell, const RaySegment& ray, SolverWork& work, TreeRay& scratch)
      : program_(program), tree_(tree), curves_(program, tree.spaces), threshold_(static_cast<float>(program.threshold)),
        sign_(ray.from_inside ? -1.f : 1.f), negligible_(1e-5f * threshold_),
        // Below this width a stretch of ray is a point: far below the offset of secondary rays.
        width_(std::max(1e-4f * cell.epsilon, 2e-7f * std::abs(ray.t1))), segment_(ray), middle_(0.5f * (ray.t0 + ray.t1)),
        place_(Vec3d(ray.origin) + double(middle_) * Vec3d(ray.direction) - Vec3d(cell.centre)), work_(work), ray_(scratch) {}

  bool run(float& t) {
    const float half = 0.5f * (segment_.t1 - segment_.t0);
    if (!set_up(half)) return false;
    float root;
    if (!first(-half, half, 0, root)) return false;
    t = middle_ + root;
    return true;
  }

private:
  /// Puts the ray into the frames of the leaves; false if the field cannot reach the threshold on the segment.
  bool set_up(float half) {
    ray_.resize(tree_.leaf_count, tree_.solids.leaves.size(), curves_.count());
    if (curves_.count() > 0) find_places(0);
    const Vec3& d = segment_.direction;
    const V3 m{set(place_.x), set(place_.y), set(place_.z)}, direction{set(d.x), set(d.y), set(d.z)};
    bool any = false;
    for (size_t i = 0; i < tree_.leaf_count; i += k_width) {
      const auto row = [&](uint32_t r) { return hn::LoadU(k_lanes, tree_.leaves + r * tree_.leaf_count + i); };
      const bool warped = curves_.count() > 0;
      const V3 p = place_in_frame(row, warped ? load(ray_.px, ray_.py, ray_.pz, i) : m);
      const V3 v = velocity_in_frame(row, warped ? load(ray_.vx, ray_.vy, ray_.vz, i) : direction);
      hn::StoreU(p.x, k_lanes, &ray_.x0[i]), hn::StoreU(p.y, k_lanes, &ray_.y0[i]), hn::StoreU(p.z, k_lanes, &ray_.z0[i]);
      hn::StoreU(v.x, k_lanes, &ray_.x1[i]), hn::StoreU(v.y, k_lanes, &ray_.y1[i]), hn::StoreU(v.z, k_lanes, &ray_.z1[i]);
      const Leaf leaf = Leaf::each(tree_, i);
      const V peak = leaf.potential(square_of_positive(nearest_approach(leaf, p, v, drift_within(row, set(half)), set(half))));
      hn::StoreU(peak, k_lanes, &ray_.value[i]);
      const auto reaches = hn::Ne(peak, hn::Zero(k_lanes));
      any |= !hn::AllFalse(k_lanes, reaches);
      uint8_t bits[8] = {};
      hn::StoreMaskBits(k_lanes, reaches, bits);
      for (size_t j = 0; j < k_width; ++j) ray_.is_active[i + j] = bits[j / 8] >> (j % 8) & 1;
    }
    for (size_t i = 0; i < tree_.solids.leaves.size(); ++i) {
      const SolidLeaf& leaf = tree_.solids.leaves[i];
      const WarpedRay::Place at = place_in_base(leaf.slot, 0);
      const V least = SolidView(tree_.solids, leaf).range(lanes_of(at.at), lanes_of(at.velocity), set(half), false).near.least();
      ray_.solid_value[i] = hn::GetLane(solid_potential(leaf, least));
      ray_.is_solid_active[i] = ray_.solid_value[i] != 0;
      any |= ray_.is_solid_active[i] != 0;
    }
    if (!any && sign_ > 0) return false;
    const Range field = bounds_of_segment();
    return sign_ > 0 ? hn::GetLane(field.high) >= threshold_ * (1 - 1e-6f) : hn::GetLane(field.low) <= threshold_ * (1 + 1e-6f);
  }

  /// Bounds of the field on the segment: by now each leaf's value is what it is at most, at least it is 0.
  Range bounds_of_segment() const {
    const V zero = hn::Zero(k_lanes);
    const auto add_step = [&](const TreeStep& step, Range& out) {
      float low = 0, high = 0;
      const auto add = [&](float peak) { low += std::min(peak, 0.f), high += std::max(peak, 0.f); };
      if (step.kind == TreeStep::Kind::solid)
        add(ray_.solid_value[step.first]);
      else
        for (uint32_t i = step.first; i < step.first + step.count; ++i) add(ray_.value[i]);
      out = {zero, set(low), set(high)};
    };
    const auto join = [&](const TreeStep& step, Range* operands) {
      operands[0] = join_ranges(step, threshold_, [&](uint32_t i) -> const Range& { return operands[i]; });
    };
    return fold_tree<Range>(tree_.steps, add_step, join);
  }

  bool wants_high(const TreeStep& step) const { return !tree_.is_monotone || step.is_subtracted == (sign_ < 0); }
  bool wants_low(const TreeStep& step) const { return !tree_.is_monotone || step.is_subtracted != (sign_ < 0); }

  static V3 load(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z, size_t i) {
    return {hn::LoadU(k_lanes, &x[i]), hn::LoadU(k_lanes, &y[i]), hn::LoadU(k_lanes, &z[i])};
  }

  /// Where the ray is at s in the space of each leaf.
  void find_places(float s) const {
    Curve curves[k_tree_spaces];
    find_curves(set(s), 1, curves);
    const auto first = [](const V3& v) { return Vec3(hn::GetLane(v.x), hn::GetLane(v.y), hn::GetLane(v.z)); };
    for (size_t i = 0; i < curves_.count(); ++i) ray_.places[i] = {first(curves[i].place), first(curves[i].velocity)};
    const WarpedRay::Place line{place_ + s * segment_.direction, segment_.direction};
    for (size_t i = 0; i < tree_.leaf_count; ++i) {
      const auto slot = static_cast<size_t>(tree_.row(leaf_space, i));
      const WarpedRay::Place& p = slot == 0 ? line : ray_.places[slot - 1];
      ray_.px[i] = p.at.x, ray_.py[i] = p.at.y, ray_.pz[i] = p.at.z;
      ray_.vx[i] = p.velocity.x, ray_.vy[i] = p.velocity.y, ray_.vz[i] = p.velocity.z;
    }
  }

  /// Where the ray is at each s in all warped spaces; so many of them count.
  void find_curves(V s, size_t lanes, Curve* curves) const {
    const auto by_points = [&](size_t i) {
      alignas(64) float at[k_width];
      hn::Store(s, k_lanes, at);
      CurveRows rows;
      for (size_t j = 0; j < k_width; ++j)
        rows.set_lane(j, curves_.find(segment_.origin, segment_.direction, double(middle_) + double(at[j]), i));
      return rows.curve();
    };
    const V3 direction = lanes_of(segment_.direction);
    HWY_NAMESPACE::find_curves(tree_, {at_time(lanes_of(place_), direction, s), direction}, lanes, by_points, curves);
  }

  static V3 lanes_of(const Vec3& p) { return {set(p.x), set(p.y), set(p.z)}; }

  /// The ray at s in the base of some leaves; for curves, as find_places() has found it.
  WarpedRay::Place place_in_base(uint32_t slot, float s) const {
    return slot == 0 ? WarpedRay::Place{place_ + s * segment_.direction, segment_.direction} : ray_.places[slot - 1];
  }

  /// The field by the latest values of the leaves.
  double join_all() const {
    const auto add_step = [&](const TreeStep& step, double& sum) {
      sum = 0;
      if (step.kind == TreeStep::Kind::solid)
        sum = double(ray_.solid_value[step.first]);
      else
        for (uint32_t i = step.first; i < step.first + step.count; ++i)
          if (ray_.is_active[i]) sum += double(ray_.value[i]);
    };
    const auto join = [&](const TreeStep& step, double* operands) { operands[0] = combine(program_, step, operands); };
    return fold_tree<double>(tree_.steps, add_step, join);
  }

  /// Leaves i, i + 1, … as seen from s; find_places() was asked for s, if there are warps.
  Offset offset_of_leaves(const Leaf& leaf, size_t i, float s) const {
    if (curves_.count() > 0) {
      const auto row = [&](uint32_t r) { return hn::LoadU(k_lanes, tree_.leaves + r * tree_.leaf_count + i); };
      return {leaf, place_in_frame(row, load(ray_.px, ray_.py, ray_.pz, i))};
    }
    const V3 p = load(ray_.x0, ray_.y0, ray_.z0, i), v = load(ray_.x1, ray_.y1, ray_.z1, i);
    const V place = set(s);
    return {leaf, {hn::MulAdd(v.x, place, p.x), hn::MulAdd(v.y, place, p.y), hn::MulAdd(v.z, place, p.z)}};
  }

  /// g = ±(f - T) at one place; negative before the surface.
  float at(float place) const {
    ++work_.evaluations;
    if (curves_.count() > 0) find_places(place);
    for (size_t i = 0; i < tree_.leaf_count; i += k_width) {
      const Leaf leaf = Leaf::each(tree_, i);
      hn::StoreU(leaf.potential(square_of_positive(offset_of_leaves(leaf, i, place).distance())), k_lanes, &ray_.value[i]);
    }
    for (size_t i = 0; i < tree_.solids.leaves.size(); ++i) {
      const SolidLeaf& leaf = tree_.solids.leaves[i];
      if (!ray_.is_solid_active[i]) continue;
      const V distance = SolidView(tree_.solids, leaf).distance(lanes_of(place_in_base(leaf.slot, place).at));
      ray_.solid_value[i] = hn::GetLane(solid_potential(leaf, distance));
    }
    return sign_ * static_cast<float>(join_all() - double(threshold_));
  }

  /// Whether leaves, at distances that change at these rates, have come nearer for a length and make the field rise, or have
  /// not reached: potential(distance) says what they are.
  template <class Potential>
  static bool only_approach(V distance, V rate, V sign, V length, const Potential& potential) {
    const V zero = hn::Zero(k_lanes), nearest = hn::NegMulAdd(hn::Max(rate, zero), length, distance);
    const auto reaches = hn::Ne(potential(nearest), zero);
    const auto approaches = hn::And(hn::Gt(sign, zero), hn::Le(rate, zero));
    return hn::AllFalse(k_lanes, hn::AndNot(approaches, reaches));
  }

  /// Whether g surely rises all the way from `from` to `to`: every leaf comes nearer that makes it rise, and none
  /// reaches that makes it fall. The distances being convex, `to` tells.
  bool is_rising(float from, float to) const {
    if (sign_ < 0 || curves_.count() > 0 || !tree_.is_monotone) return false;
    const V length = set(to - from);
    for (size_t i = 0; i < tree_.leaf_count; i += k_width) {
      const Leaf leaf = Leaf::each(tree_, i);
      const Offset offset = offset_of_leaves(leaf, i, to);
      const V rate = offset.rate(load(ray_.x1, ray_.y1, ray_.z1, i));
      const V sign = hn::LoadU(k_lanes, tree_.leaves + leaf_sign * tree_.leaf_count + i);
      if (!only_approach(offset.distance(), rate, sign, length, [&](V d) { return leaf.potential(square_of_positive(d)); })) return false;
    }
    for (size_t i = 0; i < tree_.solids.leaves.size(); ++i) {
      if (!ray_.is_solid_active[i]) continue;
      const SolidLeaf& leaf = tree_.solids.leaves[i];
      const WarpedRay::Place at = place_in_base(leaf.slot, to);
      V rate;
      const V distance = SolidView(tree_.solids, leaf).distance(lanes_of(at.at), lanes_of(at.velocity), rate);
      if (!only_approach(distance, rate, set(leaf.sign), length, [&](V d) { return solid_potential(leaf, d); })) return false;
    }
    return true;
  }

  /// g in the middle of 16 stretches, and what it is at most within.
  void sample(const Row& places, const Row& halves, float* g, float* most) const {
    work_.evaluations += k_stretches;
    Curve curves[k_vectors][k_tree_spaces];
    for (size_t j = 0; j < k_vectors && curves_.count() > 0; ++j) find_curves(places.v[j], k_width, curves[j]);
    const auto add_step = [&](const TreeStep& step, Ranges& out) {
      if (step.kind == TreeStep::Kind::solid)
        find_solid(step, places, halves, curves, out);
      else
        add_leaves(step, places, halves, curves, out);
    };
    const auto join = [&](const TreeStep& step, Ranges* operands) {
      for (size_t j = 0; j < k_vectors; ++j)
        operands[0].v[j] = join_ranges(step, threshold_, [&](uint32_t i) -> const Range& { return operands[i].v[j]; });
    };
    const Ranges field = fold_tree<Ranges>(tree_.steps, add_step, join);
    const V t = set(threshold_), sign = set(sign_);
    for (size_t j = 0; j < k_vectors; ++j) {
      const Range& f = field.v[j];
      hn::Store(hn::Mul(sign, hn::Sub(f.value, t)), k_lanes, g + j * k_width);
      hn::Store(hn::Mul(sign, hn::Sub(sign_ > 0 ? f.high : f.low, t)), k_lanes, most + j * k_width);
    }
  }

  void add_leaves(const TreeStep& step, const Row& places, const Row& halves, const Curve (*curves)[k_tree_spaces], Ranges& sum) const {
    const V zero = hn::Zero(k_lanes);
    for (Range& range : sum.v) range = {zero, zero, zero};
    for (uint32_t i = step.first; i < step.first + step.count; ++i) {
      if (!ray_.is_active[i]) continue;
      const auto row = [&](uint32_t r) { return set(tree_.leaves[r * tree_.leaf_count + i]); };
      const Leaf leaf = Leaf::all(tree_, i);
      const V3 p{set(ray_.x0[i]), set(ray_.y0[i]), set(ray_.z0[i])}, v{set(ray_.x1[i]), set(ray_.y1[i]), set(ray_.z1[i])};
      const auto slot = static_cast<size_t>(tree_.row(leaf_space, i));
      for (size_t j = 0; j < k_vectors; ++j) {
        const V s = places.v[j];
        const V3 place = slot == 0 ? V3{hn::MulAdd(v.x, s, p.x), hn::MulAdd(v.y, s, p.y), hn::MulAdd(v.z, s, p.z)}
                                   : place_in_frame(row, curves[j][slot - 1].place);
        const V3 velocity = slot == 0 ? v : velocity_in_frame(row, curves[j][slot - 1].velocity);
        add_leaf(leaf, tree_.is_positive(i), wants_low(step), wants_high(step), place, velocity, drift_within(row, halves.v[j]),
                 halves.v[j], sum.v[j]);
      }
    }
  }

  void find_solid(const TreeStep& step, const Row& places, const Row& halves, const Curve (*curves)[k_tree_spaces], Ranges& out) const {
    const SolidLeaf& leaf = tree_.solids.leaves[step.first];
    const V zero = hn::Zero(k_lanes);
    const V3 middle = lanes_of(place_), direction = lanes_of(segment_.direction);
    for (size_t j = 0; j < k_vectors; ++j) {
      if (!ray_.is_solid_active[step.first]) {
        out.v[j] = {zero, zero, zero};
        continue;
      }
      const V3 place = leaf.slot == 0 ? at_time(middle, direction, places.v[j]) : curves[j][leaf.slot - 1].place;
      const V3 velocity = leaf.slot == 0 ? direction : curves[j][leaf.slot - 1].velocity;
      out.v[j] = solid_range(tree_.solids, leaf, wants_low(step), wants_high(step), place, velocity, halves.v[j]);
    }
  }

  /// The first place in [s0, s1] with g >= 0.
  bool first(float s0, float s1, int level, float& root) const {
    alignas(64) static constexpr float k_odd[k_stretches] = {1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31};
    const float half = (s1 - s0) / 32;
    Row places, halves;
    for (size_t j = 0; j < k_vectors; ++j) {
      places.v[j] = hn::MulAdd(hn::Load(k_lanes, k_odd + j * k_width), set(half), set(s0));
      halves.v[j] = set(1.001f * half);
    }
    alignas(64) float g[k_stretches], most[k_stretches];
    sample(places, halves, g, most);
    const bool is_last = level + 1 >= k_most_levels || 2 * half <= width_;
    for (size_t j = 0; j < k_stretches; ++j) {
      if (most[j] < negligible_) continue;
      const float left = s0 + half * float(2 * j), middle = s0 + half * float(2 * j + 1), right = s0 + half * float(2 * j + 2);
      if (is_last) {
        root = left;
        if (g[j] >= 0) return true;
        continue;
      }
      if (g[j] >= 0) {
        const float g_left = at(left);
        root = g_left >= 0 ? left : root_between(left, g_left, middle, g[j]);
        if (g_left < 0) look_before(left, level, root);
        return true;
      }
      const float g_right = at(right);
      if (g_right >= 0) {
        root = root_between(middle, g[j], right, g_right);
        look_before(left, level, root);
        return true;
      }
      if (first(left, right, level + 1, root)) return true;
    }
    return false;
  }

  /// Whether there is a root between `from` and `root`: if so, that is the root. Stretches get shorter towards
  /// the root as the field gets nearer to 0, so that mostly the bound clears all of them.
  void look_before(float from, int level, float& root) const {
    if (is_rising(from, root)) return;
    const float width = root - from;
    alignas(64) static constexpr float k_powers[k_stretches + 1] = {1,        0x1p-1f,  0x1p-2f,  0x1p-3f,  0x1p-4f,  0x1p-5f,
                                                                    0x1p-6f,  0x1p-7f,  0x1p-8f,  0x1p-9f,  0x1p-10f, 0x1p-11f,
                                                                    0x1p-12f, 0x1p-13f, 0x1p-14f, 0x1p-15f, 0x1p-16f};
    Row places, halves;
    for (size_t j = 0; j < k_vectors; ++j) {
      const V power = hn::Load(k_lanes, k_powers + j * k_width);
      places.v[j] = hn::NegMulAdd(power, set(0.75f * width), set(root));
      halves.v[j] = hn::Mul(power, set(0.2501f * width));
    }
    alignas(64) float g[k_stretches], most[k_stretches];
    sample(places, halves, g, most);
    for (size_t j = 0; j < k_stretches; ++j) {
      if (most[j] < negligible_ || k_powers[j] * width <= width_) continue;
      float nearer;
      if (!first(root - k_powers[j] * width, root - k_powers[j + 1] * width, level + 1, nearer)) continue;
      root = nearer;
      return;
    }
  }

  float root_between(float a, float ga, float b, float gb) const {
    return bracketed_root([&](float s) { return at(s); }, a, ga, b, gb, 1e-6f * threshold_);
  }

  const FieldProgram& program_;
  TreeView tree_;
  WarpedRay curves_;
  float threshold_, sign_, negligible_, width_;
  const RaySegment& segment_;
  float middle_; ///< t where s is 0
  Vec3 place_;   ///< there, from the cell's centre
  SolverWork& work_;
  TreeRay& ray_;
};

bool SolveTree(const FieldProgram& program, const TreeView& tree, const Cell& cell, const RaySegment& ray, SolverWork& work, float& t) {
  thread_local TreeRay scratch;
  return TreeSolver(program, tree, cell, ray, work, scratch).run(t);
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kelpie {

HWY_EXPORT(SolveTree);

bool solve_given_tree(const FieldProgram& program, const TreeView& tree, const Cell& cell, const RaySegment& ray, SolverWork& work,
                      float& t) {
  return HWY_DYNAMIC_DISPATCH(SolveTree)(program, tree, cell, ray, work, t);
}

bool solve_tree(const ShapeCells& shape, const Cell& cell, const RaySegment& ray, SolverWork& work, float& t) {
  return solve_given_tree(shape.program, shape.tree(cell), cell, ray, work, t);
}

} // namespace kelpie
#endif
