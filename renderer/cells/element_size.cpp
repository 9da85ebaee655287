#include "renderer/cells/element_size.h"

#include <cmath>
#include <limits>

namespace kelpie {

namespace {

/// A lower bound of what the affine maps from a space to the world do to lengths (the Frobenius norm of
/// the inverse bounds its largest singular value). Warps that are not affine count as if they kept lengths:
/// this only chooses the size of cells and the offset of secondary rays.
double smallest_scale(const FieldProgram& program, uint32_t space) {
  double scale = 1;
  for (uint32_t i = space; i != 0; i = program.spaces[i].parent) {
    const Mat3d& m = program.spaces[i].local_from_parent.linear;
    if (m != Mat3d(1.0)) scale /= std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
  }
  return scale;
}

template <class Visit>
double visit_skeleton(const FieldProgram& program, uint32_t node, Visit&& visit) {
  return std::visit(
      [&](const auto& kind) -> double {
        if constexpr (Skeleton<std::decay_t<decltype(kind)>>) return visit(kind);
        return 0;
      },
      program.field.nodes[node]);
}

double skeleton_radius(const FieldProgram& program, uint32_t node) {
  return visit_skeleton(program, node, [](const auto& kind) -> double {
    if constexpr (requires { kind.feature_size(); }) return kind.feature_size();
    const Vec3 e = kind.support().extent();
    return 0.5 * double(std::min({e.x, e.y, e.z}));
  });
}

} // namespace

size_t element_count(const Code& code) {
  size_t n = code.blobs.size();
  for (const Instruction& s : code.steps) n += s.kind == Instruction::Kind::skeleton;
  return n;
}

double smallest_radius(const FieldProgram& program, const Code& code) {
  double least = std::numeric_limits<double>::infinity();
  for (const Instruction& step : code.steps) {
    const double scale = smallest_scale(program, step.space);
    if (step.kind == Instruction::Kind::blobs)
      for (uint32_t j = 0; j < step.count; ++j) least = std::min(least, scale * program.blobs.radius[code.blobs[step.first + j]]);
    else if (step.kind == Instruction::Kind::skeleton)
      least = std::min(least, scale * skeleton_radius(program, step.node));
  }
  return std::isfinite(least) ? least : program.support.diagonal();
}

double smallest_influence(const FieldProgram& program, const Code& code) {
  double least = std::numeric_limits<double>::infinity();
  for (const Instruction& step : code.steps)
    if (step.kind == Instruction::Kind::skeleton)
      least = std::min(least, smallest_scale(program, step.space) *
                                  visit_skeleton(program, step.node, [](const auto& kind) { return reach_of(kind); }));
  return least;
}

double smallest_lattice(const FieldProgram& program, const Code& code) {
  double least = std::numeric_limits<double>::infinity();
  for (const Instruction& step : code.steps)
    if (step.kind == Instruction::Kind::skeleton)
      least = std::min(least, smallest_scale(program, step.space) * visit_skeleton(program, step.node, [](const auto& kind) -> double {
                                if constexpr (requires { kind.feature_size(); }) return kind.feature_size();
                                return std::numeric_limits<double>::infinity();
                              }));
  return least;
}

} // namespace kelpie
