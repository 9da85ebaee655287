#include "renderer/cells/tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "renderer/cells/solid_parts.h"
#include "renderer/cells/tree_bases.h"
#include "renderer/cells/widening.h"
#include "renderer/program/evaluate.h"

namespace kelpie {

namespace {

using LeafNumbers = std::array<float, k_leaf_rows>;

/// Below this exponent a hyper-blend rises too steeply from 0 for float.
constexpr double k_least_exponent = 0.2;
/// Steeper, the place of the nearest ball would drown in rounding; the distance hardly feels it.
constexpr double k_steepest = 1e5;

/// What an operator is in a tree, if it can be in one.
template <class Kind>
std::optional<Join> join_of(const Kind& kind, Demand demand) {
  using M = SampledMode;
  if constexpr (std::is_same_v<Kind, Blend<M>>) return Join::sum;
  if constexpr (std::is_same_v<Kind, Union<M>>) return is_smooth(kind.formula, demand) ? Join::r_union : Join::maximum;
  if constexpr (std::is_same_v<Kind, Intersection<M>>) return is_smooth(kind.formula, demand) ? Join::r_intersection : Join::minimum;
  if constexpr (std::is_same_v<Kind, Difference<M>>) return is_smooth(kind.formula, demand) ? Join::r_difference : Join::difference;
  if constexpr (std::is_same_v<Kind, HyperBlend<M>>) return Join::hyper_blend;
  if constexpr (std::is_same_v<Kind, LocalBlend<M>>) return Join::local_blend;
  return {};
}

/// Of the potential without its sign: where 15 b q^2 + (6 a - 12 b) q - 4 a is largest in [0, 1], or 1 if that is concave nowhere.
float crest(double a, double b) {
  const bool is_concave = a + b > 0 ? b < 0 : b > 0;
  return is_concave ? static_cast<float>(std::clamp(0.4 - 0.2 * a / b, 0.0, 1.0)) : 1;
}

class TreeMaker {
public:
  /// Of elements as they are in the program, or as wide as `widening` says.
  TreeMaker(const FieldProgram& program, const CodeView& code, const Box3& cell, const Vec3& centre, const Widening* widening, Tree& out)
      : program_(program), code_(code), cell_(cell), centre_(centre), widening_(widening), out_(out), bases_(program, cell, centre, out),
        leaves_(room()) {
    out_.clear(), leaves_.clear();
  }

  /// False if the code is no tree.
  bool run() {
    if (!emit(static_cast<uint32_t>(code_.steps.size() - 1), 0, false)) return false;
    const size_t count = leaves_.size(), padded = std::max<size_t>(1, (count + k_leaf_group - 1) / k_leaf_group) * k_leaf_group;
    out_.leaf_count = static_cast<uint32_t>(padded);
    out_.leaves.resize(padded * k_leaf_rows, 0.f);
    for (size_t i = 0; i < padded; ++i) {
      for (size_t r = 0; i < count && r < k_leaf_rows; ++r) out_.leaves[r * padded + i] = leaves_[i][r];
      // What pads: a ball of radius -2 is at least 2 away.
      if (i >= count) out_.leaves[leaf_r * padded + i] = -2, out_.leaves[leaf_k * padded + i] = 1;
    }
    return true;
  }

private:
  static std::vector<LeafNumbers>& room() {
    thread_local std::vector<LeafNumbers> leaves;
    return leaves;
  }

  std::optional<Join> join_of_step(const Instruction& step) const {
    return std::visit([&](const auto& kind) { return join_of(kind, step.demand); }, program_.field.nodes[step.node]);
  }
  std::span<const uint32_t> operands(const Instruction& step) const { return code_.operands.subspan(step.first, step.count); }

  /// Emits a step whose value comes to lie at `depth` of the stack.
  bool emit(uint32_t position, size_t depth, bool is_subtracted) {
    if (depth >= k_tree_depth) return false;
    const Instruction& step = code_.steps[position];
    if (is_solid(step)) return emit_solid(step, is_subtracted);
    const std::optional<Join> join = step.kind == Instruction::Kind::combine ? join_of_step(step) : Join::sum;
    if (!join || (widening_ && step.kind == Instruction::Kind::combine && !widening_->stands(step))) return false;
    if (*join == Join::sum) return emit_sum(position, depth, is_subtracted);
    if (*join == Join::local_blend) return emit_local_blend(step, depth, is_subtracted);
    if (is_clamped(*join) && step.count == 1) return false; // the part above 0 of a lone operand
    if (exponent_of(step, *join) < k_least_exponent) return false;
    // Joined two by two, so that the stack stays low however many there are.
    uint32_t count = 0;
    const size_t first = out_.steps.size();
    for (const uint32_t operand : operands(step)) {
      const bool flips = subtracts(*join) && count > 0;
      if (!emit(operand, depth + (count > 0), is_subtracted != flips)) return false;
      if (count++ > 0) add_join(step, *join, 2, is_subtracted);
    }
    // Below 1 it rises from 0 infinitely fast, and in float R-functions are not quite 0 where they should be.
    const auto joins_by_r_function = [](const TreeStep& s) { return s.kind == TreeStep::Kind::join && is_r_function(s.join); };
    return exponent_of(step, *join) >= 1 || std::none_of(out_.steps.begin() + std::ptrdiff_t(first), out_.steps.end(), joins_by_r_function);
  }

  float exponent_of(const Instruction& step, Join join) const {
    return join == Join::hyper_blend ? std::get<HyperBlend<SampledMode>>(program_.field.nodes[step.node]).n : 1;
  }

  void add_operand(TreeStep::Kind kind, uint32_t first, uint32_t count, bool is_subtracted) {
    TreeStep& step = out_.steps.emplace_back();
    step.kind = kind, step.is_subtracted = is_subtracted, step.first = first, step.count = count;
  }

  void add_join(const Instruction& step, Join join, uint32_t operands, bool is_subtracted) {
    TreeTraits& traits = out_.traits;
    traits.is_monotone &= is_monotone(join), traits.has_subtraction |= subtracts(join), traits.bends_sharply |= bends(join);
    out_.steps.push_back({TreeStep::Kind::join, is_subtracted, join, step.demand, exponent_of(step, join), step.node, operands});
  }

  /// What a dropped operand leaves in its place.
  bool is_nothing(uint32_t position) const {
    const Instruction& step = code_.steps[position];
    return step.kind == Instruction::Kind::blobs && step.count == 0;
  }

  /// All operands at once: it is not made of pairs. With the region it falls where the children that are not the largest
  /// are negative.
  bool emit_local_blend(const Instruction& step, size_t depth, bool is_subtracted) {
    const std::span<const uint32_t> all = operands(step);
    uint32_t count = 0;
    bool has_nothing = false;
    for (size_t i = 0; i < all.size(); ++i) {
      const bool is_region = i + 1 == all.size();
      if (!is_region && is_nothing(all[i]) && std::exchange(has_nothing, true)) continue; // one constant 0 stands for all
      if (!emit(all[i], depth + count++, is_subtracted)) return false;
    }
    add_join(step, Join::local_blend, count, is_subtracted);
    return true;
  }

  /// All leaves of a sum are one step.
  bool emit_sum(uint32_t position, size_t depth, bool is_subtracted) {
    std::vector<uint32_t> others;
    const auto first = static_cast<uint32_t>(leaves_.size());
    if (!gather(position, others)) return false;
    const auto leaf_count = static_cast<uint32_t>(leaves_.size()) - first;
    uint32_t count = 0;
    if (leaf_count > 0 || others.empty()) add_operand(TreeStep::Kind::leaves, first, leaf_count, is_subtracted), ++count;
    for (const uint32_t other : others) {
      if (!emit(other, depth + (count > 0), is_subtracted)) return false;
      if (count++ > 0) add_join(code_.steps[position], Join::sum, 2, is_subtracted);
    }
    return true;
  }

  /// Adds the terms of a sum: leaves to the leaves, anything else to `others`.
  bool gather(uint32_t position, std::vector<uint32_t>& others) {
    const Instruction& step = code_.steps[position];
    switch (step.kind) {
    case Instruction::Kind::blobs: return add_blobs(step);
    case Instruction::Kind::skeleton:
      if (!is_solid(step)) return add_cone_sphere(step);
      break;
    case Instruction::Kind::combine: break;
    }
    if (is_solid(step) || join_of_step(step) != Join::sum) {
      others.push_back(position);
      return true;
    }
    for (const uint32_t operand : operands(step))
      if (!gather(operand, others)) return false;
    return true;
  }

  bool add_blobs(const Instruction& step) {
    for (const uint32_t i : code_.blobs.subspan(step.first, step.count)) {
      const std::optional<BlobExtent> extent = widening_ ? widening_->of_blob(i, step) : BlobExtent{program_.blob(i)};
      if (!extent) return false;
      const BlobNumbers& blob = extent->numbers;
      const Vec3d at(blob.x, blob.y, blob.z);
      if (program_.has_round_blobs()) {
        if (!add(step.space, {}, {at, at, 0, 0}, blob.k, blob.a, blob.b, extent->nearer)) return false;
        continue;
      }
      const Mat3d to_ball = blob.shape.matrix();
      const double nearer = extent->nearer * lipschitz(to_ball);
      if (!add(step.space, {to_ball, -(to_ball * at)}, {Vec3d(0), Vec3d(0), 0, 0}, 1, blob.a, blob.b, nearer)) return false;
    }
    return true;
  }

  /// Calls visit(kind, solid) for the skeleton of a step; false for a signed distance.
  template <class Visit>
  bool visit_skeleton(const Instruction& step, Visit&& visit) const {
    return std::visit(
        [&](const auto& kind) {
          if constexpr (SolidSkeleton<std::decay_t<decltype(kind)>>) return visit(kind, kind.solid());
          return false;
        },
        program_.field.nodes[step.node]);
  }

  /// Whether a step is a skeleton that is no cone-sphere.
  bool is_solid(const Instruction& step) const {
    return step.kind == Instruction::Kind::skeleton &&
           !visit_skeleton(step, [](const auto&, const auto& solid) { return std::is_same_v<decltype(solid), const ConeSphereSolid&>; });
  }

  template <class Kind>
  std::optional<Extent> extent_of(const Instruction& step, const Kind& kind) const {
    return widening_ ? widening_->of_skeleton(step, kind) : Extent{kind.weight, reach_of(kind)};
  }

  bool add_cone_sphere(const Instruction& step) {
    return visit_skeleton(step, [&](const auto& kind, const auto& solid) {
      if constexpr (std::is_same_v<decltype(solid), const ConeSphereSolid&>) {
        const std::optional<Extent> extent = extent_of(step, kind);
        if (!extent) return false;
        const FalloffPolynomial f = polynomial(kind.falloff);
        return add(step.space, {}, solid, 1 / square(extent->radius), extent->weight * f.a, extent->weight * f.b, extent->nearer);
      }
      return false;
    });
  }

  bool emit_solid(const Instruction& step, bool is_subtracted) {
    TreeBase base;
    Affine local_from_base;
    if (!bases_.find(step.space, base, local_from_base)) return false;
    SolidLeaf leaf{};
    const double infinity = std::numeric_limits<double>::infinity();
    const double reach = glm::length(Vec3d(glm::max(cell_.upper - centre_, centre_ - cell_.lower))); // of the cell
    const SolidPlace place{local_from_base(base.centre), local_from_base.linear,
                           base.slot == 0 ? reach * lipschitz(local_from_base.linear) : infinity};
    double nearer = 0;
    const bool is_known = std::visit(
        [&](const auto& kind) {
          using K = std::decay_t<decltype(kind)>;
          if constexpr (SolidSkeleton<K> || SignedDistance<K>) {
            const std::optional<Extent> extent = extent_of(step, kind);
            if (!extent) return false;
            nearer = extent->nearer;
            if constexpr (SolidSkeleton<K>) {
              leaf.potential = bump(extent->weight, kind.falloff, extent->radius);
              return add_solid(step.node, kind.solid(), place, leaf);
            } else {
              return add_distance(kind, place, leaf);
            }
          }
          return false;
        },
        program_.field.nodes[step.node]);
    if (!is_known) return false;
    leaf.slot = base.slot, leaf.drift = static_cast<float>(base.turning * lipschitz(local_from_base.linear));
    leaf.bending = static_cast<float>(base.bending * lipschitz(local_from_base.linear));
    leaf.node = step.node, leaf.space = step.space, leaf.growth += static_cast<float>(nearer);
    add_operand(TreeStep::Kind::solid, static_cast<uint32_t>(out_.solids.size()), 1, is_subtracted);
    out_.solids.push_back(leaf);
    return true;
  }

  static SolidPotential bump(double weight, Falloff falloff, double radius) {
    const FalloffPolynomial f = polynomial(falloff);
    SolidPotential p;
    p.a = static_cast<float>(weight * f.a), p.b = static_cast<float>(weight * f.b);
    p.k = static_cast<float>(1 / square(radius)), p.crest = crest(f.a, f.b);
    return p;
  }

  /// As field/distances/distance_field.h says. False for a distance to what is no section.
  template <SignedDistance Kind>
  bool add_distance(const Kind& kind, const SolidPlace& place, SolidLeaf& leaf) {
    switch (kind.falloff) {
    case DistanceFalloff::distance: {
      const double weight = double(kind.weight) * program_.threshold;
      const auto number = [](double x) { return static_cast<float>(x); };
      leaf.potential = {SolidPotential::Form::ramp, number(weight), number(weight / kind.reach())};
      leaf.potential.low = number(std::min(0.0, 2 * weight)), leaf.potential.high = number(std::max(0.0, 2 * weight));
      break;
    }
    case DistanceFalloff::quartic: leaf.potential = bump(kind.weight, Falloff::quartic, kind.reach()); break;
    case DistanceFalloff::cubic: leaf.potential = bump(kind.weight, Falloff::cubic, kind.reach()); break;
    case DistanceFalloff::wyvill: leaf.potential = bump(kind.weight, Falloff::wyvill, kind.reach()); break;
    }
    leaf.is_signed = true;
    if constexpr (requires { section_of(kind); }) {
      add_parts(section_of(kind), place, out_, leaf);
      return true;
    } else if constexpr (std::is_same_v<Kind, SdfPlane<SampledMode>>) {
      add_half_space({Vec3d(kind.point), Vec3d(kind.normal)}, place, out_, leaf);
      return true;
    }
    return false;
  }

  template <class Solid>
  bool add_solid(uint32_t, const Solid& solid, const SolidPlace& place, SolidLeaf& leaf) {
    if constexpr (std::is_same_v<Solid, ConeSphereSolid>)
      return false;
    else {
      add_parts(solid, place, out_, leaf);
      return true;
    }
  }
  bool add_solid(uint32_t, const HullSolid<std::array<Vec3, 4>>& solid, const SolidPlace& place, SolidLeaf& leaf) {
    add_parts(hull_faces(solid.points), place, out_, leaf);
    return true;
  }
  /// Finding the faces of many points takes long: they are those that were found for a hull that stands.
  bool add_solid(uint32_t node, const HullSolid<std::span<const Vec3>>&, const SolidPlace& place, SolidLeaf& leaf) {
    const auto found = program_.hulls.find(node);
    if (found == program_.hulls.end()) return false;
    add_parts(found->second, place, out_, leaf);
    return true;
  }

  /// Adds a solid that lies where a map takes its space.
  bool add(uint32_t space_index, const Affine& solid_from_space, const ConeSphereSolid& solid, double k, double a, double b,
           double nearer) {
    TreeBase base;
    Affine local_from_base;
    if (!bases_.find(space_index, base, local_from_base)) return false;
    local_from_base = solid_from_space * local_from_base;
    const Vec3d axis = solid.to - solid.from;
    const AxisFrame frame{solid.from, axis};
    const ConeSphereProfile profile{glm::length(axis), solid.from_radius, solid.to_radius};
    const Vec3d c = local_from_base(base.centre) - solid.from;
    const Vec3d at{glm::dot(frame.u, c), glm::dot(frame.v, c), glm::dot(frame.e, c) - profile.lift};
    const double slope = std::clamp(profile.slope, -k_steepest, k_steepest);
    const double nearest = std::clamp(at.z - slope * norm(at.x, at.y), 0.0, profile.length);

    LeafNumbers& leaf = leaves_.emplace_back();
    const Mat3d& linear = local_from_base.linear;
    const Vec3d rows[] = {frame.u * linear, frame.v * linear, frame.e * linear};
    const double origin[] = {at.x, at.y, at.z - nearest};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) leaf[4 * i + j] = static_cast<float>(rows[i][j]);
      leaf[4 * i + 3] = static_cast<float>(origin[i]);
    }
    leaf[leaf_s_low] = static_cast<float>(-nearest), leaf[leaf_s_high] = static_cast<float>(profile.length - nearest);
    leaf[leaf_r] = static_cast<float>(profile.first - profile.sine * nearest + nearer), leaf[leaf_sine] = static_cast<float>(profile.sine);
    leaf[leaf_slope] = static_cast<float>(slope);
    leaf[leaf_k] = static_cast<float>(k), leaf[leaf_a] = static_cast<float>(a), leaf[leaf_b] = static_cast<float>(b),
    leaf[leaf_crest] = crest(a, b);
    const double factor = base.slot == 0 ? 0 : lipschitz(linear);
    leaf[leaf_space] = static_cast<float>(base.slot), leaf[leaf_drift] = static_cast<float>(base.turning * factor);
    leaf[leaf_bending] = static_cast<float>(base.bending * factor);
    return true;
  }

  const FieldProgram& program_;
  const CodeView& code_;
  Box3 cell_;
  Vec3 centre_;
  const Widening* widening_;
  Tree& out_;
  TreeBases bases_;
  std::vector<LeafNumbers>& leaves_;
};

} // namespace

std::optional<Tree> make_tree(const FieldProgram& program, const CodeView& code, const Box3& cell, const Vec3& centre) {
  std::optional<Tree> tree(std::in_place);
  if (!make_tree(program, code, cell, centre, *tree)) tree.reset();
  return tree;
}

bool make_tree(const FieldProgram& program, const CodeView& code, const Box3& cell, const Vec3& centre, Tree& out) {
  return TreeMaker(program, code, cell, centre, nullptr, out).run();
}

std::optional<Tree> make_wide_tree(const FieldProgram& slab, const CodeView& code, const Box3& cell, const Vec3& centre) {
  if (slab.threshold != slab.motion->end.threshold) return {};
  const Widening widening(slab, cell);
  std::optional<Tree> tree(std::in_place);
  if (!TreeMaker(at(slab, code, 0.5), code, cell, centre, &widening, *tree).run()) tree.reset();
  return tree;
}

} // namespace kelpie
