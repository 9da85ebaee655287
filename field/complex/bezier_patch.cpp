#include "field/complex/bezier_patch.h"

namespace kelpie {

namespace {

using Point = glm::dvec4;

std::array<double, 4> basis(double t) {
  const double s = 1 - t;
  return {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
}
std::array<double, 4> basis_slopes(double t) {
  const double s = 1 - t;
  return {-3 * s * s, 3 * s * (s - 2 * t), 3 * t * (2 * s - t), 3 * t * t};
}

double size(const Point& v) { return glm::length(Vec3d(v)) + std::abs(v.w); }

} // namespace

SurfacePoint BezierPatch::at(double u, double v) const {
  const auto sum = [&](const std::array<double, 4>& by_u, const std::array<double, 4>& by_v) {
    Point p(0);
    for (size_t row = 0; row < 4; ++row)
      for (size_t column = 0; column < 4; ++column) p += by_u[column] * by_v[row] * point(column, row);
    return p;
  };
  const auto normal = [&](double at_u, double at_v) {
    const Vec3d a(sum(basis_slopes(at_u), basis(at_v))), b(sum(basis(at_u), basis_slopes(at_v))), n = glm::cross(a, b);
    const double length = glm::length(n);
    return length > 1e-12 * (glm::dot(a, a) + glm::dot(b, b)) ? n / length : Vec3d(0);
  };
  const Point p = sum(basis(u), basis(v));
  Vec3d n = normal(u, v);
  // Where a border is drawn together to a point there is no normal; a little inwards there is.
  for (double inwards = 1e-4; n == Vec3d(0) && inwards < 0.5; inwards *= 10)
    n = normal(u + inwards * (0.5 - u) + inwards * 0.1, v + inwards * (0.5 - v) + inwards * 0.1);
  return {Vec3d(p), n, std::max(0.0, p.w)};
}

Box3d BezierPatch::box() const {
  Box3d box;
  for (const Point& p : points_) box.extend(Vec3d(p));
  return box;
}

BezierPatch::Bends BezierPatch::bends() const {
  Bends most{};
  const auto raise = [](double& x, const Point& v, double factor) { x = std::max(x, factor * size(v)); };
  for (size_t i = 0; i < 4; ++i)
    for (size_t j = 0; j < 4; ++j) {
      if (i < 2) raise(most.uu, point(i, j) - 2.0 * point(i + 1, j) + point(i + 2, j), 6);
      if (j < 2) raise(most.vv, point(i, j) - 2.0 * point(i, j + 1) + point(i, j + 2), 6);
      if (i < 3 && j < 3) raise(most.uv, point(i, j) - point(i + 1, j) - point(i, j + 1) + point(i + 1, j + 1), 9);
    }
  return most;
}

std::array<Point, 4> BezierPatch::border(Side side) const {
  std::array<Point, 4> out;
  for (size_t i = 0; i < 4; ++i)
    out[i] = side == bottom ? point(i, 0) : side == top ? point(i, 3) : side == left ? point(0, i) : point(3, i);
  return out;
}

SurfacePoint BezierPatch::on_border(Side side, double s) const {
  return side == bottom ? at(s, 0) : side == top ? at(s, 1) : side == left ? at(0, s) : at(1, s);
}

bool is_smooth(const BezierPatch& a, BezierPatch::Side a_side, const BezierPatch& b, BezierPatch::Side b_side) {
  const std::array<Point, 4> p = a.border(a_side), q = b.border(b_side);
  const bool is_along = p == q, is_against = std::equal(p.begin(), p.end(), q.rbegin());
  if (!is_along && !is_against) return false;
  for (const double s : {0.0, 0.3, 0.5, 0.7, 1.0}) {
    const double cosine = glm::dot(a.on_border(a_side, s).normal, b.on_border(b_side, is_along ? s : 1 - s).normal);
    if (std::abs(cosine) < 1 - 1e-6) return false; // either side may be up
  }
  return true;
}

} // namespace kelpie
