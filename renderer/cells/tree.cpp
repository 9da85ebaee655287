#include "renderer/cells/tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "renderer/cells/solid_parts.h"
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

/// g++ 12 makes nothing of Vec3d(Vec3(v)): it folds the conversions of two lanes at once, and drops the rounding.
Vec3d rounded_to_float(const Vec3d& v) {
  Vec3d r;
  for (int i = 0; i < 3; ++i) {
    const volatile float rounded = static_cast<float>(v[i]);
    r[i] = rounded;
  }
  return r;
}

class TreeMaker {
public:
  TreeMaker(const FieldProgram& program, const CodeView& code, const Box3& cell) : program_(program), code_(code), cell_(cell) {}

  /// False if the code is no tree.
  std::optional<Tree> run() {
    if (!emit(static_cast<uint32_t>(code_.steps.size() - 1), 0, false)) return {};
    const size_t count = leaves_.size(), padded = std::max<size_t>(1, (count + k_leaf_group - 1) / k_leaf_group) * k_leaf_group;
    out_.leaf_count = static_cast<uint32_t>(padded);
    out_.leaves.resize(padded * k_leaf_rows, 0.f);
    for (size_t i = 0; i < padded; ++i) {
      for (size_t r = 0; i < count && r < k_leaf_rows; ++r) out_.leaves[r * padded + i] = leaves_[i][r];
      // What pads: a ball of radius -2 is at least 2 away.
      if (i >= count) out_.leaves[leaf_r * padded + i] = -2, out_.leaves[leaf_k * padded + i] = 1;
    }
    return std::move(out_);
  }

private:
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
    if (!join) return false;
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
      const BlobNumbers blob = program_.blob(i);
      const Vec3d at(blob.x, blob.y, blob.z);
      if (!add(step.space, {at, at, 0, 0}, blob.k, blob.a, blob.b)) return false;
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

  bool add_cone_sphere(const Instruction& step) {
    return visit_skeleton(step, [&](const auto& kind, const auto& solid) {
      if constexpr (std::is_same_v<decltype(solid), const ConeSphereSolid&>) {
        const FalloffPolynomial f = polynomial(kind.falloff);
        const double weight = kind.weight;
        return add(step.space, solid, 1 / square(double(kind.radius)), weight * f.a, weight * f.b);
      }
      return false;
    });
  }

  bool emit_solid(const Instruction& step, bool is_subtracted) {
    Base base;
    Affine local_from_base;
    if (!find_base(step.space, base, local_from_base)) return false;
    SolidLeaf leaf{};
    const double half = 0.5 * double(cell_.diagonal()), infinity = std::numeric_limits<double>::infinity();
    const SolidPlace place{local_from_base(base.centre), local_from_base.linear,
                           base.slot == 0 ? half * lipschitz(local_from_base.linear) : infinity};
    const bool is_known = std::visit(
        [&](const auto& kind) {
          using K = std::decay_t<decltype(kind)>;
          if constexpr (SolidSkeleton<K>) {
            leaf.potential = bump(kind.weight, kind.falloff, kind.radius);
            return add_solid(step.node, kind.solid(), place, leaf);
          } else if constexpr (SignedDistance<K>) {
            return add_distance(kind, place, leaf);
          }
          return false;
        },
        program_.field.nodes[step.node]);
    if (!is_known) return false;
    leaf.slot = base.slot, leaf.drift = static_cast<float>(base.turning * lipschitz(local_from_base.linear));
    leaf.bending = static_cast<float>(base.bending * lipschitz(local_from_base.linear));
    leaf.node = step.node, leaf.space = step.space;
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

  /// Where the leaves of a space are computed from: the world, or a warped space that is a base of others.
  struct Base {
    uint32_t slot = 0;    ///< as leaf_space has it
    Vec3d centre;         ///< of the cell, as the solvers have it
    double turning = 0;   ///< how much the derivative of the map from the world differs within the cell, at most
    double bending = 0;   ///< half the largest second derivative of that map
    double lipschitz = 1; ///< a Lipschitz constant of that map
  };

  /// The base of a space, and the affine map from there; false if the map from the world is too far from linear.
  bool find_base(uint32_t space_index, Base& base, Affine& local_from_base) {
    const Space& space = program_.spaces[space_index];
    const bool is_warp = space.warp != Space::k_no_warp;
    local_from_base = is_warp ? Affine{} : space.local_from_parent;
    const uint32_t warped = is_warp ? space_index : space.parent;
    for (const auto& [index, known] : bases_)
      if (index == warped) {
        base = known;
        return true;
      }
    base.centre = Vec3d(cell_.centre());
    if (warped != 0) {
      const Space& warp = program_.spaces[warped];
      Base parent;
      Affine parent_from_base;
      if (!find_base(warp.parent, parent, parent_from_base)) return false;
      base.slot = static_cast<uint32_t>(out_.spaces.size()) + 1;
      SpacePoints<double> points;
      points.begin(program_);
      const Point3<double> c = points.at(program_, warped, {base.centre.x, base.centre.y, base.centre.z});
      base.centre = rounded_to_float({c.x, c.y, c.z});
      base.turning = turning(program_, warped, cell_);
      if (!(base.turning <= k_most_drift) || out_.spaces.size() == k_tree_spaces) return false;
      const Affine warp_from_base = warp.local_from_parent * parent_from_base;
      find_bending(warp, parent, lipschitz(warp_from_base.linear), base);
      const LaneWarp lanes = std::visit(
          [&](const auto& kind) {
            if constexpr (std::is_same_v<decltype(kind), const Axial<SampledMode>&>)
              return lane_warp(kind, warp_from_base, parent.centre, base.centre, box_before(warp), out_.axes);
            else
              return lane_warp(kind, warp_from_base, parent.centre, base.centre);
          },
          program_.field.nodes[warp.warp]);
      out_.spaces.push_back({warped, Vec3(base.centre), parent.slot, lanes});
    }
    bases_.emplace_back(warped, base);
    return true;
  }

  /// By the chain rule: second derivatives of the warp times first derivatives before it, squared, and the other way round.
  void find_bending(const Space& warp, const Base& parent, double lipschitz_between, Base& base) const {
    const Box3d box = box_before(warp);
    const Point3<Interval> p{{box.lower.x, box.upper.x}, {box.lower.y, box.upper.y}, {box.lower.z, box.upper.z}};
    std::visit(
        [&](const auto& kind) {
          base.bending = std::numeric_limits<double>::infinity();
          if constexpr (requires { kind.most_bending(p); }) {
            using Variable = Dual<Interval, 3>;
            const Point3<Variable> image = kind.child_from_parent(
                Point3<Variable>{Variable::variable(p.x, 0), Variable::variable(p.y, 1), Variable::variable(p.z, 2)});
            double sum = 0;
            for (const Variable& x : {image.x, image.y, image.z})
              for (const Interval& d : x.d) sum += square(d.magnitude());
            const double of_warp = std::sqrt(sum), before = lipschitz_between * parent.lipschitz;
            base.lipschitz = of_warp * before;
            base.bending = kind.most_bending(p) * square(before);
            if (parent.bending > 0) base.bending += of_warp * lipschitz_between * parent.bending;
            if (std::isnan(base.bending)) base.bending = std::numeric_limits<double>::infinity();
          }
        },
        program_.field.nodes[warp.warp]);
  }

  /// Around where the cell is before it is warped.
  Box3d box_before(const Space& warp) const {
    SpacePoints<Interval> points;
    points.begin(program_);
    const auto range = [&](int i) { return Interval{cell_.lower[i], cell_.upper[i]}; };
    const Point3<Interval> p = warp.local_from_parent.apply(points.at(program_, warp.parent, {range(0), range(1), range(2)}));
    return {{p.x.lo, p.y.lo, p.z.lo}, {p.x.hi, p.y.hi, p.z.hi}};
  }

  /// A Lipschitz constant of a linear map: at least its largest singular value, and that for similarities.
  static double lipschitz(const Mat3d& m) {
    const Mat3d g = glm::transpose(m) * m;
    const double trace = g[0][0] + g[1][1] + g[2][2];
    double off = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) off = std::max(off, std::abs(g[i][j] - (i == j ? trace / 3 : 0)));
    return std::sqrt(off < 1e-9 * trace ? trace / 3 : trace);
  }

  bool add(uint32_t space_index, const ConeSphereSolid& solid, double k, double a, double b) {
    Base base;
    Affine local_from_base;
    if (!find_base(space_index, base, local_from_base)) return false;
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
    leaf[leaf_r] = static_cast<float>(profile.first - profile.sine * nearest), leaf[leaf_sine] = static_cast<float>(profile.sine);
    leaf[leaf_slope] = static_cast<float>(slope);
    leaf[leaf_k] = static_cast<float>(k), leaf[leaf_a] = static_cast<float>(a), leaf[leaf_b] = static_cast<float>(b),
    leaf[leaf_crest] = crest(a, b);
    leaf[leaf_space] = static_cast<float>(base.slot), leaf[leaf_drift] = static_cast<float>(base.turning * lipschitz(linear));
    leaf[leaf_bending] = static_cast<float>(base.bending * lipschitz(linear));
    return true;
  }

  const FieldProgram& program_;
  const CodeView& code_;
  Box3 cell_;
  std::vector<std::pair<uint32_t, Base>> bases_;
  std::vector<LeafNumbers> leaves_;
  Tree out_;
};

} // namespace

double turning(const FieldProgram& program, uint32_t space, const Box3& box) {
  using Variable = Dual<Interval, 3>;
  const auto variable = [&](int i) { return Variable::variable({box.lower[i], box.upper[i]}, i); };
  SpacePoints<Variable> points;
  points.begin(program);
  const Point3<Variable> p = points.at(program, space, {variable(0), variable(1), variable(2)});
  double sum = 0;
  for (const Variable& x : {p.x, p.y, p.z})
    for (const Interval& d : x.d) sum += square(d.width());
  return std::isnan(sum) ? std::numeric_limits<double>::infinity() : std::sqrt(sum);
}

std::optional<Tree> make_tree(const FieldProgram& program, const CodeView& code, const Box3& cell) {
  return TreeMaker(program, code, cell).run();
}

} // namespace kelpie
