#include "renderer/program/support.h"

namespace kelpie {

namespace {

/// Whatever an interpolated map takes into `box`; false if one may have no inverse. With M the linear part in the middle, half
/// its change E M and p = c + r: p = M^-1 (q - offset) - s E p, |s| <= 1, so |r| <= (|q'| + |E c|) / (1 - |E|).
bool preimage(const Affine& a, const Affine& b, Box3d& box) {
  const Affine middle = inverse(interpolate(a, b, 0.5));
  const Mat3d e = middle.linear * (b.linear - a.linear) * 0.5;
  const double norm = std::sqrt(glm::dot(e[0], e[0]) + glm::dot(e[1], e[1]) + glm::dot(e[2], e[2]));
  if (!(norm < 0.9)) return false;
  box = image_of(middle, box);
  const Vec3d shift = glm::abs(middle.linear * (b.offset - a.offset)) * 0.5;
  box.lower -= shift, box.upper += shift;
  if (norm == 0) return true;
  const Vec3d c = box.centre();
  const double reach = (0.5 * box.diagonal() + glm::length(e * c)) / (1 - norm);
  box = {c - reach, c + reach};
  return true;
}

class SupportFinder {
public:
  SupportFinder(const FieldProgram& program, const Motion* motion)
      : program_(program), end_(motion ? motion->end : program), middle_(motion ? motion->middle : program.field) {}

  bool run(Box3d& out) {
    for (const Instruction& step : program_.code.steps) {
      Box3d box = step.kind == Instruction::Kind::blobs ? around_blobs(step) : around_node(step);
      if (step.kind != Instruction::Kind::combine && !box.is_empty() && !to_world(step.space, box)) return false;
      boxes_.push_back(box);
    }
    out = boxes_.back();
    return true;
  }

private:
  Box3d around_blobs(const Instruction& step) const {
    Box3d box;
    for (uint32_t j = 0; j < step.count; ++j)
      for (const BlobArrays* s : {&program_.blobs, &end_.blobs}) {
        const uint32_t i = program_.code.blobs[step.first + j];
        const Vec3d centre(s->x[i], s->y[i], s->z[i]), radius(s->radius[i] * (1 + 1e-6));
        box.extend(Box3d{centre - radius, centre + radius});
      }
    return box;
  }

  /// The boxes of an operator's operands that are children.
  template <class Kind>
  std::vector<Box3d> children_of(const Kind& kind, const Instruction& step) const {
    const auto operands = std::span(program_.code.operands).subspan(step.first, step.count);
    std::vector<char> is_child(step.count, true); // so are all of a sum and of a union of pieces, which may have more than the node
    if constexpr (is_positional<Kind>()) {
      const std::vector<Operand> all = operands_of(kind);
      for (size_t i = 0; i < all.size(); ++i) is_child[i] = all[i].role == Role::child;
    }
    std::vector<Box3d> boxes;
    for (size_t i = 0; i < operands.size(); ++i)
      if (is_child[i]) boxes.push_back(boxes_[operands[i]]);
    return boxes;
  }

  /// Around a skeleton in its space; around what an operator makes, in the world.
  Box3d around_node(const Instruction& step) const {
    return std::visit(
        [&](const auto& a) -> Box3d {
          using K = std::decay_t<decltype(a)>;
          if constexpr (Skeleton<K>) {
            const Box3 support = a.support();
            Box3d box{Vec3d(support.lower), Vec3d(support.upper)};
            if constexpr (requires(const K& b) { a.displacement_from(b); }) { // others have no end
              const K& b = std::get<K>(end_.field.nodes[step.node]);
              box = box.padded(a.displacement_from(b) + std::abs(reach_of(a) - reach_of(b)));
            }
            return box;
          } else if constexpr (Operator<K>) {
            return joined(extent_of<K>(), this->children_of(a, step));
          }
          return {};
        },
        program_.field.nodes[step.node]);
  }

  static Box3d joined(ExtentOf extent, std::span<const Box3d> children) {
    Box3d box = children[0];
    if (extent == ExtentOf::first_child) return box;
    for (const Box3d& child : children.subspan(1))
      if (extent == ExtentOf::all_children)
        box = intersect(box, child);
      else
        box.extend(child);
    return box.is_empty() ? Box3d{} : box;
  }

  bool to_world(uint32_t space, Box3d& box) const {
    for (uint32_t i = space; i != 0; i = program_.spaces[i].parent) {
      const Space &a = program_.spaces[i], &b = end_.spaces[i];
      if (a.warp != Space::k_no_warp)
        std::visit(
            [&](const auto& middle) {
              using K = std::decay_t<decltype(middle)>;
              if constexpr (Warp<K>)
                box = grown(middle.image_of(box), displacement(middle, std::get<K>(program_.field.nodes[a.warp]),
                                                               std::get<K>(end_.field.nodes[a.warp]), box, WarpWay::to_parent));
            },
            middle_.nodes[a.warp]);
      if (!preimage(a.local_from_parent, b.local_from_parent, box)) return false;
    }
    return true;
  }

  const FieldProgram &program_, &end_;
  const SampledField& middle_;
  std::vector<Box3d> boxes_; ///< of the steps so far, in the world
};

} // namespace

bool find_support(const FieldProgram& program, const Motion* motion, Box3d& out) { return SupportFinder(program, motion).run(out); }

} // namespace kelpie
