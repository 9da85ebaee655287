// Axial deformation against the reference, and what its tubes promise.
#include <gtest/gtest.h>

#include "field/warps/axis_tube.h"
#include "field/warps/axis_work.h"
#include "tests/support/random_kind.h"
#include "tests/support/reference_scene.h"

namespace kelpie {
namespace {

Vec3d rest(const AxialMap& map, const Vec3d& p) {
  const Point3<double> r = map.rest({p.x, p.y, p.z});
  return {r.x, r.y, r.z};
}

/// A straight axis from the origin to (0, 2, 0).
AxisShape straight() {
  AxisShape shape;
  for (const double y : {0.0, 0.5, 1.0, 1.5, 2.0}) shape.rest.emplace_back(0, y, 0);
  shape.deformed = shape.rest, shape.radius = 0.5;
  return shape;
}

double brute_distance(const AxisCurve& curve, const Vec3d& p) {
  double least = INFINITY;
  for (size_t i = 0; i < curve.steps(); ++i)
    for (int j = 0; j <= 200; ++j) least = std::min(least, glm::distance(p, curve.step(i)(j / 200.0)));
  return least;
}

TEST(Axial, AnAxisThatIsMovedTakesItsTubeAlong) {
  AxisShape shape = straight();
  for (Vec3d& p : shape.deformed) p += Vec3d(3, 0, 1);
  const AxialMap map(std::span(&shape, 1));
  EXPECT_LT(glm::distance(rest(map, {3.2, 0.7, 1.1}), Vec3d(0.2, 0.7, 0.1)), 1e-12);
  EXPECT_LT(glm::distance(rest(map, {3, 2.2, 1}), Vec3d(0, 2.2, 0)), 1e-12); // beyond its end too
  EXPECT_EQ(rest(map, {-1, 1, 0}), Vec3d(-1, 1, 0));                         // outside all stays
  EXPECT_GT(glm::length(rest(map, {0.2, 0.7, 0.1})), 1000) << "where the axis has left, nothing remains";
}

TEST(Axial, FramesTwistByCosineOfTheLengthBetweenThem) {
  AxisShape shape = straight();
  shape.frames = {{0.5, glm::radians(180.0)}};
  for (const bool is_linear : {false, true}) {
    shape.interpolation = is_linear ? FrameInterpolation::linear : FrameInterpolation::cosine;
    const AxialMap map(std::span(&shape, 1));
    const auto turned = [&](double y) { // right-handed about y: from z towards x
      const Vec3d q = rest(map, {0, y, 0.3});
      EXPECT_NEAR(q.y, y, 1e-9);
      EXPECT_NEAR(std::hypot(q.x, q.z), 0.3, 1e-7);
      return glm::degrees(std::atan2(-q.x, q.z));
    };
    EXPECT_NEAR(turned(0), 0, 1e-4);
    EXPECT_NEAR(std::abs(turned(1)), 180, 1e-4);
    EXPECT_NEAR(turned(0.5), 90, 1e-4);
    EXPECT_NEAR(turned(0.25), is_linear ? 45 : 90 * (1 - std::sqrt(0.5)), 1e-4);
    EXPECT_NEAR(turned(1.5), 90, 1e-4);
    EXPECT_NEAR(turned(2), 0, 1e-4);
  }
}

TEST(Axial, WhatIsNotMovedStaysToTheLastDigits) {
  AxisShape shape = straight();
  shape.rest = shape.deformed = {{0, 0, 0}, {0.1, 0.5, 0}, {0, 1, 0}, {0, 1.5, 0.1}, {0, 2, 0}, {0.3, 2.5, 0}, {0, 3, 0}};
  shape.deformed.back() = {1, 2.8, 0.5};
  const AxialMap map(std::span(&shape, 1));
  for (const Vec3d& p : {Vec3d(0.1, 0.2, 0), Vec3d(0.05, 0.4, 0.2), Vec3d(0, -0.3, 0.1)}) EXPECT_LT(glm::distance(rest(map, p), p), 1e-13);
}

TEST(Axial, TornImagesHoldAllThatIsSomewhere) {
  int torn = 0, narrow = 0;
  for (unsigned trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    const auto kind = random_kind<Axial>(r);
    if (kind.map->tubes().empty()) continue;
    const Vec3d at = r.in(kind.map->tubes()[0].deformed().box()), half(r.log_uniform(1e-3, 0.3));
    const Box3d box{at - half, at + half};
    std::vector<Box3d> images;
    if (!kind.torn_images(box, images)) continue;
    ++torn;
    double volume = 0;
    for (const Box3d& image : images) volume += image.extent().x * image.extent().y * image.extent().z;
    narrow += volume < 100;
    for (int i = 0; i < 40; ++i) {
      const Vec3d q = rest(*kind.map, r.in(box));
      EXPECT_TRUE(q.x > 1e4 || std::any_of(images.begin(), images.end(), [&](const Box3d& b) { return b.padded(1e-9).contains(q); }));
    }
  }
  EXPECT_GT(torn, 50);
  EXPECT_GT(narrow, torn / 2) << "what is nowhere is in no box";
}

TEST(Axial, AgreesWithTheReference) {
  int in_tubes = 0;
  for (unsigned trial = 0; trial < 60 && !testing::Test::HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    auto kind = random_kind<Axial>(r);
    reference::Axial axial;
    for (auto& axis : kind.axes) {
      axis.radius = 0.99f * float(AxisTube(kind.shape(axis)).cut_radius()); // the reference cuts none
      axial.axes.push_back(reference_of(axis));
    }
    kind.prepare();
    axial.prepare();
    for (int i = 0; i < 100; ++i) {
      const Vec3d p = r.in(i % 2 || kind.map->tubes().empty() ? Box3d{Vec3d(-1.5), Vec3d(1.5)} : kind.map->tubes()[0].deformed().box());
      const Point3<double> q = kind.child_from_parent(Point3<double>{p.x, p.y, p.z});
      const reference::Vec e = reference::undeformed(axial, {p.x, p.y, p.z});
      const double error = glm::distance(Vec3d(q.x, q.y, q.z), Vec3d(e.x, e.y, e.z));
      EXPECT_TRUE(error < 2e-6 || (q.x > 1e4 && e.x > 1e4)) << error << " at " << p.x << ' ' << p.y << ' ' << p.z;
      in_tubes += Vec3d(q.x, q.y, q.z) != p && q.x < 1e4;
    }
  }
  EXPECT_GT(in_tubes, 500);
}

// The paper: usually within three iterations.
TEST(Axial, InvertsInAboutThreeNewtonSteps) {
  axis_work() = {};
  Random r(1);
  const auto kind = random_kind<Axial>(r);
  for (int i = 0; i < 20000; ++i) rest(*kind.map, r.in(Box3d{Vec3d(-1.5), Vec3d(1.5)}));
  const AxisWork work = axis_work();
  EXPECT_GT(work.inversions, 1000u);
  EXPECT_LE(double(work.newton_steps), 3.2 * double(work.inversions));
}

TEST(AxisTube, IsCutBeforeAPointHasTwoPlaces) {
  AxisShape shape = straight(); // a hairpin, a unit wide
  shape.deformed = {{0, 0, 0}, {0, 2, 0}, {0.5, 3, 0}, {1, 2, 0}, {1, 0, 0}};
  shape.rest = {{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {0, 3, 0}, {0, 4, 0}};
  shape.radius = 2;
  const AxisTube tube(shape);
  EXPECT_LT(tube.cut_radius(), 0.5);
  Random r(3);
  int inside = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3d p = r.in(tube.deformed().box());
    AxisFoot foot;
    if (!tube.deformed().find(p, foot)) continue;
    ++inside;
    EXPECT_LE(foot.distance, brute_distance(tube.deformed(), p) + 1e-4);
  }
  EXPECT_GT(inside, 300);
}

TEST(AxisTube, NeverFoldsSpace) {
  int inside = 0;
  for (unsigned trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    auto kind = random_kind<Axial>(r);
    kind.axes.resize(1), kind.axes[0].radius = 3, kind.axes[0].border = 0.01f;
    const AxisTube tube(kind.shape(kind.axes[0]));
    for (int i = 0; i < 50; ++i) {
      AxisOffer<double> offer;
      if (!tube.offer(r.in(tube.deformed().box()), true, offer)) continue;
      ++inside;
      Mat3d slopes(1.0);
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) slopes[column][row] += offer.by_slopes[row][column];
      EXPECT_GT(glm::determinant(slopes), 0.01);
    }
  }
  EXPECT_GT(inside, 300);
}

/// Where a box seems moved that lies outside the tube, the map seems torn in a whole region, and cells there are slow.
TEST(AxisTube, ASmallBoxIsMovedAsItsCentreIs) {
  int asked = 0, moved = 0, different = 0;
  for (unsigned trial = 0; trial < 100; ++trial) {
    Random r(trial);
    const auto kind = random_kind<Axial>(r);
    for (const AxisTube& tube : kind.map->tubes())
      for (int i = 0; i < 20; ++i, ++asked) {
        const Vec3d p = r.in(tube.rest().box());
        Vec3d by;
        double limit = 0;
        const bool is_moved = tube.move(p, by, limit) && glm::length(by) > limit;
        const AxisTube::Moved box = tube.moved({p - Vec3d(1e-7), p + Vec3d(1e-7)});
        moved += is_moved, different += box.some != is_moved || box.all != is_moved;
        EXPECT_TRUE(is_moved ? box.some : !box.all);
      }
  }
  EXPECT_GT(moved, asked / 10);
  EXPECT_LT(different, asked / 1000) << "of " << asked; // at the edge of a tube
}

TEST(AxisTube, BoxesHoldTheirFeet) {
  int held = 0;
  for (unsigned trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    const auto kind = random_kind<Axial>(r);
    const AxisTube tube(kind.shape(kind.axes[0]));
    const Vec3d half(r.log_uniform(1e-4, 0.5), r.log_uniform(1e-4, 0.5), r.log_uniform(1e-4, 0.5)), at = r.in(tube.deformed().box());
    const Box3d box{at - half, at + half};
    AxisRange range;
    tube.deformed().find(box, range);
    for (int i = 0; i < 30; ++i) {
      AxisFoot foot;
      const bool is_inside = tube.deformed().find(r.in(box), foot);
      EXPECT_TRUE(is_inside || !range.is_inside);
      if (!is_inside) continue;
      bool is_held = false;
      for (const AxisPart& part : range.parts) is_held |= part.step == foot.step && part.from - 1e-9 <= foot.s && foot.s <= part.to + 1e-9;
      for (const AxisPart& part : range.parts) // a node belongs to two steps
        is_held |= (part.step + 1 == foot.step && foot.s < 1e-9 && part.to > 1 - 1e-9) ||
                   (part.step == foot.step + 1 && foot.s > 1 - 1e-9 && part.from < 1e-9);
      EXPECT_TRUE(is_held);
      ++held;
    }
  }
  EXPECT_GT(held, 1000);
}

} // namespace
} // namespace kelpie
