// The lines that the solver for packets draws above and below fields along a stretch: no place is past them.
#define HWY_COMPILE_ONLY_STATIC
#include <gtest/gtest.h>

#include "renderer/lanes/tree_joins-inl.h"
#include "tests/support/random_scene.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

constexpr int k_places = 33;

float at(const Line& line, float u) { return (1 - u) * hn::GetLane(line.left) + u * hn::GetLane(line.right); }
Line line(double left, double right) { return {set(static_cast<float>(left)), set(static_cast<float>(right))}; }

/// How far a potential comes out above the line above it, or below the one below it, where the distance goes along a line.
double past_lines_of_bump(Random& r) {
  constexpr double k_shapes[][2] = {{1, 0}, {0, 1}, {3, -2}, {5 / 9.0, 4 / 9.0}}; // a, b
  const auto& [a, b] = k_shapes[r.below(4)];
  const double weight = r.uniform(0.2, 4), radius = r.uniform(0.1, 3);
  const double crest = b < 0 ? std::clamp(0.4 - 0.2 * a / b, 0.0, 1.0) : 1;
  const auto vector = [](double x) { return set(static_cast<float>(x)); };
  const Bump bump{vector(1 / (radius * radius)), vector(weight * a), vector(weight * b), vector(crest)};
  const Line distance = line(radius * r.uniform(-0.7, 1.5), radius * r.uniform(-0.7, 1.5));
  const Line above = bump.above(distance), below = bump.below(distance);
  double most = 0;
  for (int i = 0; i < k_places; ++i) {
    const float u = float(i) / (k_places - 1);
    const float f = hn::GetLane(bump.at(bump.closeness(set(at(distance, u)))));
    most = std::max({most, double(f - at(above, u)), double(at(below, u) - f)});
  }
  return most / weight;
}

/// The same for an R-union of fields between two lines each.
double past_line_of_r_union(Random& r) {
  const double largest = r.below(2) ? 1.2 : 4;
  const double a0 = r.uniform(0, largest), a1 = r.uniform(0, largest), b0 = r.uniform(0, largest), b1 = r.uniform(0, largest);
  const bool is_tight = r.below(2);
  const auto less = [&](double x) { return is_tight ? x : x * r.uniform(0, 1); };
  const Line a = line(a0, a1), b = line(b0, b1), least_a = line(less(a0), less(a1)), least_b = line(less(b0), less(b1));
  const Line above = above_r_union(a, b, least_a, least_b);
  double most = 0;
  for (int i = 0; i < k_places; ++i) {
    const float u = float(i) / (k_places - 1);
    const auto between = [&](const Line& low, const Line& high) { return std::lerp(at(low, u), at(high, u), float(r.uniform(0, 1))); };
    const float f = hn::GetLane(RFunctions::unite(set(between(least_a, a)), set(between(least_b, b))));
    most = std::max(most, double(f - at(above, u)));
  }
  return most;
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

namespace kelpie {
namespace {

TEST(FieldLines, APotentialLiesBetweenItsLines) {
  Random r(1);
  for (int trial = 0; trial < 50'000; ++trial) ASSERT_LT(HWY_STATIC_DISPATCH(past_lines_of_bump)(r), 1e-5) << trial;
}

TEST(FieldLines, AnRUnionLiesBelowItsLine) {
  Random r(1);
  for (int trial = 0; trial < 50'000; ++trial) ASSERT_LT(HWY_STATIC_DISPATCH(past_line_of_r_union)(r), 1e-5) << trial;
}

} // namespace
} // namespace kelpie
