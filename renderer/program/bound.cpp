#include "renderer/program/bound.h"

#include <cmath>

#include "renderer/program/bound_blobs.h"

namespace kelpie {

namespace {

/// The box, seen from a space: an axis-aligned box around its image.
Box3d box_in_space(const FieldProgram& program, uint32_t space, const Box3d& box) {
  if (space == 0) return box;
  const Affine& f = program.spaces[space];
  const Vec3d c = f(box.centre()), h = box.extent() * 0.5;
  Vec3d e(0);
  for (int i = 0; i < 3; ++i) e += glm::abs(f.linear[i]) * h[i];
  return {c - e, c + e};
}

/// Bounds a step of blobs; appends those that reach the box to `out` and makes the step refer to them.
Interval bound_blobs(const FieldProgram& program, std::span<const uint32_t> list, Instruction& step, const Box3d& box,
                     std::vector<uint32_t>& out) {
  const size_t first = out.size();
  size_t count = 0;
  out.resize(first + list.size() + k_blob_bound_slack);
  const Interval range =
      bound_blob_sum(program.blobs, list, Vec3(box.centre()), Vec3(box.extent() * 0.5) * (1 + 1e-6f), out.data() + first, count);
  out.resize(first + count);
  step.first = static_cast<uint32_t>(first), step.count = static_cast<uint32_t>(count);
  return count == 0 ? Interval{0} : range;
}

template <class Kind>
Interval bound_skeleton(const Kind& kind, const Box3d& box) {
  const Vec3d c = box.centre(), h = box.extent() * 0.5;
  const Box3d support{Vec3d(kind.support().lower), Vec3d(kind.support().upper)};
  if (intersect(support, box).is_empty()) return 0.0;
  using D = Dual<Interval, 3>;
  const auto variable = [&](int i) { return D::variable({box.lower[i], box.upper[i]}, i); };
  const D f = kind.potential(Point3<D>{variable(0), variable(1), variable(2)});
  const double at_centre = kind.potential(Point3<double>{c.x, c.y, c.z});
  const double reach = f.d[0].magnitude() * h.x + f.d[1].magnitude() * h.y + f.d[2].magnitude() * h.z;
  return std::isfinite(reach) ? intersect(f.value, Interval{at_centre - reach, at_centre + reach}) : f.value;
}

Interval bound_node(const FieldProgram& program, const Code& code, const Instruction& step, const Box3d& box,
                    std::span<const Interval> ranges) {
  return std::visit(
      [&](const auto& kind) -> Interval {
        using K = std::decay_t<decltype(kind)>;
        if constexpr (Operator<K>) {
          std::vector<Interval> operands;
          for (uint32_t i = 0; i < step.count; ++i) operands.push_back(ranges[code.operands[step.first + i]]);
          return kind.combine(std::span<const Interval>(operands), program.threshold);
        } else if constexpr (Skeleton<K>) {
          return bound_skeleton(kind, box);
        } else {
          return 0.0;
        }
      },
      program.field.nodes[step.node]);
}

class Pruner {
public:
  Pruner(const FieldProgram& program, const Code& code, std::span<const Interval> ranges)
      : program_(program), code_(code), ranges_(ranges) {}

  Code run() {
    emit(static_cast<uint32_t>(code_.steps.size() - 1), Demand::sign);
    return std::move(out_);
  }

private:
  // Before `emit`: clang 14 forgets to instantiate a member that a generic lambda uses before it is defined.
  template <class Kind>
  uint32_t emit_operator(const Kind& kind, const Instruction& step, Demand demand) {
    std::vector<Interval> operands;
    for (uint32_t i = 0; i < step.count; ++i) operands.push_back(ranges_[code_.operands[step.first + i]]);
    std::vector<char> kept(operands.size(), true);
    kind.keep(operands, program_.threshold, demand, kept);
    const auto count = static_cast<size_t>(std::count(kept.begin(), kept.end(), char(true)));
    if (count == 0) return push({});
    const Demand below = kind.demand_of_operands(demand, count);
    std::vector<uint32_t> positions;
    for (uint32_t i = 0; i < step.count; ++i)
      if (kept[i]) positions.push_back(emit(code_.operands[step.first + i], below));
    // A lone operand is the result; only a difference clamps it at 0, which no sign depends on.
    if (count == 1) {
      const auto i = static_cast<size_t>(std::find(kept.begin(), kept.end(), char(true)) - kept.begin());
      const bool passes = demand == Demand::sign || !std::is_same_v<Kind, Difference<SampledMode>> || operands[i].lo >= 0;
      if (passes) return positions[0];
    }
    Instruction out = step;
    out.first = static_cast<uint32_t>(out_.operands.size()), out.count = static_cast<uint32_t>(positions.size());
    out_.operands.insert(out_.operands.end(), positions.begin(), positions.end());
    return push(out);
  }

  /// Emits what is left of a step; returns its new position.
  uint32_t emit(uint32_t position, Demand demand) {
    const Instruction& step = code_.steps[position];
    const Interval& range = ranges_[position];
    if (range.lo == 0 && range.hi == 0) return push({}); // the constant 0
    if (step.kind != Instruction::Kind::combine) return emit_leaf(step);
    return std::visit(
        [&](const auto& kind) -> uint32_t {
          if constexpr (Operator<std::decay_t<decltype(kind)>>) return emit_operator(kind, step, demand);
          return push({});
        },
        program_.field.nodes[step.node]);
  }

  uint32_t emit_leaf(Instruction step) {
    if (step.kind == Instruction::Kind::blobs) {
      const auto list = code_.blobs.begin() + step.first;
      step.first = static_cast<uint32_t>(out_.blobs.size());
      out_.blobs.insert(out_.blobs.end(), list, list + step.count);
    }
    return push(step);
  }

  uint32_t push(Instruction step) {
    out_.steps.push_back(step);
    return static_cast<uint32_t>(out_.steps.size() - 1);
  }

  const FieldProgram& program_;
  const Code& code_;
  std::span<const Interval> ranges_;
  Code out_;
};

} // namespace

Code bound(const FieldProgram& program, const Code& code, const Box3d& box, std::vector<Interval>& ranges) {
  ranges.clear();
  Code out{code.steps, code.operands, {}};
  out.blobs.reserve(code.blobs.size() + k_blob_bound_slack);
  for (Instruction& step : out.steps) {
    const Box3d local = box_in_space(program, step.space, box);
    const std::span<const uint32_t> list = std::span(code.blobs).subspan(step.kind == Instruction::Kind::blobs ? step.first : 0);
    ranges.push_back(step.kind == Instruction::Kind::blobs ? bound_blobs(program, list.first(step.count), step, local, out.blobs)
                                                           : bound_node(program, code, step, local, ranges));
  }
  return out;
}

Code prune(const FieldProgram& program, const Code& code, std::span<const Interval> ranges) { return Pruner(program, code, ranges).run(); }

} // namespace kelpie
