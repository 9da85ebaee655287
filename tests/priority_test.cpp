// Shapes that overlap, in an order: what fills a place, and which surfaces a ray sees on its way. The reference knows the balls'
// intervals along the ray.
#include <algorithm>

#include <gtest/gtest.h>

#include "renderer/trace/tracer.h"
#include "tests/support/random_scene.h"

namespace kelpie {
namespace {

struct Ball {
  Vec3 centre;
  float radius;
  int priority;
};

FrameScene scene_of(const std::vector<Ball>& balls) {
  FrameScene scene;
  for (const Ball& ball : balls) {
    SampledShape& shape = scene.shapes.emplace_back();
    shape.field = field_of({Blob{ball.centre, float(ball.radius / std::sqrt(1 - std::sqrt(0.5))), 2, Falloff::quartic}});
    shape.priority = ball.priority;
  }
  return scene;
}

/// A surface on the way, and what fills the place behind it.
struct Crossing {
  double t;
  uint32_t shape;
  bool is_leaving;
  std::optional<uint32_t> behind;
};

/// From the intervals; empty too where surfaces lie so close together that their order is a matter of rounding.
std::vector<Crossing> crossings_by_intervals(const std::vector<Ball>& balls, const Ray& ray, bool& is_close_call) {
  struct Interval {
    double from, to;
  };
  std::vector<Interval> within;
  std::vector<double> ends{0};
  for (const Ball& ball : balls) {
    const Vec3d to_centre(ball.centre - ray.origin);
    const double middle = glm::dot(to_centre, Vec3d(ray.direction));
    const double half2 = double(ball.radius) * double(ball.radius) - (glm::dot(to_centre, to_centre) - middle * middle);
    const double half = std::sqrt(std::max(half2, 0.0));
    is_close_call |= std::abs(half2) < 0.02;
    within.push_back(half2 > 0 ? Interval{middle - half, middle + half} : Interval{-1, -1});
    if (half2 > 0) ends.push_back(middle - half), ends.push_back(middle + half);
  }
  std::sort(ends.begin(), ends.end());
  for (size_t i = 1; i < ends.size(); ++i) is_close_call |= ends[i] - ends[i - 1] < 0.02;

  const auto highest_at = [&](double t) {
    std::optional<uint32_t> best;
    for (uint32_t i = 0; i < balls.size(); ++i)
      if (within[i].from < t && t < within[i].to && (!best || balls[i].priority >= balls[*best].priority)) best = i;
    return best;
  };
  std::vector<Crossing> seen;
  constexpr double k_step = 0.005;
  for (uint32_t i = 0; i < balls.size(); ++i)
    for (const double t : {within[i].from, within[i].to}) {
      if (t < 0) continue;
      const bool is_leaving = t == within[i].to;
      const std::optional<uint32_t> outside = highest_at(is_leaving ? t + k_step : t - k_step);
      if (outside && balls[*outside].priority > balls[i].priority) continue;
      seen.push_back({t, i, is_leaving, highest_at(t + k_step)});
    }
  std::sort(seen.begin(), seen.end(), [](const Crossing& a, const Crossing& b) { return a.t < b.t; });
  return seen;
}

/// From surface to surface, as a path goes.
std::vector<Crossing> crossings_by_tracing(const Tracer& tracer, Ray ray) {
  std::vector<Crossing> seen;
  const Vec3 start = ray.origin;
  SolveCounters counters;
  for (Hit hit; seen.size() < 100 && tracer.intersect(ray, counters, hit) && tracer.pass_hidden(ray, counters, hit);) {
    const Ray next = depart(ray, hit, ray.direction, Side::far);
    seen.push_back({glm::length(hit.position - start), hit.shape, hit.is_leaving, tracer.media().filling(next.inside)});
    ray = next;
  }
  return seen;
}

void expect_same(const std::vector<Crossing>& found, const std::vector<Crossing>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].t, expected[i].t, 2e-2);
    EXPECT_EQ(found[i].shape, expected[i].shape);
    EXPECT_EQ(found[i].is_leaving, expected[i].is_leaving);
    EXPECT_EQ(found[i].behind, expected[i].behind);
  }
}

Ray along_x() {
  Ray ray;
  ray.origin = {-5, 0.01f, 0.02f}, ray.direction = {1, 0, 0};
  return ray;
}

TEST(Priority, TheHighestFillsThePlaceAndHidesTheSurfacesOfOthers) {
  FrameScene scene;
  scene.shapes.resize(4);
  scene.shapes[1].priority = 2, scene.shapes[2].priority = 2, scene.shapes[3].priority = -1;
  const Media media(scene.shapes);
  ShapeSet around;
  EXPECT_EQ(media.filling(around), std::nullopt);
  EXPECT_TRUE(media.is_seen(3, around));
  around.add(3);
  EXPECT_EQ(media.filling(around), 3u);
  EXPECT_TRUE(media.is_seen(3, around)); // its own does not hide it
  around.add(0);
  EXPECT_EQ(media.filling(around), 0u);
  EXPECT_FALSE(media.is_seen(3, around));
  around.add(2), around.add(1);
  EXPECT_EQ(media.filling(around), 2u); // of equals the later
  EXPECT_FALSE(media.is_seen(0, around));
  EXPECT_TRUE(media.is_seen(1, around));
  EXPECT_TRUE(media.is_seen(2, around));
  EXPECT_TRUE(media.hides());
  for (SampledShape& shape : scene.shapes) shape.priority = 7;
  EXPECT_FALSE(Media(scene.shapes).hides());
}

// Water that reaches into the wall of its glass: where the glass is, there is no water.
TEST(Priority, WaterInGlass) {
  const std::vector<Ball> balls{{Vec3(-0.5f, 0, 0), 1, 1}, {Vec3(0.5f, 0, 0), 1, 0}}; // glass, water
  bool is_close_call = false;
  const std::vector<Crossing> expected = crossings_by_intervals(balls, along_x(), is_close_call);
  ASSERT_EQ(expected.size(), 3u); // into the glass, from the glass into the water, out of the water
  EXPECT_EQ(expected[0].behind, 0u);
  EXPECT_EQ(expected[1].behind, 1u);
  EXPECT_EQ(expected[2].behind, std::nullopt);
  expect_same(crossings_by_tracing(Tracer(scene_of(balls)), along_x()), expected);
}

// What lies wholly in a medium of higher priority is not there, and casts no shadow.
TEST(Priority, WhatIsHiddenCastsNoShadow) {
  const std::vector<Ball> balls{{Vec3(0), 2, 1}, {Vec3(0), 0.5f, 0}};
  const Tracer tracer(scene_of(balls));
  EXPECT_EQ(crossings_by_tracing(tracer, along_x()).size(), 2u);
  Ray ray = along_x();
  ray.origin.x = -1, ray.t_far = 2, ray.inside.add(0);
  SolveCounters counters;
  Hit hit;
  EXPECT_TRUE(tracer.intersect(ray, counters, hit)); // it is still in the way
  EXPECT_FALSE(tracer.occluded(ray, counters));
  EXPECT_EQ(tracer.occluded(std::span(&ray, 1), counters), 0u);
  ray.t_far = 4;
  EXPECT_TRUE(tracer.occluded(ray, counters));
  EXPECT_EQ(tracer.occluded(std::span(&ray, 1), counters), 1u);
}

TEST(Priority, AnyBallsInAnyOrder) {
  int judged = 0, hidden = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Random r(static_cast<unsigned>(trial));
    std::vector<Ball> balls;
    for (int i = 2 + r.below(5); i > 0; --i)
      balls.push_back({Vec3(r.in(Box3d{Vec3d(-1), Vec3d(1)})), float(r.uniform(0.3, 1.2)), r.below(3)});
    const Tracer tracer(scene_of(balls));
    for (int i = 0; i < 100; ++i) {
      Ray ray;
      ray.origin = Vec3(4.0 * r.direction());
      ray.direction = glm::normalize(Vec3(r.in(Box3d{Vec3d(-1), Vec3d(1)})) - ray.origin);
      bool is_close_call = false;
      const std::vector<Crossing> expected = crossings_by_intervals(balls, ray, is_close_call);
      if (is_close_call) continue;
      SCOPED_TRACE(testing::Message() << "trial " << trial << ", ray " << i);
      expect_same(crossings_by_tracing(tracer, ray), expected);
      std::vector<Ball> equals = balls;
      for (Ball& ball : equals) ball.priority = 0;
      ++judged, hidden += crossings_by_intervals(equals, ray, is_close_call).size() > expected.size();
    }
  }
  EXPECT_GT(judged, 5000);
  EXPECT_GT(hidden, 500);
}

} // namespace
} // namespace kelpie
