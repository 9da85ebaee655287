// What single kinds of field are, beyond what every kind is held to (conformance_test.cpp): the places that a
// warp must move things to, and the simpler shapes that degenerate skeletons become.
#include <numbers>

#include <gtest/gtest.h>

#include "field/kinds.h"

namespace kelpie {
namespace {

void expect_near(const Point3<double>& p, const Vec3d& q) { EXPECT_LT(glm::distance(Vec3d(p.x, p.y, p.z), q), 1e-9); }

TEST(Bend, TurnsARodIntoAQuarterOfARing) {
  Bend<SampledMode> bend;
  bend.centre = Vec3(1, 2, 3), bend.angle = 90, bend.length = 2;
  const double r = 4 / std::numbers::pi; // the arc is as long as the rod
  expect_near(bend.parent_from_child(Point3<double>{1, 1, 3}), {1, 1, 3});
  expect_near(bend.parent_from_child(Point3<double>{1, 3, 3}), Vec3d(1 + r * (1 - std::sqrt(0.5)), 2 + r * std::sqrt(0.5), 3));
  expect_near(bend.parent_from_child(Point3<double>{1, 4, 3}), {1 + r, 2 + r, 3});
  expect_near(bend.parent_from_child(Point3<double>{1, 5, 3}), {2 + r, 2 + r, 3});         // straight on
  expect_near(bend.parent_from_child(Point3<double>{1.2, 5, 3.5}), {2 + r, 1.8 + r, 3.5}); // below it
  bend.angle = -90;
  expect_near(bend.parent_from_child(Point3<double>{1, 4, 3}), {1 - r, 2 + r, 3});
  bend.angle = 0;
  expect_near(bend.child_from_parent(Point3<double>{1, 4, 3}), {1, 4, 3});
}

TEST(Bend, IsContinuousInItsAngle) {
  Bend<SampledMode> bend;
  for (const float small : {1e-7f, 5e-7f, 1e-6f, 1e-5f}) // about where it becomes the identity
    for (const float angle : {small, -small}) {
      bend.angle = angle;
      const Point3<double> p = bend.child_from_parent(Point3<double>{0.5, 3, 1});
      EXPECT_LT(glm::distance(Vec3d(p.x, p.y, p.z), Vec3d(0.5, 3, 1)), 2e-7 + 0.1 * small);
    }
}

// The ends of a full circle meet, and what lies past the bend axis is cut, not folded.
TEST(Bend, ClosesARing) {
  Bend<SampledMode> bend;
  bend.angle = 360, bend.length = 2;
  const double r = 1 / std::numbers::pi;
  expect_near(bend.parent_from_child(Point3<double>{0, 2, 0}), Vec3d(0));
  for (int i = 1; i < 16; ++i) {
    const double turn = 2 * std::numbers::pi * i / 16;
    expect_near(bend.child_from_parent(Point3<double>{r - 0.5 * std::cos(turn), 0.5 * std::sin(turn), 0}), Vec3d(r - 0.5, 2 * i / 16.0, 0));
  }
}

} // namespace
} // namespace kelpie
