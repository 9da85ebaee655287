// What single kinds of field are, beyond what every kind is held to (conformance_test.cpp): the places that a
// warp must move things to, and the simpler shapes that degenerate skeletons become.
#include <functional>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "field/kinds.h"
#include "field/skeletons/hull_faces.h"

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

TEST(Taper, NarrowsWhatLiesAcross) {
  Taper<SampledMode> taper;
  taper.centre = Vec3(1, 2, 3), taper.by = 0.5f, taper.length = 2;
  expect_near(taper.parent_from_child(Point3<double>{2, 1, 3}), {2, 1, 3});
  expect_near(taper.parent_from_child(Point3<double>{2, 3, 3}), {1.75, 3, 3});
  expect_near(taper.parent_from_child(Point3<double>{2, 4, 5}), {1.5, 4, 4});
  expect_near(taper.parent_from_child(Point3<double>{2, 9, 5}), {1.5, 9, 4});
}

// --- skeletons ---

Vec3d random_place(std::mt19937& engine) {
  std::uniform_real_distribution<> u(-1.5, 1.5);
  return {u(engine), u(engine), u(engine)};
}

/// The largest difference of two skeletons at many places.
template <class A, class B>
double difference(const A& a, const B& b) {
  std::mt19937 engine(1);
  double most = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d p = random_place(engine);
    const Point3<double> at{p.x, p.y, p.z};
    most = std::max(most, std::abs(potential(a, at) - potential(b, at)));
  }
  return most;
}

/// A kind with an influence of 1 whose shape is at hand.
template <template <class> class Kind>
Kind<SampledMode> skeleton(const std::function<void(Kind<SampledMode>&)>& set) {
  Kind<SampledMode> kind;
  kind.weight = 2;
  set(kind);
  return kind;
}

const Vec3 k_a(-0.3f, 0.1f, 0.4f), k_b(0.7f, -0.2f, 0.1f), k_c(0.2f, 0.8f, -0.5f), k_d(-0.4f, -0.6f, -0.3f);
constexpr float k_tiny = 1e-6f; ///< a parameter that is nearly 0 makes nearly the simpler shape

Segment<SampledMode> segment(const Vec3& from, const Vec3& to) {
  return skeleton<Segment>([&](auto& k) { k.from = from, k.to = to; });
}

TEST(Skeletons, SolidsOfRevolutionDegenerate) {
  const auto cylinder = [](float r, const Vec3& to = k_b) {
    return skeleton<Cylinder>([&](auto& k) { k.from = k_a, k.to = to, k.cylinder_radius = r; });
  };
  const auto cone = [](float r, float s, const Vec3& to = k_b) {
    return skeleton<Cone>([&](auto& k) { k.from = k_a, k.to = to, k.from_radius = r, k.to_radius = s; });
  };
  const auto wall = [](float r, float s, float thickness, const Vec3& to = k_b) {
    return skeleton<HollowCone>(
        [&](auto& k) { k.from = k_a, k.to = to, k.from_radius = r, k.to_radius = s, k.from_thickness = k.to_thickness = thickness; });
  };
  const auto disc = [](float r) { return skeleton<Disc>([&](auto& k) { k.centre = k_a, k.disc_radius = r; }); };
  EXPECT_LT(difference(cylinder(0), segment(k_a, k_b)), 1e-9);
  EXPECT_LT(difference(cylinder(k_tiny), segment(k_a, k_b)), 1e-5);
  EXPECT_LT(difference(cylinder(0.5f, k_a), disc(0.5f)), 1e-9);
  EXPECT_LT(difference(cylinder(0.5f, k_a + Vec3(0, k_tiny, 0)), disc(0.5f)), 1e-5);
  EXPECT_LT(difference(cone(0.4f, 0.4f), cylinder(0.4f)), 1e-9);
  EXPECT_LT(difference(cone(0.4f, 0.4f + k_tiny), cylinder(0.4f)), 1e-5);
  EXPECT_LT(difference(cone(0, 0), segment(k_a, k_b)), 1e-9);
  EXPECT_LT(difference(cone(0.3f, 0.5f, k_a), disc(0.5f)), 1e-9);
  EXPECT_LT(difference(wall(0, 0, 0), segment(k_a, k_b)), 1e-9);
  EXPECT_LT(difference(wall(0, 0, 0.6f), cylinder(0.3f)), 1e-7); // no hole is left
  EXPECT_LT(difference(wall(0.2f, 0.2f, 0.4f), cylinder(0.4f)), 1e-7);
  const auto circle = skeleton<Circle>([](auto& k) { k.centre = k_a, k.circle_radius = 0.5f; });
  EXPECT_LT(difference(wall(0.5f, 0.5f, 0, k_a), circle), 1e-9);
  EXPECT_LT(difference(wall(0.5f, 0.5f, k_tiny, k_a + Vec3(0, k_tiny, 0)), circle), 1e-5);
}

TEST(Skeletons, CirclesDegenerate) {
  const auto arc = [](float r, float angle) {
    return skeleton<Arc>([&](auto& k) { k.centre = k_a, k.normal = k_c, k.towards = k_b, k.arc_radius = r, k.angle = angle; });
  };
  const auto circle = [](float r) { return skeleton<Circle>([&](auto& k) { k.centre = k_a, k.normal = k_c, k.circle_radius = r; }); };
  const auto torus = skeleton<Torus>([](auto& k) { k.centre = k_a, k.normal = k_c, k.major_radius = 0.6f; });
  const Vec3d across = Vec3d(k_b) - Vec3d(k_c) * (glm::dot(Vec3d(k_b), Vec3d(k_c)) / glm::dot(Vec3d(k_c), Vec3d(k_c)));
  const Vec3 middle(Vec3d(k_a) + 0.6 * glm::normalize(across));
  EXPECT_LT(difference(circle(0.6f), torus), 1e-9);
  EXPECT_LT(difference(circle(0), segment(k_a, k_a)), 1e-9);
  EXPECT_LT(difference(arc(0.6f, 360), circle(0.6f)), 1e-9);
  EXPECT_LT(difference(arc(0.6f, 360 - 1e-4f), circle(0.6f)), 1e-5);
  EXPECT_LT(difference(arc(0.6f, 0), segment(middle, middle)), 1e-6);
  EXPECT_LT(difference(arc(0.6f, 1e-4f), segment(middle, middle)), 1e-5);
  EXPECT_LT(difference(arc(0, 100), segment(k_a, k_a)), 1e-9);
}

TEST(Skeletons, PolytopesDegenerate) {
  const auto triangle = [](const Vec3& c) { return skeleton<FlatTriangle>([&](auto& k) { k.a = k_a, k.b = k_b, k.c = c; }); };
  const auto prism = [](const Vec3& c, float t) {
    return skeleton<Prism>([&](auto& k) { k.a = k_a, k.b = k_b, k.c = c, k.thickness = t; });
  };
  const auto tetrahedron = [](const Vec3& d) { return skeleton<Tetrahedron>([&](auto& k) { k.a = k_a, k.b = k_b, k.c = k_c, k.d = d; }); };
  const auto hull = [](std::vector<Vec3> points) { return skeleton<Polyhedron>([&](auto& k) { k.points = points; }); };
  const auto box = [](const Vec3& size) {
    return skeleton<Box>([&](auto& k) { k.centre = k_a, k.size = size, k.axis = k_b, k.across = k_c; });
  };
  const auto rectangle = [](float w, float h) {
    return skeleton<Rectangle>([&](auto& k) { k.centre = k_a, k.normal = k_b, k.across = k_c, k.width = w, k.height = h; });
  };
  EXPECT_LT(difference(triangle(k_b), segment(k_a, k_b)), 1e-9);
  EXPECT_LT(difference(triangle(0.5f * (k_a + k_b)), segment(k_a, k_b)), 1e-6);
  EXPECT_LT(difference(prism(k_c, 0), triangle(k_c)), 1e-9);
  EXPECT_LT(difference(prism(k_c, k_tiny), triangle(k_c)), 1e-5);
  EXPECT_LT(difference(tetrahedron(k_a), triangle(k_c)), 1e-9);
  EXPECT_LT(difference(tetrahedron(k_a + k_tiny), triangle(k_c)), 1e-5);
  EXPECT_LT(difference(hull({k_a, k_b, k_c, k_d}), tetrahedron(k_d)), 1e-9);
  EXPECT_LT(difference(hull({k_a, k_b, 0.5f * (k_a + k_b), k_c, k_b, 0.3f * (k_a + k_b + k_c) + 0.1f * k_d, k_d}), tetrahedron(k_d)), 1e-9);
  EXPECT_LT(difference(hull({k_a}), segment(k_a, k_a)), 1e-9);
  EXPECT_LT(difference(hull({k_a, k_b, k_a}), segment(k_a, k_b)), 1e-9);
  EXPECT_LT(difference(box({0.6f, 0, 0.9f}), rectangle(0.6f, 0.9f)), 1e-9);
  EXPECT_LT(difference(box({0.6f, k_tiny, 0.9f}), rectangle(0.6f, 0.9f)), 1e-5);
  EXPECT_LT(difference(rectangle(0, 0), segment(k_a, k_a)), 1e-9);
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.push_back(k_a + Vec3(i & 1 ? 0.3f : -0.3f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.1f : -0.1f));
  const auto upright = skeleton<Box>([](auto& k) { k.centre = k_a, k.size = {0.6f, 1, 0.2f}; });
  EXPECT_LT(difference(hull(corners), upright), 1e-6);
  const auto one_way = [&](const Vec3& size, const Vec3& along) { return difference(box(size), segment(k_a - along, k_a + along)); };
  EXPECT_LT(one_way({0, 1, 0}, 0.5f * glm::normalize(k_b)), 1e-6);
}

// A wall has a hole: inside it the potential falls off again.
TEST(Skeletons, AHollowConeIsHollow) {
  const auto tube =
      skeleton<HollowCone>([](auto& k) { k.from_radius = k.to_radius = 0.8f, k.from_thickness = k.to_thickness = 0.1f, k.radius = 0.5f; });
  EXPECT_EQ(potential(tube, Point3<double>{0, 0.5, 0}), 0);
  EXPECT_EQ(potential(tube, Point3<double>{0.8, 0.5, 0}), 2);
  EXPECT_EQ(potential(tube, Point3<double>{0.755, 0.5, 0}), 2);
  EXPECT_LT(potential(tube, Point3<double>{0.745, 0.5, 0}), 2);
}

/// The nearest face, or 0 inside: as the solvers of trees see a hull.
double distance_to_faces(const std::vector<HullFace>& faces, const Vec3d& p) {
  double least = std::numeric_limits<double>::infinity();
  bool is_inside = true, is_over = false;
  for (const HullFace& face : faces) {
    const Point3<double> q = face.frame.local(Point3<double>{p.x, p.y, p.z});
    const Vec2d r = from_nearest(face.corners, {q.x, q.y});
    const double d = norm(norm(r.x, r.y), q.z);
    is_inside &= q.z <= 0;
    if (d < least) least = d, is_over = r == Vec2d(0);
  }
  return is_inside && is_over ? 0 : least;
}

// Points in general, on a cube's edges and faces, in a plane, on a line, in one place, and with copies.
TEST(Skeletons, AHullIsItsFaces) {
  std::mt19937 engine(1);
  const auto uniform = [&](double lower, double upper) { return std::uniform_real_distribution<>(lower, upper)(engine); };
  for (int trial = 0; trial < 200; ++trial) {
    const int form = trial % 5;
    std::vector<Vec3> points;
    for (int i = 0; i < (form == 4 ? 1 : 4 + trial % 9); ++i) {
      Vec3d p(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      if (form == 1) p = glm::round(p * 1.5); // {-1, 0, 1}
      if (form == 2) p = p.x * Vec3d(0.6, 0.8, 0) + p.y * Vec3d(0, 0, 1);
      if (form == 3) p = p.x * Vec3d(0.6, 0.8, 0);
      points.insert(points.end(), 1 + i % 3 / 2, Vec3(p));
    }
    const std::vector<HullFace> faces = hull_faces(points);
    for (int i = 0; i < 50; ++i) {
      const Vec3d p(uniform(-2, 2), uniform(-2, 2), i % 4 ? uniform(-2, 2) : 0);
      const double d = std::sqrt(squared_hull_distance(points, Point3<double>{p.x, p.y, p.z}).squared);
      ASSERT_NEAR(distance_to_faces(faces, p), d, 1e-6) << trial << ' ' << i;
    }
  }
  std::vector<Vec3> cube;
  for (int i = 0; i < 8; ++i) cube.push_back(Vec3(i & 1, i >> 1 & 1, i >> 2 & 1));
  EXPECT_EQ(hull_faces(cube).size(), 6u);
}

} // namespace
} // namespace kelpie
