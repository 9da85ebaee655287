// The camera of `kelpie liquid`: it holds what it follows.
#include "cli/shot.h"

#include <cmath>

#include <gtest/gtest.h>

namespace kelpie {
namespace {

constexpr CameraMove k_moves[] = {CameraMove::orbit, CameraMove::dolly, CameraMove::still};

/// The corners of a box that stands on `foot`.
std::vector<Vec3> box_at(const Vec3& foot, const Vec3& size) {
  std::vector<Vec3> points;
  for (const float x : {-0.5f, 0.5f})
    for (const float y : {0.f, 1.f})
      for (const float z : {-0.5f, 0.5f}) points.push_back(foot + Vec3(x, y, z) * size);
  return points;
}

/// A box that grows to twice its height while it wanders, in 96 frames.
std::vector<SubjectMoment> growing_box(int intervals) {
  std::vector<SubjectMoment> moments;
  for (int i = 0; i <= intervals; ++i) {
    const double t = double(i) / intervals, eased = t * t * (3 - 2 * t);
    moments.push_back({1 + 95 * t, box_at(Vec3(0.5 * eased, 0, 0.3 * std::sin(3 * t)), Vec3(1, 1 + eased, 1))});
  }
  return moments;
}

void expect_inside(const PictureBox& box) {
  EXPECT_GT(box.lower.x, -0.95);
  EXPECT_GT(box.lower.y, -0.95);
  EXPECT_LT(box.upper.x, 0.95);
  EXPECT_LT(box.upper.y, 0.95);
}

TEST(Shot, TheSubjectFillsTwoThirdsOfTheHeightAtEveryMoment) {
  for (const CameraMove move : {CameraMove::orbit, CameraMove::dolly}) {
    const CameraPath path = follow(growing_box(32), move, 16.0 / 9);
    for (const SubjectMoment& m : growing_box(95)) { // every frame, not only the moments that were looked at
      const PictureBox seen = covered(m.points, path.at(m.frame), 16.0 / 9);
      EXPECT_NEAR(seen.size().y / 2, 2.0 / 3, 0.08) << m.frame;
      expect_inside(seen);
    }
  }
}

TEST(Shot, ACameraThatStandsHoldsAllMoments) {
  const CameraPath path = follow(growing_box(32), CameraMove::still, 16.0 / 9);
  ASSERT_EQ(path.keys().size(), 1u);
  double tallest = 0;
  for (const SubjectMoment& m : growing_box(95)) {
    const PictureBox seen = covered(m.points, path.at(m.frame), 16.0 / 9);
    tallest = std::max(tallest, seen.size().y / 2);
    expect_inside(seen);
  }
  EXPECT_NEAR(tallest, 2.0 / 3, 0.08);
}

TEST(Shot, WhatIsTooWideForItsHeightFitsByItsWidth) {
  for (const CameraMove move : k_moves)
    for (const double aspect : {16.0 / 9, 9.0 / 16}) {
      std::vector<SubjectMoment> moments;
      for (int frame = 1; frame <= 9; ++frame) moments.push_back({double(frame), box_at(Vec3(0), Vec3(4, 0.5, 1))});
      const CameraPath path = follow(moments, move, aspect);
      for (const SubjectMoment& m : moments) {
        const PictureBox seen = covered(m.points, path.at(m.frame), aspect);
        EXPECT_NEAR(seen.size().x / 2, 0.8, 0.1) << m.frame;
        expect_inside(seen);
      }
    }
}

// Parts that come and go for a moment are held, though the camera does not twitch after them.
TEST(Shot, WhatComesAndGoesStaysInThePicture) {
  std::vector<SubjectMoment> moments = growing_box(32);
  moments[16].points.emplace_back(Vec3(0, 3.2, 0));
  for (const CameraMove move : k_moves) {
    const CameraPath path = follow(moments, move, 16.0 / 9), calm = follow(growing_box(32), move, 16.0 / 9);
    expect_inside(covered(moments[16].points, path.at(moments[16].frame), 16.0 / 9));
    for (size_t i = 0; i + 1 < path.keys().size(); ++i) {
      const double turn = glm::length(path.keys()[i + 1].look_at - path.keys()[i].look_at);
      EXPECT_LT(turn, glm::length(calm.keys()[i + 1].look_at - calm.keys()[i].look_at) + 0.25);
    }
  }
}

TEST(Shot, TheOrbitGoesAroundTheSubject) {
  const CameraPath path = follow(growing_box(32), CameraMove::orbit, 16.0 / 9);
  const auto side = [](const CameraKey& k) { return std::atan2(k.position.x - k.look_at.x, k.position.z - k.look_at.z) * 57.29578; };
  EXPECT_NEAR(side(path.at(96)) - side(path.at(1)), 40, 1);
  for (double frame = 1; frame < 96; frame += 0.5) { // without a halt or a jerk
    const double step = side(path.at(frame + 0.5)) - side(path.at(frame));
    EXPECT_NEAR(step, 40 / 95.0 / 2, 0.1) << frame;
  }
}

/// A box that grows and shrinks again.
std::vector<SubjectMoment> breathing_box(int intervals) {
  std::vector<SubjectMoment> moments;
  for (int i = 0; i <= intervals; ++i) {
    const double t = double(i) / intervals, swing = std::sin(2 * 3.14159265358979 * t);
    moments.push_back({1 + 96 * t, box_at(Vec3(0.5 * swing, 0, 0), Vec3(1, 1.5 + 0.5 * swing, 1))});
  }
  return moments;
}

// Frame 97 is frame 1, and the way goes on smoothly across it, again and again.
TEST(Shot, ALoopCloses) {
  for (const CameraMove move : k_moves) {
    const CameraPath path = follow(breathing_box(64), move, 16.0 / 9, {2, true});
    EXPECT_EQ(path.keys().size(), move == CameraMove::still ? 1u : 17u);
    for (const double frame : {0.75, 1.0, 1.3, 40.0}) {
      EXPECT_EQ(path.at(frame).position, path.at(frame + 96).position) << frame;
      EXPECT_EQ(path.at(frame).look_at, path.at(frame + 96).look_at) << frame;
    }
    const auto way = [&](double from, double to) { return path.at(to).position - path.at(from).position; };
    EXPECT_LT(glm::length(way(96.5, 97) - way(97, 97.5)), 0.005);
    for (const SubjectMoment& m : breathing_box(96)) expect_inside(covered(m.points, path.at(m.frame), 16.0 / 9));
    if (move == CameraMove::still) continue;
    EXPECT_GT(glm::length(way(1, 49)), 0.1) << "there and back";
    EXPECT_NE(path.text().find("\"before\": \"cycle\", \"after\": \"cycle\""), std::string::npos);
  }
}

} // namespace
} // namespace kelpie
