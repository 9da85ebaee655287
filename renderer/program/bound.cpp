#include "renderer/program/bound.h"

#include <algorithm>
#include <cmath>

#include "field/range.h"
#include "renderer/program/bound_blobs.h"
#include "renderer/program/motion.h"

namespace kelpie {

namespace {

using Variable = Dual<Interval, 3>;

/// A box of the world, seen from a space.
struct LocalBox : BoxPoint {
  Box3d box; ///< around its image

  /// The space's own coordinates are the variables.
  explicit LocalBox(const Box3d& b) : BoxPoint(b), box(b) {}
};

/// Boxes in the spaces of a program, one after the other: a space's steps mostly are neighbours.
class LocalBoxes {
public:
  LocalBoxes(const FieldProgram& program, const Box3d& box) : program_(program), world_(box) {}

  /// Mostly one. Where the map to the space is torn, as many as hold all images of the box but those that are nowhere.
  std::span<const LocalBox> in_space(uint32_t space) {
    if (space == 0) return {&world_, 1};
    if (space == last_space_) return last_;
    last_space_ = space, is_torn_ = false;
    last_.clear();
    if (program_.motion && program_.motion->spaces[space])
      last_.emplace_back(image_in_space(program_, space, world_.box));
    else if (program_.spaces[space].is_affine_in_world())
      last_.push_back(through(program_.spaces[space].local_from_parent));
    else if (std::vector<Box3d> images; tear(space, images))
      for (const Box3d& image : images) last_.emplace_back(image);
    else
      last_.push_back(through_warps(space));
    return last_;
  }
  /// Whether the boxes of the space that was asked for last may lack what is nowhere, where fields are 0.
  bool is_torn(uint32_t space) const { return space != 0 && is_torn_; }

private:
  /// The images of the box in a space, by values alone; whether any warp on the way tears it.
  bool tear(uint32_t index, std::vector<Box3d>& images) {
    if (index == 0) {
      images = {world_.box};
      return false;
    }
    const Space& space = program_.spaces[index];
    std::vector<Box3d> before;
    tear(space.parent, before);
    images.clear();
    std::vector<Box3d> torn;
    for (const Box3d& parent : before) {
      const Box3d box = image_of(space.local_from_parent, parent);
      if (space.warp == Space::k_no_warp) {
        images.push_back(box);
        continue;
      }
      std::visit(
          [&](const auto& kind) {
            using K = std::decay_t<decltype(kind)>;
            if constexpr (TearingWarp<K>)
              if (kind.torn_images(box, torn)) {
                is_torn_ = true;
                images.insert(images.end(), torn.begin(), torn.end());
                return;
              }
            if constexpr (Warp<K>) {
              const Point3<Interval> q = kind.child_from_parent(
                  Point3<Interval>{{box.lower.x, box.upper.x}, {box.lower.y, box.upper.y}, {box.lower.z, box.upper.z}});
              images.push_back({{q.x.lo, q.y.lo, q.z.lo}, {q.x.hi, q.y.hi, q.z.hi}});
            }
          },
          program_.field.nodes[space.warp]);
    }
    return is_torn_;
  }

  LocalBox through(const Affine& f) const { return LocalBox(image_of(f, world_.box)); }

  /// The world's coordinates are the variables. The image is bounded by the natural extension, met with the
  /// mean-value form.
  LocalBox through_warps(uint32_t space) {
    LocalBox out = world_;
    SpacePoints<Variable> points;
    SpacePoints<double> centres;
    points.begin(program_), centres.begin(program_);
    out.p = points.at(program_, space, world_.p);
    const Point3<double> c = centres.at(program_, space, {world_.centre.x, world_.centre.y, world_.centre.z});
    out.centre = {c.x, c.y, c.z};
    Variable* coordinates[] = {&out.p.x, &out.p.y, &out.p.z};
    for (int i = 0; i < 3; ++i) {
      Variable& x = *coordinates[i];
      const double reach = x.d[0].magnitude() * out.half.x + x.d[1].magnitude() * out.half.y + x.d[2].magnitude() * out.half.z;
      if (std::isfinite(reach)) x.value = intersect(x.value, Interval{out.centre[i] - reach, out.centre[i] + reach});
      out.box.lower[i] = x.value.lo, out.box.upper[i] = x.value.hi;
    }
    return out;
  }

  const FieldProgram& program_;
  LocalBox world_;
  std::vector<LocalBox> last_;
  uint32_t last_space_ = 0;
  bool is_torn_ = false;
};

/// Bounds a step of blobs; appends those that reach the box to `out` and makes the step refer to them.
Interval bound_blobs(const FieldProgram& program, std::span<const uint32_t> list, Instruction& step, const Box3d& box,
                     std::vector<uint32_t>& out) {
  const size_t first = out.size();
  step.first = static_cast<uint32_t>(first);
  if (list.empty()) return 0.0;
  size_t count = 0;
  out.resize(first + list.size() + k_blob_bound_slack);
  const Vec3 centre(box.centre()), half(Vec3(box.extent() * 0.5) * (1 + 1e-6f));
  const Interval range = program.motion ? bound_moving_blob_sum(program.blobs, program.motion->end.blobs, program.motion->blobs_change,
                                                                list, centre, half, out.data() + first, count)
                                        : bound_blob_sum(program.blobs, list, centre, half, out.data() + first, count);
  out.resize(first + count);
  step.count = static_cast<uint32_t>(count);
  return count == 0 ? Interval{0} : range;
}

/// The same over several boxes: of blobs that reach any of them.
Interval bound_torn_blobs(const FieldProgram& program, std::span<const uint32_t> list, Instruction& step, std::span<const LocalBox> boxes,
                          std::vector<uint32_t>& out) {
  Interval range(0.0);
  std::vector<uint32_t> reaching, of_one;
  for (const LocalBox& at : boxes) {
    of_one.clear();
    range = hull(range, bound_blobs(program, list, step, at.box, of_one));
    reaching.insert(reaching.end(), of_one.begin(), of_one.end());
  }
  std::sort(reaching.begin(), reaching.end());
  step.first = static_cast<uint32_t>(out.size());
  for (const uint32_t i : list)
    if (std::binary_search(reaching.begin(), reaching.end(), i)) out.push_back(i);
  step.count = static_cast<uint32_t>(out.size()) - step.first;
  return range;
}

Interval bound_node(const FieldProgram& program, const Code& code, const Instruction& step, const LocalBox& at,
                    std::span<const Interval> ranges) {
  return std::visit(
      [&](const auto& kind) -> Interval {
        using K = std::decay_t<decltype(kind)>;
        if constexpr (Operator<K>) {
          std::vector<Interval> operands;
          for (uint32_t i = 0; i < step.count; ++i) operands.push_back(ranges[code.operands[step.first + i]]);
          const K& end = program.motion ? std::get<K>(program.motion->end.field.nodes[step.node]) : kind;
          return moving_combine(kind, end, operands, threshold_range(program), step.demand);
        } else if constexpr (Skeleton<K>) {
          const Interval unit = potential_unit(kind, threshold_range(program));
          if constexpr (MovingSkeleton<K>)
            if (program.motion && program.motion->nodes[step.node])
              return moving_potential_range(kind, std::get<K>(program.motion->end.field.nodes[step.node]), at.box) * unit;
          return reaches(kind.support(), 0, at.box) ? potential_range(kind, at) * unit : 0.0;
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

  Code run(Demand demand) {
    emit(static_cast<uint32_t>(code_.steps.size() - 1), demand);
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
    if (program_.motion) { // what can matter at either end can matter between
      std::vector<char> at_end(operands.size(), true);
      const FieldProgram& end = program_.motion->end;
      std::get<Kind>(end.field.nodes[step.node]).keep(operands, end.threshold, demand, at_end);
      for (size_t i = 0; i < kept.size(); ++i) kept[i] = kept[i] || at_end[i];
    }
    const auto count = static_cast<size_t>(std::count(kept.begin(), kept.end(), char(true)));
    if (count == 0 && !is_positional<Kind>()) return push({});
    const Demand below = kind.demand_of_operands(demand, count);
    if (count == 1) {
      const auto i = static_cast<size_t>(std::find(kept.begin(), kept.end(), char(true)) - kept.begin());
      if (is_result<Kind>(operands[i], demand)) return emit(code_.operands[step.first + i], below);
    }
    std::vector<uint32_t> positions;
    for (uint32_t i = 0; i < step.count; ++i)
      if (kept[i])
        positions.push_back(emit(code_.operands[step.first + i], below));
      else if (is_positional<Kind>())
        positions.push_back(push({})); // the constant 0
    Instruction out = step;
    out.first = static_cast<uint32_t>(out_.operands.size()), out.count = static_cast<uint32_t>(positions.size());
    out_.operands.insert(out_.operands.end(), positions.begin(), positions.end());
    return push(out);
  }

  /// Whether a lone operand is what the operator yields. Where that is its part above 0, no sign depends on the rest.
  template <class Kind>
  static bool is_result(const Interval& operand, Demand demand) {
    switch (lone_of<Kind>()) {
    case Lone::itself: return true;
    case Lone::above_0: return demand == Demand::sign || operand.lo >= 0;
    case Lone::combined: return false;
    }
    return false;
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
  LocalBoxes boxes(program, box);
  for (Instruction& step : out.steps) {
    const bool has_blobs = step.kind == Instruction::Kind::blobs;
    const std::span<const uint32_t> list = std::span(code.blobs).subspan(has_blobs ? step.first : 0, has_blobs ? step.count : 0);
    const std::span<const LocalBox> local = boxes.in_space(step.space);
    if (local.size() == 1 && !boxes.is_torn(step.space)) {
      ranges.push_back(has_blobs ? bound_blobs(program, list, step, local[0].box, out.blobs)
                                 : bound_node(program, code, step, local[0], ranges));
      continue;
    }
    Interval range(0.0); // that of what is nowhere
    if (has_blobs) {
      range = bound_torn_blobs(program, list, step, local, out.blobs);
    } else {
      for (const LocalBox& at : local) range = hull(range, bound_node(program, code, step, at, ranges));
    }
    ranges.push_back(range);
  }
  return out;
}

Code prune(const FieldProgram& program, const Code& code, std::span<const Interval> ranges, Demand demand) {
  return Pruner(program, code, ranges).run(demand);
}

} // namespace kelpie
