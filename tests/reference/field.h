// The fields that the reference knows, straight from the formulas (methods.md, sections 1 and 2).
#pragma once

#include <memory>
#include <vector>

#include "tests/reference/vec.h"

namespace reference {

enum class Falloff { quartic, cubic, wyvill };

/// weight * falloff(d^2 / radius^2), d the distance to a solid.
struct Leaf {
  enum class Shape {
    segment,     ///< from a to b (a = b: a point)
    cone_sphere, ///< the convex hull of the balls of radius r around a and s around b
    disc,        ///< of radius r around a, perpendicular to `normal`
    torus,       ///< the tube of radius s around the circle of radius r around a, perpendicular to `normal`
  };
  Vec a, b;
  double radius = 1, weight = 1;
  Falloff falloff = Falloff::quartic;
  Shape shape = Shape::segment;
  double r = 0, s = 0;
  Vec normal{0, 1, 0};
};

/// The distance from p to the solid of a leaf; 0 inside.
double distance(const Leaf&, Vec p);

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
