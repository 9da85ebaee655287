#include <gtest/gtest.h>

#include "base/animated.h"
#include "base/dual.h"
#include "base/error.h"
#include "base/spline.h"
#include "base/suggest.h"
#include "base/vec.h"

namespace kelpie {
namespace {

TEST(Suggest, FindsTheNearestNameAndListsWhenNoneIsNear) {
  const std::array<std::string_view, 3> known{"radius", "weight", "centre"};
  EXPECT_EQ(suggestion("raduis", known), " (did you mean \"radius\"?)");
  EXPECT_EQ(suggestion("colour", known), "; known: radius, weight, centre");
  const std::vector<std::string_view> kinds{"cone_sphere", "sdf_sphere", "spheres"};
  EXPECT_EQ(nearest_name("sphere", kinds), "spheres");
  EXPECT_EQ(nearest_name("cone", kinds), "cone_sphere");
  EXPECT_EQ(nearest_name("sphere", {kinds.data(), 2}), "sdf_sphere");
  EXPECT_EQ(nearest_name("sph", {kinds.data(), 2}), "");
  EXPECT_EQ(nearest_name("", kinds), "");
}

TEST(Animated, LinearStepAndEnds) {
  const Animated<float> a({{1, 2.f, {}}, {3, 4.f, {}}}, Interpolation::linear);
  EXPECT_EQ(a.at(0), 2.f);
  EXPECT_EQ(a.at(2), 3.f);
  EXPECT_EQ(a.at(9), 4.f);
  EXPECT_EQ(Animated<float>({{1, 2.f, {}}, {3, 4.f, {}}}, Interpolation::step).at(2.9), 2.f);
}

// Order n reproduces every polynomial of degree 2n - 1 from its values and derivatives at two keys.
TEST(Animated, HermiteReproducesPolynomials) {
  const auto f = [](double t) { return static_cast<float>(1 + t * (2 + t * (-3 + t * (0.5 + t * (0.25 - 0.1 * t))))); };
  const auto df = [](double t) { return static_cast<float>(2 + t * (-6 + t * (1.5 + t * (1 - 0.5 * t)))); };
  const auto ddf = [](double t) { return static_cast<float>(-6 + t * (3 + t * (3 - 2 * t))); };
  const Animated<float> a({{0, f(0), {df(0), ddf(0)}}, {2, f(2), {df(2), ddf(2)}}}, Interpolation::hermite);
  for (double t = 0; t <= 2; t += 0.125) EXPECT_NEAR(a.at(t), f(t), 2e-6);
}

// As slopes have it where the one is unbounded and the other may vanish.
TEST(Interval, OfAnUnboundedProductIsEverything) {
  for (const Interval& f : {Interval{0, 1}, Interval{-1, 0}, Interval{0, 0}})
    for (const Interval& product : {f * Interval::everything(), Interval::everything() * f}) {
      EXPECT_EQ(product.lo, Interval::everything().lo);
      EXPECT_EQ(product.hi, Interval::everything().hi);
    }
  EXPECT_TRUE((Interval{0, 1} * Interval{2, Interval::everything().hi}).contains(0));
}

TEST(Interval, ContainsWhatItsOperandsYield) {
  const Interval a{-2, 3}, b{0.5, 1.5};
  for (double x = a.lo; x <= a.hi; x += 0.25)
    for (double y = b.lo; y <= b.hi; y += 0.25) {
      EXPECT_TRUE((a * b).contains(x * y));
      EXPECT_TRUE((a / b).contains(x / y));
      EXPECT_TRUE((a - b).contains(x - y));
      EXPECT_TRUE(square(a).contains(x * x));
      EXPECT_TRUE(max(a, b).contains(std::max(x, y)));
    }
  EXPECT_EQ(square(a).lo, 0);
}

TEST(Dual, DerivativeAgreesWithDifferences) {
  using D = Dual<double, 1>;
  const auto f = [](auto x) { return sqrt(square(x) + 1.0) * max(decltype(x)(0.25), x) / (x + 3.0); };
  for (double x = -1; x <= 2; x += 0.37) {
    const double h = 1e-6, slope = (f(x + h) - f(x - h)) / (2 * h);
    EXPECT_NEAR(f(D::variable(x, 0)).d[0], slope, 1e-8);
  }
}

const std::vector<Vec3d> k_control{{0, 0, 0}, {1, 2, 0}, {3, 1, 1}, {4, -1, 2}, {6, 0, -1}, {7, 3, 0}, {8, 8, 8}};

template <class Visit>
void for_each_spline(Visit&& visit) {
  for (size_t count = 1; count <= k_control.size(); ++count)
    for (const SplineKind kind : {SplineKind::b_spline, SplineKind::bezier, SplineKind::cubic_beziers, SplineKind::catmull_rom})
      for (const int degree : {1, 2, 3, 5}) visit(Spline<Vec3d>::make(kind, std::span(k_control).first(count), degree), kind, count);
}

// The basis functions straight from their definition.
double basis(const std::vector<double>& knots, int i, int degree, double t) {
  if (degree == 0) return knots[i] <= t && t < knots[i + 1] ? 1 : 0;
  double sum = 0;
  if (knots[i + degree] > knots[i]) sum += (t - knots[i]) / (knots[i + degree] - knots[i]) * basis(knots, i, degree - 1, t);
  if (knots[i + degree + 1] > knots[i + 1])
    sum += (knots[i + degree + 1] - t) / (knots[i + degree + 1] - knots[i + 1]) * basis(knots, i + 1, degree - 1, t);
  return sum;
}

TEST(Spline, OfBasisFunctionsIsTheirSum) {
  for (const int degree : {1, 2, 3, 4}) {
    const int count = static_cast<int>(k_control.size()), pieces = count - degree;
    const Spline<Vec3d> curve = Spline<Vec3d>::b_spline(k_control, degree);
    std::vector<double> knots;
    for (int i = 0; i <= count + degree; ++i) knots.push_back(double(std::clamp(i - degree, 0, pieces)) / pieces);
    for (double t = 0; t < 1; t += 0.01) {
      Vec3d sum(0);
      for (int i = 0; i < count; ++i) sum += k_control[i] * basis(knots, i, degree, t);
      EXPECT_LT(glm::distance(curve(t), sum), 1e-12) << degree << " " << t;
    }
  }
}

TEST(Spline, MeetsItsEnds) {
  for_each_spline([](const Spline<Vec3d>& curve, SplineKind, size_t count) {
    EXPECT_LT(glm::distance(curve(0), k_control[0]), 1e-12);
    EXPECT_LT(glm::distance(curve(1), k_control[count - 1]), 1e-11);
  });
}

TEST(Spline, CatmullRomGoesThroughItsPoints) {
  const Spline<Vec3d> curve = Spline<Vec3d>::catmull_rom(k_control);
  for (size_t i = 0; i < k_control.size(); ++i)
    EXPECT_LT(glm::distance(curve(double(i) / double(k_control.size() - 1)), k_control[i]), 1e-12);
}

TEST(Spline, DerivativesAgreeWithDifferences) {
  for_each_spline([](const Spline<Vec3d>& curve, SplineKind, size_t) {
    for (const double t : {0.013, 0.27, 0.61, 0.993}) {
      const double h = 1e-4;
      const SplineJet<Vec3d> jet = curve.jet(t);
      EXPECT_LT(glm::distance(jet.value, curve(t)), 1e-12);
      EXPECT_LT(glm::distance(jet.first, (curve(t + h) - curve(t - h)) / (2 * h)), 1e-3);
      EXPECT_LT(glm::distance(jet.second, (curve.jet(t + h).first - curve.jet(t - h).first) / (2 * h)), 1e-3);
    }
  });
}

TEST(Spline, PiecesJoinSmoothly) {
  for_each_spline([](const Spline<Vec3d>& curve, SplineKind kind, size_t) {
    for (int i = 1; i < curve.pieces() && curve.degree() > 1; ++i) {
      const double t = double(i) / curve.pieces();
      const SplineJet<Vec3d> before = curve.jet(t - 1e-9), after = curve.jet(t + 1e-9);
      EXPECT_LT(glm::distance(before.value, after.value), 1e-6);
      if (kind == SplineKind::cubic_beziers) continue; // as smooth as its points say
      EXPECT_LT(glm::distance(before.first, after.first), 1e-4);
      if (kind == SplineKind::b_spline && curve.degree() > 2) {
        EXPECT_LT(glm::distance(before.second, after.second), 1e-3);
      }
    }
  });
}

TEST(Spline, CubicBeziersArePiecesOfFourPoints) {
  const Spline<Vec3d> curve = Spline<Vec3d>::cubic_beziers(k_control);
  ASSERT_EQ(curve.pieces(), 2);
  for (const size_t piece : {0u, 1u})
    for (const double s : {0.0, 0.2, 0.7, 1.0}) {
      const Vec3d* p = &k_control[3 * piece];
      const double r = 1 - s;
      const Vec3d expected = p[0] * (r * r * r) + p[1] * (3 * r * r * s) + p[2] * (3 * r * s * s) + p[3] * (s * s * s);
      EXPECT_LT(glm::distance(curve((double(piece) + s) / 2), expected), 1e-12);
    }
}

TEST(Spline, OfNumbers) {
  const std::vector<double> radii{1, 2, 4};
  EXPECT_NEAR(Spline<double>::bezier(radii)(0.5), 0.25 * 1 + 0.5 * 2 + 0.25 * 4, 1e-15);
}

} // namespace
} // namespace kelpie
