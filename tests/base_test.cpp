#include <gtest/gtest.h>

#include "base/animated.h"
#include "base/dual.h"
#include "base/error.h"
#include "base/suggest.h"

namespace kelpie {
namespace {

TEST(Suggest, FindsTheNearestNameAndListsWhenNoneIsNear) {
  const std::array<std::string_view, 3> known{"radius", "weight", "centre"};
  EXPECT_EQ(suggestion("raduis", known), " (did you mean \"radius\"?)");
  EXPECT_EQ(suggestion("colour", known), "; known: radius, weight, centre");
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

} // namespace
} // namespace kelpie
