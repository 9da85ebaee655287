// Evaluates code for any number type: double (values), Dual<double, 3> (gradients), Interval and
// Dual<Interval, 1> (bounds). One formula a kind serves them all.
#pragma once

#include "field/motion.h"
#include "renderer/program/program.h"

namespace kelpie {

/// A view of code, full or pruned, whose arrays live elsewhere.
struct CodeView {
  std::span<const Instruction> steps;
  std::span<const uint32_t> operands;
  std::span<const uint32_t> blobs;

  CodeView() = default;
  CodeView(const Code& c) : steps(c.steps), operands(c.operands), blobs(c.blobs) {} // NOLINT: code is viewed as code
};

inline BlobNumbers FieldProgram::blob(uint32_t i) const {
  if (!moving_blobs.start) return blobs[i];
  const BlobNumbers s = (*moving_blobs.start)[i], e = (*moving_blobs.end)[i];
  const auto between = [&](float x, float y) { return interpolate(x, y, moving_blobs.part); };
  const SymmetricMat3 &m = s.shape, &n = e.shape;
  return {between(s.x, e.x),
          between(s.y, e.y),
          between(s.z, e.z),
          between(s.k, e.k),
          between(s.a, e.a),
          between(s.b, e.b),
          {between(m.xx, n.xx), between(m.yy, n.yy), between(m.zz, n.zz), between(m.xy, n.xy), between(m.xz, n.xz), between(m.yz, n.yz)}};
}

/// The sum of blobs of a program at p.
template <class Real>
Real sum_of_blobs(const FieldProgram& program, std::span<const uint32_t> list, const Point3<Real>& p) {
  Real sum(0.0);
  const bool are_round = program.has_round_blobs();
  for (const uint32_t i : list) {
    const BlobNumbers blob = program.blob(i);
    const Point3<Real> d{p.x - Real(blob.x), p.y - Real(blob.y), p.z - Real(blob.z)};
    const auto along = [&](float x, float y, float z) { return d.x * double(x) + d.y * double(y) + d.z * double(z); };
    const SymmetricMat3& m = blob.shape;
    const Real u2 = are_round ? (square(d.x) + square(d.y) + square(d.z)) * double(blob.k)
                              : square(along(m.xx, m.xy, m.xz)) + square(along(m.xy, m.yy, m.yz)) + square(along(m.xz, m.yz, m.zz));
    const Real q = max(Real(0.0), Real(1.0) - u2);
    sum = sum + square(q) * (Real(blob.a) + q * double(blob.b));
  }
  return sum;
}

/// A point of the world in all the spaces of a program, each found when it is first asked for.
template <class Real>
class SpacePoints {
public:
  /// For the next point.
  void begin(const FieldProgram& program) {
    ++now_;
    if (found_.size() < program.spaces.size()) points_.resize(program.spaces.size()), found_.resize(program.spaces.size(), 0);
  }
  const Point3<Real>& at(const FieldProgram& program, uint32_t index, const Point3<Real>& world) {
    if (index == 0) return world;
    if (found_[index] == now_) return points_[index];
    const Space& space = program.spaces[index];
    Point3<Real>& p = points_[index];
    p = space.local_from_parent.apply(at(program, space.parent, world));
    if (space.warp != Space::k_no_warp)
      std::visit(
          [&](const auto& kind) {
            if constexpr (Warp<std::decay_t<decltype(kind)>>) p = kind.child_from_parent(p);
          },
          program.field.nodes[space.warp]);
    found_[index] = now_;
    return p;
  }

private:
  std::vector<Point3<Real>> points_;
  std::vector<uint64_t> found_; ///< when
  uint64_t now_ = 0;
};

/// The value of one step, given those of the steps before it. `operands` is scratch.
template <class Real>
Real evaluate_step(const FieldProgram& program, const CodeView& code, const Instruction& step, const Point3<Real>& p,
                   SpacePoints<Real>& spaces, const std::vector<Real>& values, std::vector<Real>& operands) {
  const Point3<Real>& local = spaces.at(program, step.space, p);
  switch (step.kind) {
  case Instruction::Kind::blobs: return sum_of_blobs(program, code.blobs.subspan(step.first, step.count), local);
  case Instruction::Kind::skeleton:
    return std::visit(
        [&](const auto& kind) {
          using K = std::decay_t<decltype(kind)>;
          if constexpr (SignedDistance<K>) return potential(kind, local) * potential_unit(kind, program.threshold);
          if constexpr (SolidSkeleton<K>) return potential(kind, local);
          return Real(0.0);
        },
        program.field.nodes[step.node]);
  case Instruction::Kind::combine:
    operands.clear();
    for (uint32_t i = 0; i < step.count; ++i) operands.push_back(values[code.operands[step.first + i]]);
    return std::visit(
        [&](const auto& kind) {
          if constexpr (Operator<std::decay_t<decltype(kind)>>)
            return kind.combine(std::span<const Real>(operands), program.threshold, step.demand);
          return Real(0.0);
        },
        program.field.nodes[step.node]);
  }
  return Real(0.0);
}

/// The field (not minus the threshold) at p.
template <class Real>
Real evaluate(const FieldProgram& program, const CodeView& code, const Point3<Real>& p) {
  thread_local std::vector<Real> values, operands;
  thread_local SpacePoints<Real> spaces;
  values.clear();
  spaces.begin(program);
  for (const Instruction& step : code.steps) values.push_back(evaluate_step(program, code, step, p, spaces, values, operands));
  return values.back();
}

/// The gradient of the field at p, per scene unit.
inline Vec3d gradient(const FieldProgram& program, const CodeView& code, const Vec3d& p) {
  using D = Dual<double, 3>;
  const D f = evaluate(program, code, Point3<D>{D::variable(p.x, 0), D::variable(p.y, 1), D::variable(p.z, 2)});
  return {f.d[0], f.d[1], f.d[2]};
}

} // namespace kelpie
