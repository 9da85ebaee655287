#include "tests/reference/field.h"

#include <algorithm>
#include <limits>

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

namespace {

/// R-functions, localised (methods.md section 2).
double r_join(bool is_union, double a, double b, double threshold) {
  const double sign = is_union ? 1 : -1, scale = 1 / (2 - sign * std::sqrt(2.0));
  const auto plain = [&](double f, double g) {
    return threshold + scale * ((f - threshold) + (g - threshold) + sign * std::hypot(f - threshold, g - threshold));
  };
  const auto k = [&](double f) { return f < threshold ? (1 - f / threshold) * (1 - f / threshold) : 0.0; };
  a = std::max(0.0, a), b = std::max(0.0, b);
  if (is_union) return plain(a, b) + k(a) * (b - plain(0, b)) + k(b) * (a - plain(a, 0));
  return plain(a, b) - k(a) * plain(0, b) - k(b) * plain(a, 0);
}

double hyper_blend(const std::vector<double>& f, double n) {
  const double m = *std::max_element(f.begin(), f.end());
  if (m <= 0) return 0;
  double sum = 0;
  for (const double x : f) sum += x > 0 ? std::pow(x / m, n) : 0;
  return m * std::pow(sum, 1 / n);
}

double local_blend(const std::vector<double>& f) {
  const double region = std::clamp(f.back(), 0.0, 1.0);
  double sum = 0;
  for (size_t i = 0; i + 1 < f.size(); ++i) sum += f[i];
  return region * sum + (1 - region) * *std::max_element(f.begin(), f.end() - 1);
}

} // namespace

Vec untwisted(const Node& node, Vec p) {
  const Vec e = node.axis * (1 / length(node.axis)), q = p - node.centre;
  double height = dot(q, e);
  if (node.length > 0) height = std::clamp(height, 0.0, node.length);
  const double angle = -height * node.rate * std::acos(-1.0) / 180, c = std::cos(angle), s = std::sin(angle);
  const Vec cross{e.y * q.z - e.z * q.y, e.z * q.x - e.x * q.z, e.x * q.y - e.y * q.x};
  return node.centre + q * c + cross * s + e * (dot(e, q) * (1 - c));
}

Unbent unbent(const Node& node, Vec p) {
  const double infinity = std::numeric_limits<double>::infinity(), pi = std::acos(-1.0);
  if (node.angle == 0) return {p, infinity, infinity};
  const Vec e = node.axis * (1 / length(node.axis)), side = node.towards - e * dot(node.towards, e);
  const Vec t = side * ((node.angle < 0 ? -1 : 1) / length(side));
  const double end = std::abs(node.angle) * pi / 180, radius = node.length / end;
  const Vec q = p - (node.centre + t * radius); // from the bend axis; the line is at -t * radius
  const double x = -dot(q, t), z = dot(q, e), d = std::hypot(x, z), middle = end / 2;
  // From the middle of the arc, in [-pi, pi], so that the jump is at the ends.
  const double from_middle = d > 0 ? std::remainder(std::atan2(z, x) - middle, 2 * pi) : 0;
  const double turned = std::clamp(from_middle, -middle, middle) + middle;
  // Back by `turned`, then up along the line by the arc's length.
  const double bx = x * std::cos(turned) + z * std::sin(turned), bz = z * std::cos(turned) - x * std::sin(turned);
  const double past = pi - std::abs(from_middle);
  return {p + t * (x - bx) + e * (bz - z + turned * radius), d / radius, past < pi / 2 ? d * std::sin(past) : d};
}

double value(const Node& node, Vec p, double threshold, bool is_below_blend) {
  using Kind = Node::Kind;
  if (node.kind == Kind::twist) return value(*node.children[0], untwisted(node, p), threshold, is_below_blend);
  if (node.kind == Kind::bend) return value(*node.children[0], unbent(node, p).p, threshold, is_below_blend);
  if (node.kind == Kind::warp) return value(*node.children[0], node.child_from_parent.point(p), threshold, is_below_blend);
  if (node.kind == Kind::leaves) {
    double sum = 0;
    for (const Leaf& leaf : node.leaves) sum += value(leaf, p);
    return sum;
  }
  const bool blends = node.kind == Kind::blend || node.kind == Kind::hyper_blend || node.kind == Kind::local_blend;
  const bool below = is_below_blend || (blends && node.children.size() > 1);
  std::vector<double> f;
  for (const NodePtr& child : node.children) f.push_back(value(*child, p, threshold, below));
  if (node.kind == Kind::hyper_blend) return hyper_blend(f, node.n);
  if (node.kind == Kind::local_blend) return local_blend(f);
  const bool is_r = is_below_blend && (node.kind == Kind::r_unite || node.kind == Kind::r_intersect || node.kind == Kind::r_subtract);
  if (is_r && f.size() == 1) return std::max(0.0, f[0]);
  double result = f[0];
  for (size_t i = 1; i < f.size(); ++i) {
    switch (node.kind) {
    case Kind::blend: result += f[i]; break;
    case Kind::unite: result = std::max(result, f[i]); break;
    case Kind::intersect: result = std::min(result, f[i]); break;
    case Kind::r_unite: result = is_r ? r_join(true, result, f[i], threshold) : std::max(result, f[i]); break;
    case Kind::r_intersect: result = is_r ? r_join(false, result, f[i], threshold) : std::min(result, f[i]); break;
    case Kind::r_subtract:
      result = is_r ? r_join(false, result, 2 * threshold - f[i], threshold) : std::min(result, 2 * threshold - f[i]);
      break;
    default: result = std::min(result, 2 * threshold - f[i]); break;
    }
  }
  return node.kind == Kind::subtract || node.kind == Kind::r_subtract ? std::max(0.0, result) : result;
}

} // namespace reference
