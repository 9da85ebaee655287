#include "field/complex/sweep.h"

#include <fmt/format.h>

namespace kelpie {

namespace {

/// The Bezier points of a polynomial given by powers: the curve lies in their hull.
std::vector<WidePoint> bezier_points(const std::vector<WidePoint>& powers) {
  // b_j = sum_i C(j, i) / C(n, i) a_i: rows of differences, summed up.
  std::vector<WidePoint> b = powers;
  const size_t n = powers.size() - 1;
  double binomial = 1;
  for (size_t i = 0; i <= n; ++i) {
    b[i] /= binomial;
    binomial = binomial * static_cast<double>(n - i) / static_cast<double>(i + 1);
  }
  for (size_t round = 0; round < n; ++round)
    for (size_t j = n; j > round; --j) b[j] += b[j - 1];
  return b;
}

} // namespace

Sweep::Sweep(SplineKind kind, std::vector<WidePoint> points) : curve_(Spline<WidePoint>::make(kind, points)) {}

WidePoint Sweep::at(int span, uint32_t k, uint32_t n) const {
  if (k == n && span + 1 < spans()) return at(span + 1, 0, 1);
  const std::span<const WidePoint> c = curve_.coefficients(span);
  const double s = static_cast<double>(k) / n;
  WidePoint p = c.back();
  for (size_t i = c.size() - 1; i-- > 0;) p = p * s + c[i];
  return p;
}

double Sweep::bend(int span) const {
  const std::span<const WidePoint> c = curve_.coefficients(span);
  if (c.size() < 3) return 0;
  std::vector<WidePoint> second;
  for (size_t i = 2; i < c.size(); ++i) second.push_back(c[i] * static_cast<double>(i * (i - 1)));
  double most = 0;
  for (const WidePoint& p : bezier_points(second)) most = std::max(most, glm::length(Vec3d(p)) + std::abs(p.w));
  return most;
}

Box3d Sweep::box(int span) const {
  const std::span<const WidePoint> c = curve_.coefficients(span);
  Box3d box;
  for (const WidePoint& p : bezier_points({c.begin(), c.end()})) box.extend(Vec3d(p));
  return box;
}

std::optional<ParameterProblem> problem_of_curve(SplineKind kind, std::string_view parameter, size_t count) {
  if (kind == SplineKind::cubic_beziers && count % 3 != 1)
    return ParameterProblem{
        parameter, fmt::format("{}: cubic_beziers have 4 points, or 3 more for each further piece (7, 10, …), found {}", parameter, count)};
  if (kind != SplineKind::bezier || count <= k_most_bezier_points) return {};
  return ParameterProblem{parameter, fmt::format("{}: a bezier curve has at most {}, found {}; more make a b_spline, or cubic_beziers",
                                                 parameter, k_most_bezier_points, count)};
}

} // namespace kelpie
