// How values go on between keys and outside of them.
#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "base/animated.h"

namespace kelpie {
namespace {

using Keys = std::vector<Key<float>>;

class Random {
public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double lower, double upper) { return std::uniform_real_distribution<>(lower, upper)(engine_); }
  int below(int n) { return std::uniform_int_distribution<>(0, n - 1)(engine_); }

private:
  std::mt19937 engine_;
};

/// Several keys at random distances, with random values; the last value is the first.
Keys random_loop(Random& r) {
  Keys keys{{r.uniform(-5, 5), float(r.uniform(-2, 2)), {}}};
  const int count = 3 + r.below(4);
  for (int i = 1; i < count; ++i) keys.push_back({keys.back().frame + r.uniform(0.5, 6), float(r.uniform(-2, 2)), {}});
  keys.back().value = keys.front().value;
  return keys;
}

double slope(const Curve<float>& curve, double at, double step) { return (double(curve.at(at + step)) - double(curve.at(at))) / step; }

TEST(Curve, PassesThroughItsKeysInEveryMode) {
  Random r(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Keys keys = random_loop(r);
    for (const Interpolation how :
         {Interpolation::linear, Interpolation::step, Interpolation::hermite, Interpolation::smooth, Interpolation::spline})
      for (const Outside outside : {Outside::hold, Outside::cycle, Outside::cycle_offset, Outside::ping_pong, Outside::proceed}) {
        const Curve<float> curve(keys, how, {outside, outside});
        for (const Key<float>& key : keys) ASSERT_NEAR(curve.at(key.frame), key.value, 1e-5);
      }
  }
}

TEST(Curve, MayHaveCorners) {
  const Curve<float> curve({{0, 0, {0}}, {4, 1, {-1}, std::vector<float>{2}}, {8, 0, {0}}}, Interpolation::hermite,
                           {Outside::hold, Outside::proceed});
  const double h = 1e-3;
  EXPECT_NEAR((curve.at(4) - curve.at(4 - h)) / h, 2, 0.01);
  EXPECT_NEAR((curve.at(4 + h) - curve.at(4)) / h, -1, 0.01);
  const Curve<float> straight({{0, 0, {5}}, {4, 1, {}, std::vector<float>{}}}, Interpolation::hermite); // no derivative on one side: a line
  EXPECT_FLOAT_EQ(straight.at(1), 0.25f);
}

TEST(Curve, ThatIsSmoothRestsWhereItTurnsAndStaysBetweenNeighbours) {
  Random r(2);
  for (int trial = 0; trial < 200; ++trial) {
    const Keys keys = random_loop(r);
    const Curve<float> curve(keys, Interpolation::smooth);
    for (size_t i = 1; i < keys.size(); ++i) {
      const auto [low, high] = std::minmax(keys[i - 1].value, keys[i].value);
      for (int j = 0; j <= 20; ++j) {
        const float v = curve.at(keys[i - 1].frame + (keys[i].frame - keys[i - 1].frame) * j / 20);
        ASSERT_GE(v, low - 1e-5f);
        ASSERT_LE(v, high + 1e-5f);
      }
    }
    EXPECT_NEAR(slope(curve, keys.front().frame, 1e-3), 0, 0.05);
    EXPECT_NEAR(slope(curve, keys.back().frame, -1e-3), 0, 0.05);
  }
}

// A curve has no corner at its keys, nor, if it is a loop, where it begins again.
TEST(Curve, ThatIsSmoothOrASplineHasNoCorner) {
  Random r(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Keys keys = random_loop(r);
    for (const Interpolation how : {Interpolation::smooth, Interpolation::spline})
      for (const Outside outside : {Outside::cycle, Outside::ping_pong}) {
        const Curve<float> curve(keys, how, {outside, outside});
        const double period = keys.back().frame - keys.front().frame;
        for (const Key<float>& key : keys)
          for (const double cycle : {-2, -1, 0, 1}) {
            const double at = outside == Outside::cycle ? key.frame + cycle * period : key.frame;
            constexpr double k_step = 1e-3;
            ASSERT_NEAR(slope(curve, at, k_step), slope(curve, at, -k_step), 0.12) << "key at " << at;
          }
      }
  }
}

TEST(Curve, ThatIsASplineReproducesParabolasBetweenInnerKeys) {
  const auto f = [](double t) { return float(1 + 0.5 * t - 0.25 * t * t); };
  const Curve<float> curve({{0, f(0), {}}, {1, f(1), {}}, {3, f(3), {}}, {4, f(4), {}}}, Interpolation::spline);
  for (double t = 1; t <= 3; t += 0.125) EXPECT_NEAR(curve.at(t), f(t), 1e-5);
}

TEST(Curve, GoesOnOutsideItsKeys) {
  const Keys keys{{2, 1.f, {}}, {4, 3.f, {}}, {6, 2.f, {}}};
  const auto at = [&](Outside outside, double frame) { return Curve<float>(keys, Interpolation::linear, {outside, outside}).at(frame); };
  EXPECT_FLOAT_EQ(at(Outside::hold, -3), 1);
  EXPECT_FLOAT_EQ(at(Outside::hold, 30), 2);
  for (const double cycle : {-3, -2, -1, 1, 2, 5}) {
    EXPECT_FLOAT_EQ(at(Outside::cycle, 3 + 4 * cycle), 2);
    EXPECT_FLOAT_EQ(at(Outside::cycle, 5 + 4 * cycle), 2.5f);
    EXPECT_FLOAT_EQ(at(Outside::cycle_offset, 3 + 4 * cycle), float(2 + cycle));
    const bool is_back = int(std::abs(cycle)) % 2;
    EXPECT_FLOAT_EQ(at(Outside::ping_pong, 3 + 4 * cycle), is_back ? 2.5f : 2.f);
    EXPECT_FLOAT_EQ(at(Outside::ping_pong, 4.5 + 4 * cycle), is_back ? 2.5f : 2.75f);
  }
  EXPECT_FLOAT_EQ(at(Outside::proceed, 0), -1);
  EXPECT_FLOAT_EQ(at(Outside::proceed, 8), 1);
  const Curve<float> straight({{0, 0.f, {}}, {1, 2.f, {}}}, Interpolation::hermite, {Outside::proceed, Outside::proceed});
  EXPECT_FLOAT_EQ(straight.at(2), 4);
  const Curve<float> tangent({{0, 0.f, {2.f}}, {1, 1.f, {-1.f}}}, Interpolation::hermite, {Outside::proceed, Outside::proceed});
  EXPECT_FLOAT_EQ(tangent.at(-2), -4);
  EXPECT_FLOAT_EQ(tangent.at(3), -1);
}

// A walk: no jump where a cycle ends, and no corner.
TEST(Curve, CycleOffsetWalks) {
  for (const Interpolation how : {Interpolation::linear, Interpolation::smooth, Interpolation::spline}) {
    const Curve<float> curve({{0, 0.f, {}}, {3, 0.2f, {}}, {4, 1.f, {}}}, how, {Outside::cycle_offset, Outside::cycle_offset});
    for (const double joint : {-4, 0, 4, 40}) {
      EXPECT_NEAR(curve.at(joint - 1e-6), curve.at(joint + 1e-6), 1e-4);
      if (how == Interpolation::linear) continue;
      EXPECT_NEAR(slope(curve, joint, -1e-2), slope(curve, joint, 1e-2), 0.05) << "a corner would be 0.7";
    }
    EXPECT_NEAR(curve.at(43), 10.2f, 1e-4);
  }
}

TEST(Curve, NamesItsKeysInEveryCycleAsBreaks) {
  const Keys keys{{0, 0.f, {}}, {1, 1.f, {}}, {4, 0.f, {}}};
  const auto breaks = [&](Outside outside, double from, double to) {
    std::vector<double> all = Curve<float>(keys, Interpolation::linear, {outside, outside}).breaks(from, to);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  };
  using Frames = std::vector<double>;
  EXPECT_EQ(breaks(Outside::hold, 0.5, 9), (Frames{1, 4}));
  EXPECT_EQ(breaks(Outside::cycle, 4.5, 9.5), (Frames{5, 8, 9}));
  EXPECT_EQ(breaks(Outside::cycle, -3.5, 0), (Frames{-3, 0}));
  EXPECT_EQ(breaks(Outside::ping_pong, 3, 8.5), (Frames{4, 7, 8}));
  EXPECT_LT(breaks(Outside::cycle, 1e6, 2e6).size(), 1000u);
}

TEST(Curve, OfVectorsAndColoursGoesByComponents) {
  const Curve<Vec3> curve({{0, Vec3(0, 1, 5), {}}, {2, Vec3(1, 0, 5), {}}, {3, Vec3(2, 3, 5), {}}}, Interpolation::smooth);
  const Curve<float> x({{0, 0.f, {}}, {2, 1.f, {}}, {3, 2.f, {}}}, Interpolation::smooth);
  const Curve<float> y({{0, 1.f, {}}, {2, 0.f, {}}, {3, 3.f, {}}}, Interpolation::smooth);
  for (double t = 0; t <= 3; t += 0.1) {
    EXPECT_NEAR(curve.at(t).x, x.at(t), 1e-6);
    EXPECT_NEAR(curve.at(t).y, y.at(t), 1e-6);
    EXPECT_EQ(curve.at(t).z, 5);
  }
}

} // namespace
} // namespace kelpie
