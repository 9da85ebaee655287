#include "tests/reference/interpolate.h"

#include <algorithm>
#include <limits>

namespace reference {

namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
constexpr int k_nodes = k_degree + 1;
/// The interpolation's error, in thresholds, where the field is at the threshold; and, elsewhere, as a
/// part of its distance from it. A verdict's own tolerance is 1e-4.
constexpr double k_tolerance = 1e-6, k_relative_tolerance = 0.005;
/// A stretch is at most this part of the radius of the smallest leaf that reaches it.
constexpr double k_stretch_in_radii = 0.25;
/// Stretches are not halved below this part of the whole: a fiftieth of what a verdict can see.
constexpr double k_shortest = 1e-7;

/// The inverse of the matrix of Bernstein polynomials at the nodes i / degree: from values to coefficients.
std::array<std::array<double, k_nodes>, k_nodes> coefficients_from_values() {
  std::array<std::array<double, k_nodes>, k_nodes> m{}, inverse{};
  for (int i = 0; i < k_nodes; ++i) {
    inverse[i][i] = 1;
    for (int j = 0; j < k_nodes; ++j) {
      Polynomial basis;
      basis.c[j] = 1;
      m[i][j] = basis(double(i) / k_degree);
    }
  }
  for (int column = 0; column < k_nodes; ++column) { // Gauss–Jordan; the diagonal dominates
    const double pivot = m[column][column];
    for (int j = 0; j < k_nodes; ++j) m[column][j] /= pivot, inverse[column][j] /= pivot;
    for (int row = 0; row < k_nodes; ++row) {
      const double factor = m[row][column];
      if (row == column || factor == 0) continue;
      for (int j = 0; j < k_nodes; ++j) m[row][j] -= factor * m[column][j], inverse[row][j] -= factor * inverse[column][j];
    }
  }
  return inverse;
}

class Interpolation {
public:
  Interpolation(const Node& node, const Ray& ray, double threshold, double shortest)
      : node_(node), ray_(ray), threshold_(threshold), shortest_(shortest), speed_(length(ray.direction)) {}

  void run(double a, double b, Profile& out) const {
    const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
    const double radius = smallest_radius(node_, ray_.at(middle), half * speed_);
    if (radius == k_infinity) { // nothing reaches: the field does not change
      out.push_back({a, b, constant(value(node_, ray_.at(middle), threshold_))});
      return;
    }
    Polynomial f;
    const bool is_short = b - a <= shortest_;
    const bool is_fine = (b - a) * speed_ <= k_stretch_in_radii * radius && fits(a, b, f);
    if (is_fine || is_short) {
      if (!is_fine) fits(a, b, f);
      out.push_back({a, b, f});
      return;
    }
    run(a, middle, out);
    run(middle, b, out);
  }

private:
  bool fits(double a, double b, Polynomial& f) const {
    static const auto k_coefficients = coefficients_from_values();
    std::array<double, 2 * k_degree + 1> v{};
    double near = k_infinity;
    for (int i = 0; i <= 2 * k_degree; ++i) {
      v[i] = value(node_, ray_.at(a + (b - a) * i / (2.0 * k_degree)), threshold_);
      near = std::min(near, std::abs(v[i] - threshold_));
    }
    f = {};
    for (int i = 0; i < k_nodes; ++i)
      for (int j = 0; j < k_nodes; ++j) f.c[i] += k_coefficients[i][j] * v[2 * j];
    double error = 0;
    for (int i = 1; i < 2 * k_degree; i += 2) error = std::max(error, std::abs(f(i / (2.0 * k_degree)) - v[i]));
    return error <= std::max(k_tolerance * threshold_, k_relative_tolerance * near);
  }

  /// The radius of the smallest leaf that may be felt within `reach` of p; infinity if there is none.
  static double smallest_radius(const Node& node, Vec p, double reach) {
    if (node.kind == Node::Kind::warp) {
      // A Lipschitz constant of the map: its Frobenius norm.
      double squares = 0;
      for (const Vec& row : node.child_from_parent.rows) squares += dot(row, row);
      const double lipschitz = std::sqrt(squares);
      return smallest_radius(*node.children[0], node.child_from_parent.point(p), reach * lipschitz) / lipschitz;
    }
    if (node.kind == Node::Kind::twist) { // its Lipschitz constant grows with the distance from the axis
      const Vec q = p - node.centre;
      const double along = dot(q, node.axis) / length(node.axis), from_axis = std::sqrt(std::max(0.0, dot(q, q) - along * along));
      const double k = std::abs(node.rate) * std::acos(-1.0) / 180 * (from_axis + reach), lipschitz = 0.5 * (k + std::sqrt(k * k + 4));
      return smallest_radius(*node.children[0], untwisted(node, p), reach * lipschitz) / lipschitz;
    }
    if (node.kind == Node::Kind::taper) { // across the axis by 1/s, along it by what 1/s changes, more the farther from it
      const Vec q = p - node.centre;
      const double along = dot(q, node.axis) / length(node.axis), from_axis = std::sqrt(std::max(0.0, dot(q, q) - along * along));
      const double most = std::max(1.0, 1 / node.by), sheared = (from_axis + reach) * most * most * std::abs(node.by - 1) / node.length;
      const double lipschitz = std::sqrt(most * most + 1 + sheared * sheared);
      return smallest_radius(*node.children[0], untapered(node, p), reach * lipschitz) / lipschitz;
    }
    if (node.kind == Node::Kind::bend) { // steepest near the bend axis; across the cut anything may follow
      const Unbent q = unbent(node, p);
      const double radius = q.to_axis < k_infinity ? node.length * 180 / (std::abs(node.angle) * std::acos(-1.0)) : 1;
      if (q.to_axis * radius <= reach) return 0;
      const double lipschitz = std::max(1.0, 1 / (q.to_axis - reach / radius));
      return smallest_radius(*node.children[0], q.p, q.to_cut <= reach ? k_infinity : reach * lipschitz) / lipschitz;
    }
    if (node.kind == Node::Kind::axial) {
      double least_image = k_infinity;
      for (const Image& image : images(*node.axial, p, reach))
        least_image = std::min(least_image, smallest_radius(*node.children[0], image.centre, image.radius) / image.lipschitz);
      return least_image;
    }
    double least = k_infinity;
    for (const Leaf& leaf : node.leaves)
      if (may_be_within(leaf, p, leaf.radius + reach)) least = std::min(least, leaf.radius);
    for (const NodePtr& child : node.children) least = std::min(least, smallest_radius(*child, p, reach));
    if (node.kind == Node::Kind::mix) // weights change over the thickness of elements, which is much less than their reach
      for (const auto& object : node.mix->objects)
        for (const Element& e : object) least = std::min({least, e.size.x, e.size.y, e.size.z});
    return least;
  }

  const Node& node_;
  const Ray& ray_;
  double threshold_, shortest_, speed_;
};

} // namespace

Profile interpolated_along_ray(const Node& node, const Ray& ray, double t_from, double t_to, double threshold) {
  Profile out;
  Interpolation(node, ray, threshold, k_shortest * (t_to - t_from)).run(t_from, t_to, out);
  return out;
}

} // namespace reference
