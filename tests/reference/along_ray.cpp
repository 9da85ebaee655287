#include "tests/reference/along_ray.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "tests/reference/interpolate.h"

namespace reference {

namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
/// Differences this far below the operands' size are rounding, not crossings.
constexpr double k_noise = 1e-13;

/// One polynomial stretch of a leaf: w * falloff(1 - q), q = 1 - d^2/R^2 > 0, between from and to. The
/// distance is that to the point `centre`, or to the line through it along the unit vector `axis`.
struct Bump {
  Vec centre, axis;
  double inverse_r2, weight;
  Falloff falloff;
  double from, to;

  /// The polar form of d^2/R^2: at (t, t) it is the value, at the ends of a stretch the middle coefficient.
  double polar(Vec p, Vec q) const {
    const Vec x = p - centre, y = q - centre;
    return (dot(x, y) - dot(x, axis) * dot(y, axis)) * inverse_r2;
  }

  Polynomial on(const Ray& ray, double a, double b) const {
    const Vec p = ray.at(a), r = ray.at(b);
    const Quadratic q{std::max(0.0, 1 - polar(p, p)), 1 - polar(p, r), std::max(0.0, 1 - polar(r, r))};
    switch (falloff) {
    case Falloff::quartic: return square_times_linear(q, weight, 0);
    case Falloff::cubic: return square_times_linear(q, 0, weight);
    case Falloff::wyvill: return square_times_linear(q, weight * 5 / 9, weight * 4 / 9);
    case Falloff::distance: break; // of no segment
    }
    return {};
  }
};

/// Where d^2 < R^2 for the point or line of a bump; none if never.
std::optional<Span> support(const Bump& bump, const Ray& ray) {
  const Vec x = ray.origin - bump.centre;
  const double xe = dot(x, bump.axis), de = dot(ray.direction, bump.axis);
  const double a = dot(ray.direction, ray.direction) - de * de;
  const double tiny = 1e-14 * dot(ray.direction, ray.direction);
  if (a <= tiny) { // along the axis: the distance does not change
    if (dot(x, x) - xe * xe >= 1 / bump.inverse_r2) return std::nullopt;
    return Span{-k_infinity, k_infinity};
  }
  // From the nearest point on, so that a far origin costs no accuracy.
  const double nearest = -(dot(x, ray.direction) - xe * de) / a;
  const Vec y = ray.at(nearest) - bump.centre;
  const double ye = dot(y, bump.axis), rest = 1 / bump.inverse_r2 - (dot(y, y) - ye * ye);
  if (rest <= 0) return std::nullopt;
  const double half = std::sqrt(rest / a);
  return Span{nearest - half, nearest + half};
}

void add_bump(Bump bump, const Ray& ray, Span within, std::vector<Bump>& out) {
  const std::optional<Span> s = support(bump, ray);
  if (!s) return;
  bump.from = std::max(s->from, within.from);
  bump.to = std::min(s->to, within.to);
  if (bump.from < bump.to) out.push_back(bump);
}

/// A segment is up to three bumps: round its first end, along it, round its other end.
void add_leaf(const Leaf& leaf, const Ray& ray, Span within, std::vector<Bump>& out) {
  const Vec span = leaf.b - leaf.a;
  const double size = length(span);
  const Bump around_a{leaf.a, {}, 1 / (leaf.radius * leaf.radius), leaf.weight, leaf.falloff, 0, 0};
  if (size == 0) return add_bump(around_a, ray, within, out);
  Bump around_b = around_a, between = around_a;
  around_b.centre = leaf.b;
  between.axis = span * (1 / size);
  // Where along the axis the ray is: start + rate t, in [0, size] between the ends.
  const double start = dot(ray.origin - leaf.a, between.axis), rate = dot(ray.direction, between.axis);
  if (std::abs(rate) < 1e-14 * length(ray.direction))
    return add_bump(start < 0 ? around_a : start > size ? around_b : between, ray, within, out);
  const double at_a = -start / rate, at_b = (size - start) / rate;
  const double first = std::min(at_a, at_b), second = std::max(at_a, at_b);
  const Bump &before = rate > 0 ? around_a : around_b, &after = rate > 0 ? around_b : around_a;
  add_bump(before, ray, {within.from, std::min(within.to, first)}, out);
  add_bump(between, ray, {std::max(within.from, first), std::min(within.to, second)}, out);
  add_bump(after, ray, {std::max(within.from, second), within.to}, out);
}

/// The sum of leaves: breaks at every bump's ends, and between two breaks the sum of what lives there.
Profile sum_of_leaves(const std::vector<Leaf>& leaves, const Ray& ray, Span within) {
  std::vector<Bump> bumps;
  for (const Leaf& leaf : leaves) add_leaf(leaf, ray, within, bumps);
  std::sort(bumps.begin(), bumps.end(), [](const Bump& a, const Bump& b) { return a.from < b.from; });
  std::vector<double> breaks{within.from, within.to};
  for (const Bump& b : bumps) breaks.push_back(b.from), breaks.push_back(b.to);
  std::sort(breaks.begin(), breaks.end());

  Profile profile;
  std::vector<const Bump*> live;
  size_t next = 0;
  for (size_t i = 0; i + 1 < breaks.size(); ++i) {
    const double a = breaks[i], b = breaks[i + 1];
    if (!(a < b)) continue;
    while (next < bumps.size() && bumps[next].from <= a) live.push_back(&bumps[next++]);
    std::erase_if(live, [&](const Bump* bump) { return bump->to <= a; });
    Piece piece{a, b, {}};
    for (const Bump* bump : live) piece.f = piece.f + bump->on(ray, a, b);
    profile.push_back(piece);
  }
  return profile;
}

/// Calls join(from, to, f, g) for every stretch on which both profiles are one polynomial.
template <class Join>
void for_common_pieces(const Profile& f, const Profile& g, Join&& join) {
  const auto part = [](const Piece& p, double a, double b) {
    const double size = p.to - p.from;
    return p.f.part(std::clamp((a - p.from) / size, 0.0, 1.0), std::clamp((b - p.from) / size, 0.0, 1.0));
  };
  for (size_t i = 0, j = 0; i < f.size() && j < g.size();) {
    const double a = std::max(f[i].from, g[j].from), b = std::min(f[i].to, g[j].to);
    if (a < b) join(a, b, part(f[i], a, b), part(g[j], a, b));
    const bool advance_f = f[i].to <= g[j].to, advance_g = g[j].to <= f[i].to;
    i += advance_f, j += advance_g;
  }
}

Profile sum(const Profile& f, const Profile& g) {
  Profile r;
  for_common_pieces(f, g, [&](double a, double b, const Polynomial& p, const Polynomial& q) { r.push_back({a, b, p + q}); });
  return r;
}

Profile most(const Profile& f, const Profile& g) {
  Profile r;
  for_common_pieces(f, g, [&](double a, double b, const Polynomial& p, const Polynomial& q) {
    const Polynomial d = p - q;
    const double size = std::max({std::abs(p.least()), std::abs(p.most()), std::abs(q.least()), std::abs(q.most())});
    std::vector<double> ends = sign_changes(d, k_noise * size);
    ends.push_back(1);
    double from = 0;
    for (const double to : ends) {
      if (!(from < to)) continue;
      const Polynomial& larger = d(0.5 * (from + to)) > 0 ? p : q;
      r.push_back({a + from * (b - a), a + to * (b - a), larger.part(from, to)});
      from = to;
    }
    r.back().to = b;
  });
  return r;
}

Profile negative(Profile f) {
  for (Piece& p : f) p.f = -p.f;
  return f;
}

Profile least(const Profile& f, const Profile& g) { return negative(most(negative(f), negative(g))); }

Profile join(Node::Kind kind, const Profile& f, const Profile& g, const Profile& twice_threshold) {
  switch (kind) {
  case Node::Kind::blend: return sum(f, g);
  case Node::Kind::unite: return most(f, g);
  case Node::Kind::intersect: return least(f, g);
  default: return least(f, sum(twice_threshold, negative(g)));
  }
}

/// The sign of f - level, stretch by stretch: calls visit(from, to, is_above).
template <class Visit>
void for_signs(const Piece& piece, double level, Visit&& visit) {
  if (piece.f.most() <= level) return visit(piece.from, piece.to, false);
  if (piece.f.least() > level) return visit(piece.from, piece.to, true);
  const Polynomial d = piece.f - constant(level);
  std::vector<double> ends = sign_changes(d, k_noise * std::max(std::abs(piece.f.most()), std::abs(piece.f.least())));
  ends.push_back(1);
  double from = 0;
  for (const double to : ends) {
    const double size = piece.to - piece.from, end = to < 1 ? piece.from + to * size : piece.to;
    visit(piece.from + from * size, end, d(0.5 * (from + to)) > 0);
    from = to;
  }
}

bool is_piecewise_polynomial(const Node& node) {
  if (node.kind > Node::Kind::warp) return false;
  return std::all_of(node.leaves.begin(), node.leaves.end(), [](const Leaf& leaf) { return leaf.shape == Leaf::Shape::segment; }) &&
         std::all_of(node.children.begin(), node.children.end(), [](const NodePtr& child) { return is_piecewise_polynomial(*child); });
}

Profile exact_along_ray(const Node& node, const Ray& ray, double t_from, double t_to, double threshold) {
  if (node.kind == Node::Kind::leaves) return sum_of_leaves(node.leaves, ray, {t_from, t_to});
  if (node.kind == Node::Kind::warp) {
    const Ray inner{node.child_from_parent.point(ray.origin), node.child_from_parent.direction(ray.direction)};
    return exact_along_ray(*node.children[0], inner, t_from, t_to, threshold);
  }
  Profile f = exact_along_ray(*node.children[0], ray, t_from, t_to, threshold);
  const Profile twice_threshold{{t_from, t_to, constant(2 * threshold)}};
  for (size_t i = 1; i < node.children.size(); ++i)
    f = join(node.kind, f, exact_along_ray(*node.children[i], ray, t_from, t_to, threshold), twice_threshold);
  if (node.kind == Node::Kind::subtract) f = most(f, {{t_from, t_to, constant(0)}});
  return f;
}

} // namespace

Profile along_ray(const Node& node, const Ray& ray, double t_from, double t_to, double threshold) {
  return is_piecewise_polynomial(node) ? exact_along_ray(node, ray, t_from, t_to, threshold)
                                       : interpolated_along_ray(node, ray, t_from, t_to, threshold);
}

double value(const Profile& profile, double t) {
  for (const Piece& p : profile)
    if (t <= p.to) return p.f((t - p.from) / (p.to - p.from));
  return 0;
}

std::vector<Span> above(const Profile& profile, double level) {
  std::vector<Span> spans;
  for (const Piece& piece : profile)
    for_signs(piece, level, [&](double from, double to, bool is_above) {
      if (!is_above) return;
      if (!spans.empty() && spans.back().to == from)
        spans.back().to = to;
      else
        spans.push_back({from, to});
    });
  return spans;
}

bool reaches(const Profile& profile, double level, double from, double to) {
  bool found = false;
  for (const Piece& piece : profile) {
    if (piece.to < from || piece.from > to) continue;
    for_signs(piece, level, [&](double a, double b, bool is_above) { found |= is_above && a <= to && b >= from; });
  }
  return found;
}

} // namespace reference
