#include "tests/reference/field.h"

#include <algorithm>
#include <limits>

namespace reference {

namespace {

double falloff(Falloff f, double u) {
  if (u >= 1) return 0;
  switch (f) {
  case Falloff::distance: break; // not of u
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

/// The nearest point of a circle lies in the plane of p and the axis.
double distance_to_circle(const Leaf& leaf, Vec p, bool is_filled) {
  const Vec n = leaf.normal * (1 / length(leaf.normal)), q = p - leaf.a;
  const double height = dot(q, n), out = length(q - n * height);
  const double rim = is_filled ? std::max(0.0, out - leaf.r) : out - leaf.r;
  return std::sqrt(height * height + rim * rim);
}

/// The least of a function that is convex on [0, 1], by golden sections.
template <class F>
double least(const F& f) {
  constexpr double k_golden = 0.6180339887498949;
  double lo = 0, hi = 1, s = 1 - k_golden, t = k_golden, at_s = f(s), at_t = f(t);
  for (int i = 0; i < 48; ++i) {
    if (at_s < at_t) {
      hi = t, t = s, at_t = at_s, s = hi - k_golden * (hi - lo), at_s = f(s);
    } else {
      lo = s, s = t, at_s = at_t, t = lo + k_golden * (hi - lo), at_t = f(t);
    }
  }
  return std::min({at_s, at_t, f(0.0), f(1.0)});
}

/// The hull is all the balls between the two.
double distance_to_cone_sphere(const Leaf& leaf, Vec p) {
  return std::max(0.0, least([&](double s) { return length(p - (leaf.a * (1 - s) + leaf.b * s)) - (leaf.r * (1 - s) + leaf.s * s); }));
}

/// p seen from a solid of revolution: how far out from the axis, and how far along it.
struct AroundAxis {
  double out, along, length;

  AroundAxis(const Leaf& leaf, Vec p) {
    const Vec axis = leaf.b - leaf.a, q = p - leaf.a;
    length = reference::length(axis);
    const Vec e = length > 0 ? axis * (1 / length) : Vec{0, 1, 0};
    along = dot(q, e), out = reference::length(q - e * along);
  }
};

double distance_to_cone(const Leaf& leaf, Vec p) {
  const AroundAxis q(leaf, p);
  return least([&](double s) { return std::hypot(std::max(0.0, q.out - (leaf.r * (1 - s) + leaf.s * s)), q.along - s * q.length); });
}

/// The wall's sections across it, cut off at the axis.
double distance_to_wall(const Leaf& leaf, Vec p) {
  const AroundAxis q(leaf, p);
  const double rise = leaf.s - leaf.r, slant = std::hypot(rise, q.length);
  const double across = slant > 0 ? q.length / slant : 1, up = slant > 0 ? -rise / slant : 0;
  return least([&](double s) {
    const double out = leaf.r + s * rise, along = s * q.length, half = 0.5 * (leaf.r_thickness * (1 - s) + leaf.s_thickness * s);
    const double low = across * half > out ? -out / across : -half;
    const double t = std::clamp((q.out - out) * across + (q.along - along) * up, low, half);
    return std::hypot(q.out - out - t * across, q.along - along - t * up);
  });
}

double distance_to_arc(const Leaf& leaf, Vec p) {
  const Vec n = leaf.normal * (1 / length(leaf.normal)), side = leaf.towards - n * dot(leaf.towards, n), t = side * (1 / length(side));
  const Vec q = p - leaf.a, flat = q - n * dot(q, n);
  const double x = dot(flat, t), y = length(flat - t * x), half = leaf.angle * std::acos(-1.0) / 360;
  const double in_plane = std::atan2(y, x) <= half && half > 0 ? std::hypot(x, y) - leaf.r
                                                               : std::hypot(x - leaf.r * std::cos(half), y - leaf.r * std::sin(half));
  return std::hypot(in_plane, dot(q, n));
}

double distance_to_box(const Leaf& leaf, Vec p) {
  const Vec n = leaf.normal * (1 / length(leaf.normal)), side = leaf.towards - n * dot(leaf.towards, n), t = side * (1 / length(side));
  const Vec q = p - leaf.a;
  const double x = std::abs(dot(q, t)), y = std::abs(dot(q, n)), z = length(q - n * dot(q, n) - t * dot(q, t));
  const Vec out{std::max(0.0, x - leaf.size.x / 2), std::max(0.0, y - leaf.size.y / 2), std::max(0.0, z - leaf.size.z / 2)};
  return length(out);
}

Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

/// Every hull is all the segments, triangles and tetrahedra between its points.
double distance_to_hull(const std::vector<Vec>& v, Vec p) {
  const size_t n = v.size();
  double nearest = length(p - v[0]);
  for (size_t i = 0; i < n; ++i)
    for (size_t j = i + 1; j < n; ++j) {
      nearest = std::min(nearest, distance_to_segment(v[i], v[j], p));
      for (size_t k = j + 1; k < n; ++k) {
        const Vec a = v[i] - p, b = v[j] - p, c = v[k] - p, m = cross(b - a, c - a);
        const double area = length(m), size = std::max(length(b - a), length(c - a));
        if (area <= 1e-12 * size * size) continue;
        const bool is_over = dot(m, cross(b, c)) >= 0 && dot(m, cross(c, a)) >= 0 && dot(m, cross(a, b)) >= 0;
        if (is_over) nearest = std::min(nearest, std::abs(dot(a, m)) / area);
        for (size_t l = k + 1; l < n; ++l) { // p as a mean of the four corners, by Cramer's rule
          const Vec d = v[l] - p;
          const double whole = dot(d - a, m);
          if (std::abs(whole) <= 1e-12 * area * length(d - a)) continue;
          const double of_d = -dot(a, m) / whole, of_a = dot(b, cross(c, d)) / whole, of_b = -dot(a, cross(c, d)) / whole,
                       of_c = dot(a, cross(b, d)) / whole;
          if (of_a >= 0 && of_b >= 0 && of_c >= 0 && of_d >= 0) return 0;
        }
      }
    }
  return nearest;
}

/// Where p is on three axes of a box.
Vec on_axes(const Leaf& leaf, Vec p) {
  const Vec n = leaf.normal * (1 / length(leaf.normal)), side = leaf.towards - n * dot(leaf.towards, n), t = side * (1 / length(side));
  const Vec q = p - leaf.a, rest = q - n * dot(q, n) - t * dot(q, t);
  return {std::abs(dot(q, t)), std::abs(dot(q, n)), length(rest)};
}

/// The nearest face from inside, the nearest point of all faces from outside.
double signed_distance_to_block(const Leaf& leaf, Vec p) {
  const Vec q = on_axes(leaf, p) - (leaf.size * 0.5 - Vec{leaf.r, leaf.r, leaf.r});
  const double inside = std::max({q.x, q.y, q.z});
  return (inside <= 0 ? inside : length({std::max(0.0, q.x), std::max(0.0, q.y), std::max(0.0, q.z)})) - leaf.r;
}
double signed_distance_to_rod(const Leaf& leaf, Vec p) {
  const AroundAxis q(leaf, p);
  const double out = q.out - leaf.r, above = std::max(-q.along, q.along - q.length);
  return std::max(out, above) <= 0 ? std::max(out, above) : std::hypot(std::max(0.0, out), std::max(0.0, above));
}

/// What a sample `away` steps from a place, along an axis, counts there: the uniform cubic B-spline, by its two pieces.
double spline_weight(double away) {
  const double x = std::abs(away);
  if (x < 1) return 2.0 / 3 - x * x + x * x * x / 2;
  return x < 2 ? (2 - x) * (2 - x) * (2 - x) / 6 : 0;
}
/// The sum of all samples near, each by its weight; beyond the table, as far as its first value.
double interpolated(const Leaf& leaf, Vec p) {
  const Table& table = *leaf.table;
  const Vec q = (p - leaf.a) * (1 / table.step);
  const double u[] = {q.x, q.y, q.z};
  int near[3];
  for (int i = 0; i < 3; ++i) {
    if (!(u[i] >= 0 && u[i] <= table.count[i])) return table.values[0];
    near[i] = int(std::floor(u[i]));
  }
  double sum = 0;
  for (int z = near[2] - 1; z <= near[2] + 2; ++z)
    for (int y = near[1] - 1; y <= near[1] + 2; ++y)
      for (int x = near[0] - 1; x <= near[0] + 2; ++x) {
        const bool is_in = x >= 0 && y >= 0 && z >= 0 && x < table.count[0] && y < table.count[1] && z < table.count[2];
        const double value = table.values[is_in ? size_t((z * table.count[1] + y) * table.count[0] + x) : 0];
        sum += spline_weight(u[0] - x) * spline_weight(u[1] - y) * spline_weight(u[2] - z) * value;
      }
  return sum;
}

double value(const Leaf& leaf, Vec p, double threshold) {
  if (!may_be_within(leaf, p, leaf.radius)) return 0;
  const double d = distance(leaf, p);
  if (leaf.falloff == Falloff::distance) return leaf.weight * threshold * std::clamp(1 - d / leaf.radius, 0.0, 2.0);
  return leaf.weight * falloff(leaf.falloff, std::max(0.0, d) * std::max(0.0, d) / (leaf.radius * leaf.radius));
}

} // namespace

double distance(const Leaf& leaf, Vec p) {
  switch (leaf.shape) {
  case Leaf::Shape::segment: return distance_to_segment(leaf.a, leaf.b, p);
  case Leaf::Shape::cone_sphere: return distance_to_cone_sphere(leaf, p);
  case Leaf::Shape::disc: return distance_to_circle(leaf, p, true);
  case Leaf::Shape::torus: return std::max(0.0, distance_to_circle(leaf, p, false) - leaf.s);
  case Leaf::Shape::arc: return distance_to_arc(leaf, p);
  case Leaf::Shape::cone: return distance_to_cone(leaf, p);
  case Leaf::Shape::wall: return distance_to_wall(leaf, p);
  case Leaf::Shape::box: return distance_to_box(leaf, p);
  case Leaf::Shape::hull: return distance_to_hull(leaf.points, p);
  case Leaf::Shape::capsule: return distance_to_segment(leaf.a, leaf.b, p) - leaf.r;
  case Leaf::Shape::ring: return distance_to_circle(leaf, p, false) - leaf.s;
  case Leaf::Shape::block: return signed_distance_to_block(leaf, p);
  case Leaf::Shape::rod: return signed_distance_to_rod(leaf, p);
  case Leaf::Shape::table: return interpolated(leaf, p);
  case Leaf::Shape::below: return dot(p - leaf.a, leaf.normal) / length(leaf.normal);
  }
  return 0;
}

bool may_be_within(const Leaf& leaf, Vec p, double reach) {
  if (leaf.shape != Leaf::Shape::hull) return distance(leaf, p) < reach;
  double farthest = 0; // that of a whole hull is dear: its points lie in a ball around the first
  for (const Vec& v : leaf.points) farthest = std::max(farthest, length(v - leaf.points[0]));
  const double to_first = length(p - leaf.points[0]);
  return to_first < reach || (to_first - farthest < reach && distance(leaf, p) < reach);
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

Vec untapered(const Node& node, Vec p) {
  const Vec e = node.axis * (1 / length(node.axis)), q = p - node.centre;
  const double height = dot(q, e), part = std::clamp(height / node.length, 0.0, 1.0);
  return node.centre + e * height + (q - e * height) * (1 / (1 - part + part * node.by));
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

double value(const Node& node, Vec p, double threshold) {
  using Kind = Node::Kind;
  if (node.kind == Kind::twist) return value(*node.children[0], untwisted(node, p), threshold);
  if (node.kind == Kind::taper) return value(*node.children[0], untapered(node, p), threshold);
  if (node.kind == Kind::axial) return value(*node.children[0], undeformed(*node.axial, p), threshold);
  if (node.kind == Kind::bend) return value(*node.children[0], unbent(node, p).p, threshold);
  if (node.kind == Kind::warp) return value(*node.children[0], node.child_from_parent.point(p), threshold);
  if (node.kind == Kind::leaves) {
    double sum = 0;
    for (const Leaf& leaf : node.leaves) sum += value(leaf, p, threshold);
    return sum;
  }
  std::vector<double> f;
  for (const NodePtr& child : node.children) f.push_back(value(*child, p, threshold));
  if (node.kind == Kind::hyper_blend) return hyper_blend(f, node.n);
  if (node.kind == Kind::local_blend) return local_blend(f);
  if (node.kind == Kind::mix) return mixed(*node.mix, f, threshold);
  const bool is_r = node.kind == Kind::r_unite || node.kind == Kind::r_intersect || node.kind == Kind::r_subtract;
  if (is_r && f.size() == 1) return std::max(0.0, f[0]);
  double result = f[0];
  for (size_t i = 1; i < f.size(); ++i) {
    switch (node.kind) {
    case Kind::blend: result += f[i]; break;
    case Kind::unite: result = std::max(result, f[i]); break;
    case Kind::intersect: result = std::min(result, f[i]); break;
    case Kind::r_unite: result = r_join(true, result, f[i], threshold); break;
    case Kind::r_intersect: result = r_join(false, result, f[i], threshold); break;
    case Kind::r_subtract: result = r_join(false, result, 2 * threshold - f[i], threshold); break;
    default: result = std::min(result, 2 * threshold - f[i]); break;
    }
  }
  return node.kind == Kind::subtract ? std::max(0.0, result) : result;
}

} // namespace reference
