#include "renderer/cells/tree.h"

#include <algorithm>
#include <array>
#include <optional>

namespace kelpie {

namespace {

using LeafNumbers = std::array<float, k_leaf_rows>;

/// Steeper, the place of the nearest ball would drown in rounding; the distance hardly feels it.
constexpr double k_steepest = 1e5;

/// What an operator is in a tree, if it can be in one. Of R-functions only the sign is a maximum or minimum.
template <class Kind>
std::optional<TreeStep::Kind> step_kind(Demand demand) {
  using M = SampledMode;
  const bool is_sign = demand == Demand::sign;
  if (std::is_same_v<Kind, Blend<M>>) return TreeStep::Kind::sum;
  if (std::is_same_v<Kind, Union<M>> || (std::is_same_v<Kind, RUnion<M>> && is_sign)) return TreeStep::Kind::maximum;
  if (std::is_same_v<Kind, Intersection<M>> || (std::is_same_v<Kind, RIntersection<M>> && is_sign)) return TreeStep::Kind::minimum;
  if (std::is_same_v<Kind, Difference<M>> || (std::is_same_v<Kind, RDifference<M>> && is_sign)) return TreeStep::Kind::difference;
  return {};
}

class TreeMaker {
public:
  TreeMaker(const FieldProgram& program, const Code& code, const Vec3d& centre) : program_(program), code_(code), centre_(centre) {}

  /// False if the code is no tree.
  bool run() { return emit(static_cast<uint32_t>(code_.steps.size() - 1), 0, false); }

  const std::vector<TreeStep>& steps() const { return steps_; }
  const std::vector<LeafNumbers>& leaves() const { return leaves_; }

private:
  std::optional<TreeStep::Kind> kind_of(const Instruction& step) const {
    return std::visit([&](const auto& kind) { return step_kind<std::decay_t<decltype(kind)>>(step.demand); },
                      program_.field.nodes[step.node]);
  }
  std::span<const uint32_t> operands(const Instruction& step) const { return std::span(code_.operands).subspan(step.first, step.count); }

  /// Emits a step whose value comes to lie at `depth` of the stack.
  bool emit(uint32_t position, size_t depth, bool is_subtracted) {
    if (depth >= k_tree_depth) return false;
    const Instruction& step = code_.steps[position];
    const std::optional<TreeStep::Kind> kind = step.kind == Instruction::Kind::combine ? kind_of(step) : TreeStep::Kind::sum;
    if (!kind) return false;
    if (*kind == TreeStep::Kind::sum) return emit_sum(position, depth, is_subtracted);
    uint32_t count = 0;
    for (const uint32_t operand : operands(step)) {
      const bool flips = *kind == TreeStep::Kind::difference && count > 0;
      if (!emit(operand, depth + count++, is_subtracted != flips)) return false;
    }
    steps_.push_back({*kind, 0, count, is_subtracted});
    return true;
  }

  /// All leaves of a sum are one step.
  bool emit_sum(uint32_t position, size_t depth, bool is_subtracted) {
    std::vector<uint32_t> others;
    const auto first = static_cast<uint32_t>(leaves_.size());
    if (!gather(position, is_subtracted, others)) return false;
    const auto leaf_count = static_cast<uint32_t>(leaves_.size()) - first;
    uint32_t count = 0;
    if (leaf_count > 0 || others.empty()) steps_.push_back({TreeStep::Kind::leaves, first, leaf_count, is_subtracted}), ++count;
    for (const uint32_t other : others)
      if (!emit(other, depth + count++, is_subtracted)) return false;
    if (count > 1) steps_.push_back({TreeStep::Kind::sum, 0, count, is_subtracted});
    return true;
  }

  /// Adds the terms of a sum: leaves to the leaves, anything else to `others`.
  bool gather(uint32_t position, bool is_subtracted, std::vector<uint32_t>& others) {
    const Instruction& step = code_.steps[position];
    switch (step.kind) {
    case Instruction::Kind::blobs: return add_blobs(step, is_subtracted);
    case Instruction::Kind::skeleton: return add_skeleton(step, is_subtracted);
    case Instruction::Kind::combine: break;
    }
    if (kind_of(step) != TreeStep::Kind::sum) {
      others.push_back(position);
      return true;
    }
    for (const uint32_t operand : operands(step))
      if (!gather(operand, is_subtracted, others)) return false;
    return true;
  }

  bool add_blobs(const Instruction& step, bool is_subtracted) {
    const BlobArrays& s = program_.blobs;
    for (const uint32_t i : std::span(code_.blobs).subspan(step.first, step.count)) {
      const Vec3d at(s.x[i], s.y[i], s.z[i]);
      if (!add(step.space, {at, at, 0, 0}, s.k[i], s.a[i], s.b[i], is_subtracted)) return false;
    }
    return true;
  }

  bool add_skeleton(const Instruction& step, bool is_subtracted) {
    return std::visit(
        [&](const auto& kind) {
          if constexpr (ConeSphereSkeleton<std::decay_t<decltype(kind)>>) {
            const FalloffPolynomial f = polynomial(kind.falloff);
            const double weight = kind.weight;
            return add(step.space, kind.solid(), 1 / square(double(kind.radius)), weight * f.a, weight * f.b, is_subtracted);
          }
          return false;
        },
        program_.field.nodes[step.node]);
  }

  bool add(uint32_t space_index, const ConeSphereSolid& solid, double k, double a, double b, bool is_subtracted) {
    const Space& space = program_.spaces[space_index];
    if (space_index != 0 && !space.is_affine_in_world()) return false;
    const Vec3d axis = solid.to - solid.from;
    const AxisFrame frame{solid.from, axis};
    const ConeSphereProfile profile{glm::length(axis), solid.from_radius, solid.to_radius};
    const Vec3d c = space.local_from_parent(centre_) - solid.from;
    const Vec3d at{glm::dot(frame.u, c), glm::dot(frame.v, c), glm::dot(frame.e, c) - profile.lift};
    const double slope = std::clamp(profile.slope, -k_steepest, k_steepest);
    const double nearest = std::clamp(at.z - slope * norm(at.x, at.y), 0.0, profile.length);

    LeafNumbers& leaf = leaves_.emplace_back();
    const Vec3d rows[] = {frame.u * space.local_from_parent.linear, frame.v * space.local_from_parent.linear,
                          frame.e * space.local_from_parent.linear};
    const double origin[] = {at.x, at.y, at.z - nearest};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) leaf[4 * i + j] = static_cast<float>(rows[i][j]);
      leaf[4 * i + 3] = static_cast<float>(origin[i]);
    }
    leaf[leaf_s_low] = static_cast<float>(-nearest), leaf[leaf_s_high] = static_cast<float>(profile.length - nearest);
    leaf[leaf_r] = static_cast<float>(profile.first - profile.sine * nearest), leaf[leaf_sine] = static_cast<float>(profile.sine);
    leaf[leaf_slope] = static_cast<float>(slope);
    leaf[leaf_k] = static_cast<float>(k), leaf[leaf_a] = static_cast<float>(a), leaf[leaf_b] = static_cast<float>(b);
    leaf[leaf_sign] = (a + b < 0) == is_subtracted ? 1.f : -1.f;
    return true;
  }

  const FieldProgram& program_;
  const Code& code_;
  Vec3d centre_;
  std::vector<TreeStep> steps_;
  std::vector<LeafNumbers> leaves_;
};

} // namespace

uint32_t make_tree(const FieldProgram& program, const Code& code, const Vec3d& centre, std::vector<TreeStep>& steps,
                   std::vector<float>& leaves) {
  TreeMaker maker(program, code, centre);
  if (!maker.run()) return 0;
  const size_t count = maker.leaves().size(), padded = std::max<size_t>(1, (count + k_leaf_group - 1) / k_leaf_group) * k_leaf_group;
  const size_t first = leaves.size();
  leaves.resize(first + padded * k_leaf_rows, 0.f);
  float* rows = leaves.data() + first;
  for (size_t i = 0; i < padded; ++i) {
    for (size_t r = 0; i < count && r < k_leaf_rows; ++r) rows[r * padded + i] = maker.leaves()[i][r];
    if (i >= count) rows[leaf_r * padded + i] = -2, rows[leaf_k * padded + i] = 1; // a ball of radius -2: at least 2 away
  }
  steps.insert(steps.end(), maker.steps().begin(), maker.steps().end());
  return static_cast<uint32_t>(padded);
}

} // namespace kelpie
