// The fields that the reference knows, straight from the formulas (methods.md, sections 1 and 2).
#pragma once

#include <memory>
#include <vector>

#include "tests/reference/vec.h"

namespace reference {

enum class Falloff { quartic, cubic, wyvill };

/// weight * falloff(d^2 / radius^2), d the distance to the segment from a to b (a = b: a point).
struct Leaf {
  Vec a, b;
  double radius = 1, weight = 1;
  Falloff falloff = Falloff::quartic;
};

struct Node;
using NodePtr = std::shared_ptr<const Node>;

/// `leaves` stands for their sum; the other kinds have children.
struct Node {
  enum class Kind { leaves, blend, unite, intersect, subtract, warp } kind = Kind::leaves;
  std::vector<Leaf> leaves;
  std::vector<NodePtr> children;
  Affine child_from_parent; ///< of a warp: f(p) = f_child(W^-1 p)
};

/// The field f at p; `threshold` is T of the shape, which a difference needs.
double value(const Node&, Vec p, double threshold);

} // namespace reference
