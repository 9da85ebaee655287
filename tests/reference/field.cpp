#include "tests/reference/field.h"

#include <algorithm>

namespace reference {

namespace {

double falloff(Falloff f, double u) {
  if (u >= 1) return 0;
  switch (f) {
  case Falloff::quartic: return (1 - u) * (1 - u);
  case Falloff::cubic: return (1 - u) * (1 - u) * (1 - u);
  case Falloff::wyvill: return 1 - 22 * u / 9 + 17 * u * u / 9 - 4 * u * u * u / 9;
  }
  return 0;
}

double distance(const Leaf& leaf, Vec p) {
  const Vec axis = leaf.b - leaf.a;
  const double squared = dot(axis, axis);
  const double s = squared > 0 ? std::clamp(dot(p - leaf.a, axis) / squared, 0.0, 1.0) : 0.0;
  return length(p - (leaf.a + axis * s));
}

double value(const Leaf& leaf, Vec p) {
  const double d = distance(leaf, p);
  return leaf.weight * falloff(leaf.falloff, d * d / (leaf.radius * leaf.radius));
}

} // namespace

double value(const Node& node, Vec p, double threshold) {
  if (node.kind == Node::Kind::warp) return value(*node.children[0], node.child_from_parent.point(p), threshold);
  if (node.kind == Node::Kind::leaves) {
    double sum = 0;
    for (const Leaf& leaf : node.leaves) sum += value(leaf, p);
    return sum;
  }
  double f = value(*node.children[0], p, threshold);
  for (size_t i = 1; i < node.children.size(); ++i) {
    const double g = value(*node.children[i], p, threshold);
    if (node.kind == Node::Kind::blend) f += g;
    if (node.kind == Node::Kind::unite) f = std::max(f, g);
    if (node.kind == Node::Kind::intersect) f = std::min(f, g);
    if (node.kind == Node::Kind::subtract) f = std::min(f, 2 * threshold - g);
  }
  return node.kind == Node::Kind::subtract ? std::max(0.0, f) : f;
}

} // namespace reference
