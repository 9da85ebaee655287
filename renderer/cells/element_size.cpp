#include "renderer/cells/element_size.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kelpie {

namespace {

/// An element is thin if it is this many times as long as wide. All elements of pictures so far are less so.
constexpr double k_thin = 64;

/// The distances that a metamorphosis mixes reach over everything. Its cells are solved as code, and want to be this small a part of a
/// solid's thickness, so that few of many objects count in each; but not smaller than a part of the reach.
constexpr double k_mixed_size = 0.25, k_least_mixed_size = 1.0 / 2048;

bool mixes_distances(const FieldProgram& program, const Code& code) {
  return std::any_of(code.steps.begin(), code.steps.end(), [&](const Instruction& step) {
    return step.kind == Instruction::Kind::combine && std::holds_alternative<Metamorphosis<SampledMode>>(program.field.nodes[step.node]);
  });
}

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

double skeleton_radius(const FieldProgram& program, uint32_t node, bool is_mixed) {
  return visit_skeleton(program, node, [&](const auto& kind) -> double {
    if constexpr (requires { kind.feature_size(); }) return kind.feature_size();
    const Vec3 e = kind.support().extent();
    if constexpr (requires { kind.inner_radius(); })
      if (is_mixed) return std::max(k_mixed_size * kind.inner_radius(), k_least_mixed_size * kind.reach());
    return 0.5 * double(std::min({e.x, e.y, e.z}));
  });
}

/// How many times as long as wide a skeleton is. What is sampled has a lattice, of which the size is known.
double skeleton_aspect(const FieldProgram& program, uint32_t node) {
  return visit_skeleton(program, node, [](const auto& kind) -> double {
    if constexpr (requires { kind.feature_size(); }) return 1;
    const Vec3d e(kind.support().extent());
    return std::max({e.x, e.y, e.z}) / std::min({e.x, e.y, e.z});
  });
}

} // namespace

size_t element_count(const Code& code) {
  size_t n = code.blobs.size();
  for (const Instruction& s : code.steps) n += s.kind == Instruction::Kind::skeleton;
  return n;
}

/// Calls visit(step, radius) with the smallest radius of influence in each step that has elements, in world units.
template <class Visit>
void for_each_radius(const FieldProgram& program, const Code& code, Visit&& visit) {
  const bool is_mixed = mixes_distances(program, code);
  for (const Instruction& step : code.steps) {
    const double scale = smallest_scale(program, step.space);
    if (step.kind == Instruction::Kind::blobs) {
      float least = std::numeric_limits<float>::infinity();
      for (uint32_t j = 0; j < step.count; ++j)
        least = std::min(
            least, std::sqrt(program.blobs.radius[code.blobs[step.first + j]] * program.blobs.least_radius(code.blobs[step.first + j])));
      visit(step, scale * double(least));
    } else if (step.kind == Instruction::Kind::skeleton) {
      visit(step, scale * skeleton_radius(program, step.node, is_mixed));
    }
  }
}

double smallest_radius(const FieldProgram& program, const Code& code) {
  double least = std::numeric_limits<double>::infinity();
  for_each_radius(program, code, [&](const Instruction&, double radius) { least = std::min(least, radius); });
  return std::isfinite(least) ? least : program.support.diagonal();
}

ThinElements::ThinElements(const FieldProgram& program) : program_(program) {
  const auto length = [](const Mat3d& m) { return std::sqrt((glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2])) / 3); };
  for (const Space& space : program.spaces) {
    const Mat3d& m = space.local_from_parent.linear;
    const double parent = space_aspects_.empty() ? 1 : space_aspects_[space.parent];
    space_aspects_.push_back(parent * length(m) * length(glm::inverse(m)));
  }
  are_there_ = std::any_of(program.code.steps.begin(), program.code.steps.end(), [&](const Instruction& step) { return is_thin(step); });
}

bool ThinElements::is_thin(const Instruction& step) const {
  if (step.kind == Instruction::Kind::combine) return false;
  const double aspect = step.kind == Instruction::Kind::skeleton ? skeleton_aspect(program_, step.node) : 1;
  return aspect * space_aspects_[step.space] > k_thin;
}

double ThinElements::dividing_radius(const Code& code, const Box3d& box, const PixelScale& pixels) const {
  const Vec3d eye(pixels.eye);
  const double pixel = double(pixels.per_distance) * glm::distance(eye, glm::clamp(eye, box.lower, box.upper));
  double least = std::numeric_limits<double>::infinity();
  for_each_radius(program_, code, [&](const Instruction& step, double radius) {
    least = std::min(least, radius < pixel && is_thin(step) ? pixel : radius);
  });
  return std::isfinite(least) ? least : program_.support.diagonal();
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
