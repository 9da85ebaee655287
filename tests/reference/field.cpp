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

double distance_to_segment(Vec a, Vec b, Vec p) {
  const Vec axis = b - a;
  const double squared = dot(axis, axis);
  const double s = squared > 0 ? std::clamp(dot(p - a, axis) / squared, 0.0, 1.0) : 0.0;
  return length(p - (a + axis * s));
}

/// The hull is all the balls between the two; the nearest of them by golden sections, for the distance to
/// a ball is convex in where it is.
double distance_to_cone_sphere(const Leaf& leaf, Vec p) {
  const auto to_ball = [&](double s) { return length(p - (leaf.a * (1 - s) + leaf.b * s)) - (leaf.r * (1 - s) + leaf.s * s); };
  constexpr double k_golden = 0.6180339887498949;
  double lo = 0, hi = 1, s = 1 - k_golden, t = k_golden, at_s = to_ball(s), at_t = to_ball(t);
  for (int i = 0; i < 40; ++i) {
    if (at_s < at_t) {
      hi = t, t = s, at_t = at_s, s = hi - k_golden * (hi - lo), at_s = to_ball(s);
    } else {
      lo = s, s = t, at_s = at_t, t = lo + k_golden * (hi - lo), at_t = to_ball(t);
    }
  }
  return std::max(0.0, std::min({at_s, at_t, to_ball(0), to_ball(1)}));
}

/// The nearest point of a circle lies in the plane of p and the axis.
double distance_to_circle(const Leaf& leaf, Vec p, bool is_filled) {
  const Vec n = leaf.normal * (1 / length(leaf.normal)), q = p - leaf.a;
  const double height = dot(q, n), out = length(q - n * height);
  const double rim = is_filled ? std::max(0.0, out - leaf.r) : out - leaf.r;
  return std::sqrt(height * height + rim * rim);
}

double value(const Leaf& leaf, Vec p) {
  const double d = distance(leaf, p);
  return leaf.weight * falloff(leaf.falloff, d * d / (leaf.radius * leaf.radius));
}

} // namespace

double distance(const Leaf& leaf, Vec p) {
  switch (leaf.shape) {
  case Leaf::Shape::segment: return distance_to_segment(leaf.a, leaf.b, p);
  case Leaf::Shape::cone_sphere: return distance_to_cone_sphere(leaf, p);
  case Leaf::Shape::disc: return distance_to_circle(leaf, p, true);
  case Leaf::Shape::torus: return std::max(0.0, distance_to_circle(leaf, p, false) - leaf.s);
  }
  return 0;
}

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
