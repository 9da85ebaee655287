#include "tests/reference/axial.h"

#include <algorithm>
#include <limits>

namespace reference {

namespace {

constexpr int k_steps_a_piece = 512, k_coarse = 16;

Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
Vec unit(Vec a) { return a * (1 / length(a)); }

int degree_of(const Axis& axis) { return std::min(axis.degree, int(axis.rest.size()) - 1); }

/// A clamped uniform B-spline; t in units of pieces. `piece` says which polynomial is meant at a knot.
Vec spline(const std::vector<Vec>& points, int degree, int piece, double t) {
  const int pieces = int(points.size()) - degree;
  const auto knot = [&](int i) { return double(std::clamp(i - degree, 0, pieces)); };
  std::vector<Vec> d(points.begin() + piece, points.begin() + piece + degree + 1);
  for (int r = 1; r <= degree; ++r)
    for (int j = degree; j >= r; --j) {
      const double from = knot(j + piece), to = knot(j + 1 + piece + degree - r), a = (t - from) / (to - from);
      d[j] = d[j - 1] * (1 - a) + d[j] * a;
    }
  return d[degree];
}

/// By differences that are exact for cubics, up to rounding: five points.
Vec derivative(const std::vector<Vec>& points, int degree, int piece, double t) {
  const double h = 0.01;
  const auto at = [&](double s) { return spline(points, degree, piece, s); };
  return (at(t - 2 * h) - at(t - h) * 8 + at(t + h) * 8 - at(t + 2 * h)) * (1 / (12 * h));
}

Vec tangent(const std::vector<Vec>& points, int degree, int piece, double t) { return unit(derivative(points, degree, piece, t)); }

/// Frames that do not turn about the curve: y' = -(y . z') z, by Runge and Kutta's method.
std::vector<Axis::Node> walk(const std::vector<Vec>& points, int degree, Vec normal) {
  std::vector<Axis::Node> nodes;
  const int pieces = int(points.size()) - degree;
  const double h = 1.0 / k_steps_a_piece;
  Vec y = normal;
  for (int piece = 0; piece < pieces; ++piece) {
    const auto slope = [&](double t, Vec v) {
      const double e = 1e-3;
      const Vec z = tangent(points, degree, piece, t);
      const Vec dz = (tangent(points, degree, piece, t + e) - tangent(points, degree, piece, t - e)) * (1 / (2 * e));
      return z * -dot(v, dz);
    };
    for (int i = 0; i <= k_steps_a_piece; ++i) {
      const double t = piece + i * h;
      if (i < k_steps_a_piece || piece + 1 == pieces) {
        Axis::Node n;
        n.at = spline(points, degree, piece, t), n.velocity = derivative(points, degree, piece, t);
        n.z = unit(n.velocity), n.y = unit(y - n.z * dot(y, n.z)), n.x = cross(n.y, n.z);
        nodes.push_back(n);
      }
      if (i == k_steps_a_piece) continue;
      const Vec a = slope(t, y), b = slope(t + h / 2, y + a * (h / 2)), c = slope(t + h / 2, y + b * (h / 2)), d = slope(t + h, y + c * h);
      y = y + (a + b * 2 + c * 2 + d) * (h / 6);
    }
  }
  return nodes;
}

double step_length(const Axis::Node& a, const Axis::Node& b) { // Simpson's rule, with the middle of the cubic between
  const double h = 1.0 / k_steps_a_piece;
  const Vec middle = (b.at - a.at) * (1.5 / h) - (a.velocity + b.velocity) * 0.25;
  return h / 6 * (length(a.velocity) + 4 * length(middle) + length(b.velocity));
}

/// Turned from one direction to another by the shortest way (Rodrigues).
Vec carried(Vec v, Vec from, Vec to) {
  const Vec axis = cross(from, to);
  const double s = length(axis), c = dot(from, to);
  if (s < 1e-9) return v;
  const Vec k = axis * (1 / s);
  return v * c + cross(k, v) * s + k * (dot(k, v) * (1 - c));
}

/// A place of a curve: the cubic between two nodes.
struct Place {
  size_t node = 0;
  double s = 0; ///< of [0, 1], to the next node
  Vec at;
  double distance = std::numeric_limits<double>::infinity();
};

Vec between(const Axis::Node& a, const Axis::Node& b, double s) {
  const double h = 1.0 / k_steps_a_piece, u = 1 - s;
  return a.at * (u * u * (1 + 2 * s)) + a.velocity * (h * s * u * u) + b.velocity * (-h * s * s * u) + b.at * (s * s * (1 + 2 * u));
}
Vec slope_between(const Axis::Node& a, const Axis::Node& b, double s) {
  const double h = 1.0 / k_steps_a_piece;
  return (b.at - a.at) * (6 * s * (1 - s)) + a.velocity * (h * (1 - s) * (1 - 3 * s)) + b.velocity * (h * s * (3 * s - 2));
}

Place nearest(const std::vector<Axis::Node>& nodes, Vec p) {
  const size_t last = nodes.size() - 1;
  double best = std::numeric_limits<double>::infinity(), longest = 0;
  for (size_t i = 0; i <= last; i += k_coarse) best = std::min(best, length(p - nodes[i].at));
  for (size_t i = 0; i < last; i += k_coarse) longest = std::max(longest, length(nodes[i + k_coarse].at - nodes[i].at));
  size_t found = 0;
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < last; i += k_coarse) {
    if (length(p - nodes[i].at) > best + 2 * longest) continue;
    for (size_t j = i; j <= i + k_coarse; ++j)
      if (const double d = length(p - nodes[j].at); d < least) least = d, found = j;
  }
  Place place;
  const auto f = [&](size_t node, double s) {
    return dot(p - between(nodes[node], nodes[node + 1], s), slope_between(nodes[node], nodes[node + 1], s));
  };
  const bool is_ahead = dot(p - nodes[found].at, nodes[found].velocity) > 0;
  if ((is_ahead && found == last) || (!is_ahead && found == 0)) {
    place.node = found == 0 ? 0 : last - 1, place.s = found == 0 ? 0 : 1;
  } else {
    place.node = is_ahead ? found : found - 1;
    double low = 0, high = 1;
    for (int i = 0; i < 45; ++i) (f(place.node, 0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
    place.s = 0.5 * (low + high);
  }
  place.at = between(nodes[place.node], nodes[place.node + 1], place.s);
  place.distance = length(p - place.at);
  return place;
}

/// The frame at a place: between nodes along a straight line, made orthonormal again.
Axis::Node frame_at(const std::vector<Axis::Node>& nodes, const Place& place) {
  const Axis::Node &a = nodes[place.node], &b = nodes[place.node + 1];
  Axis::Node n;
  n.at = between(a, b, place.s), n.z = unit(slope_between(a, b, place.s));
  const Vec y = a.y * (1 - place.s) + b.y * place.s;
  n.y = unit(y - n.z * dot(y, n.z)), n.x = cross(n.y, n.z);
  return n;
}

/// From one of the two spaces to the other, about a place.
Vec carry(const Axis::Node& from, const Axis::Node& to, Vec p) {
  const Vec d = p - from.at;
  return to.at + to.x * dot(d, from.x) + to.y * dot(d, from.y) + to.z * dot(d, from.z);
}

/// The angle of the user's frames at a place, in radians.
double angle_at(const Axis& axis, const Place& place) {
  const Axis::Node &a = axis.rest_nodes[place.node], &b = axis.rest_nodes[place.node + 1];
  const double middle = length(slope_between(a, b, place.s / 2)), end = length(slope_between(a, b, place.s));
  const double along = axis.lengths[place.node] + place.s / 6 * (length(slope_between(a, b, 0)) + 4 * middle + end);
  const double at = along / axis.lengths.back(), pi = std::acos(-1.0);
  size_t k = 1;
  while (k + 1 < axis.turned.size() && axis.turned[k].at < at) ++k;
  const Axis::Frame &f = axis.turned[k - 1], &g = axis.turned[k];
  const double s = g.at > f.at ? std::clamp((at - f.at) / (g.at - f.at), 0.0, 1.0) : 1;
  return (f.angle + (axis.is_cosine ? (1 - std::cos(pi * s)) / 2 : s) * (g.angle - f.angle)) * pi / 180;
}

Axis::Node deformed_frame(const Axis& axis, const Place& place) {
  Axis::Node n = frame_at(axis.deformed_nodes, place);
  const double angle = angle_at(axis, place);
  const Vec x = n.x * std::cos(angle) + n.y * std::sin(angle), y = n.y * std::cos(angle) - n.x * std::sin(angle);
  n.x = x, n.y = y;
  return n;
}
/// A point of the deformed space at rest, and the other way, about a place.
Vec rest_of(const Axis& axis, const Place& place, Vec p) { return carry(deformed_frame(axis, place), frame_at(axis.rest_nodes, place), p); }
Vec moved(const Axis& axis, Place place, Vec p) { return carry(frame_at(axis.rest_nodes, place), deformed_frame(axis, place), p); }

double smooth(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

struct Offer {
  Vec by;
  double depth, share, limit;
};

double agreement(Vec a, Vec b, double limit) { return smooth(2 - 2 * length(a - b) / limit); }

} // namespace

void Axis::prepare() {
  const int n = degree_of(*this);
  const Vec z = tangent(rest, n, 0, 0), w = tangent(deformed, n, 0, 0);
  Vec first = normal - z * dot(normal, z);
  first = unit(first);
  rest_nodes = walk(rest, n, first), deformed_nodes = walk(deformed, n, carried(first, z, w));
  lengths = {0};
  for (size_t i = 0; i + 1 < rest_nodes.size(); ++i) lengths.push_back(lengths.back() + step_length(rest_nodes[i], rest_nodes[i + 1]));
  turned = frames;
  std::stable_sort(turned.begin(), turned.end(), [](const Frame& a, const Frame& b) { return a.at < b.at; });
  if (turned.empty() || turned.front().at > 0) turned.insert(turned.begin(), {0, 0});
  if (turned.back().at < 1) turned.push_back({1, 0});
  double most_roll = 0, most_ratio = 0;
  for (size_t k = 1; k < turned.size(); ++k)
    if (turned[k].at > turned[k - 1].at)
      most_roll = std::max(most_roll, std::abs(turned[k].angle - turned[k - 1].angle) / (turned[k].at - turned[k - 1].at));
  for (size_t i = 0; i < deformed_nodes.size(); ++i)
    most_ratio = std::max(most_ratio, length(rest_nodes[i].velocity) / length(deformed_nodes[i].velocity));
  most_roll *= 1.6 * std::acos(-1.0) / 180 / lengths.back(); // the cosine is steeper, by pi / 2
  // With h >= 0.1, of the other axis at most 1.9.
  lipschitz = 2 + 10 * most_ratio * (1.9 + most_roll * radius);
  const double infinity = std::numeric_limits<double>::infinity();
  lower = {infinity, infinity, infinity}, upper = lower * -1;
  for (const auto* nodes : {&rest_nodes, &deformed_nodes})
    for (const Node& node : *nodes) {
      lower = {std::min(lower.x, node.at.x), std::min(lower.y, node.at.y), std::min(lower.z, node.at.z)};
      upper = {std::max(upper.x, node.at.x), std::max(upper.y, node.at.y), std::max(upper.z, node.at.z)};
    }
}

void Axial::prepare() {
  for (Axis& axis : axes) axis.prepare(), nowhere = std::max(nowhere, 1e5 * length(axis.upper - axis.lower));
}

namespace {

bool is_near_box(const Axis& axis, Vec p, double reach) {
  const auto out = [&](double x, double lo, double hi) { return std::max({lo - x, x - hi, 0.0}); };
  return length({out(p.x, axis.lower.x, axis.upper.x), out(p.y, axis.lower.y, axis.upper.y), out(p.z, axis.lower.z, axis.upper.z)}) <
         axis.radius + reach;
}

bool is_vacated(const Axial& axial, Vec p) {
  for (const Axis& axis : axial.axes) {
    if (!is_near_box(axis, p, 0)) continue;
    const Place place = nearest(axis.rest_nodes, p);
    if (place.distance >= axis.radius) continue;
    const Vec q = moved(axis, place, p);
    if (length(q - p) > axis.radius * axis.border / 3) return true;
  }
  return false;
}

} // namespace

Vec undeformed(const Axial& axial, Vec p) {
  std::vector<Offer> offers;
  for (const Axis& axis : axial.axes) {
    if (!is_near_box(axis, p, 0)) continue;
    const Place place = nearest(axis.deformed_nodes, p);
    if (place.distance >= axis.radius) continue;
    const double depth = (1 - place.distance / axis.radius) / axis.border;
    const Vec q = rest_of(axis, place, p);
    offers.push_back({q - p, depth, smooth(depth), axis.radius * axis.border / 3});
  }
  const Vec nowhere = p + Vec{axial.nowhere, 0, 0};
  const Offer* deepest = nullptr;
  double sum = 0;
  for (const Offer& o : offers) {
    sum += o.share;
    if (!deepest || o.depth > deepest->depth) deepest = &o;
  }
  const double rest = std::max(0.0, 1 - sum);
  const bool is_owned = deepest && deepest->share >= 0.5;
  if (!is_owned && is_vacated(axial, p)) return nowhere;
  const Vec chosen = is_owned ? deepest->by : Vec{};
  double shares = rest * (is_owned ? agreement(chosen, {}, deepest->limit) : 1);
  Vec by;
  for (const Offer& o : offers) {
    const double share = is_owned && &o == deepest ? o.share : o.share * agreement(o.by, chosen, std::min(o.limit, deepest->limit));
    by = by + o.by * share, shares += share;
  }
  return shares > 0 ? p + by * (1 / shares) : p;
}

std::vector<Image> images(const Axial& axial, Vec p, double reach) {
  std::vector<Image> out;
  double limit = 0, lipschitz = 1;
  for (const Axis& axis : axial.axes) {
    limit = std::max(limit, axis.radius * axis.border / 3);
    if (!is_near_box(axis, p, reach)) continue;
    const Place place = nearest(axis.deformed_nodes, p);
    if (place.distance - reach >= axis.radius) continue;
    // From the point of the tube that is nearest to p.
    const double part = place.distance < axis.radius ? 1 : axis.radius / place.distance;
    const Vec q = rest_of(axis, place, place.at + (p - place.at) * part);
    // How far the ball's other points of the tube may be: along the axis lengths may grow by much, near its ends by nothing.
    const double far = std::min(2 * reach * axis.lipschitz, 1e3);
    out.push_back({q, far, 0});
    lipschitz = std::max(lipschitz, 3.0);
  }
  for (Image& image : out) image.radius += limit, image.lipschitz = lipschitz;
  out.push_back({p, reach + (out.empty() ? 0 : limit), lipschitz});
  return out;
}

} // namespace reference
