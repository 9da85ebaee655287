// The reference is itself tested: against point by point evaluation, against dense marching, and
// against surfaces whose roots are known.
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/reference/verdict.h"

namespace reference {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

struct Random {
  std::mt19937_64 engine;
  explicit Random(int trial) : engine(trial) {}
  double uniform(double lo, double hi) { return std::uniform_real_distribution<>(lo, hi)(engine); }
  int below(int n) { return std::uniform_int_distribution<>(0, n - 1)(engine); }
  Vec point(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
};

NodePtr make(Node::Kind kind, std::vector<NodePtr> children) {
  auto n = std::make_shared<Node>();
  n->kind = kind;
  n->children = std::move(children);
  return n;
}

NodePtr make(std::vector<Leaf> leaves) {
  auto n = std::make_shared<Node>();
  n->leaves = std::move(leaves);
  return n;
}

Leaf random_leaf(Random& r) {
  Leaf leaf{
      .a = r.point(1), .b = {}, .radius = r.uniform(0.3, 1.2), .weight = r.uniform(-1, 2.5), .falloff = static_cast<Falloff>(r.below(3))};
  const int form = r.below(4); // a point, a short segment, a long one, one along an axis of coordinates
  leaf.b = form == 0 ? leaf.a : form == 1 ? leaf.a + r.point(0.01) : form == 2 ? r.point(1) : leaf.a + Vec{0, 0, 0.7};
  return leaf;
}

NodePtr random_tree(Random& r, int depth) {
  if (depth == 0) {
    std::vector<Leaf> leaves(1 + r.below(4));
    for (Leaf& leaf : leaves) leaf = random_leaf(r);
    return make(std::move(leaves));
  }
  const auto kind = static_cast<Node::Kind>(1 + r.below(5));
  if (kind == Node::Kind::warp) {
    auto n = std::make_shared<Node>();
    n->kind = kind;
    n->children = {random_tree(r, depth - 1)};
    n->child_from_parent = {{Vec{1.1, 0.3, 0}, Vec{-0.2, 0.8, 0.1}, Vec{0.1, 0.1, 1.3}}, r.point(0.2)};
    return n;
  }
  std::vector<NodePtr> children(2 + r.below(2));
  for (NodePtr& c : children) c = random_tree(r, depth - 1);
  return make(kind, std::move(children));
}

Ray random_ray(Random& r) {
  const Vec origin = r.point(1) * 5, target = r.point(1);
  return {origin, (target - origin) * (1 / length(target - origin))};
}

TEST(Reference, RootsOfProductsOfLinearFactors) {
  for (const double gap : {0.2, 1e-3, 1e-5}) {
    // (q(s) - c)^2-like quartics with two close roots on either side of 0.4: q^2 with q vanishing there, less a little.
    const Quadratic q{-0.4, 0.1, 0.6}; // the line s - 0.4
    const Polynomial p = square_times_linear(q, 1, 0) - constant(gap * gap);
    const std::vector<double> roots = sign_changes(p, 1e-16);
    ASSERT_EQ(roots.size(), 2u) << gap;
    EXPECT_NEAR(roots[0], 0.4 - gap, 1e-9);
    EXPECT_NEAR(roots[1], 0.4 + gap, 1e-9);
  }
}

TEST(Reference, ProfileEqualsTheFieldPointByPoint) {
  for (int trial = 0; trial < 300; ++trial) {
    Random r(trial);
    const NodePtr tree = random_tree(r, trial % 4);
    const Ray ray = random_ray(r);
    const Profile profile = along_ray(*tree, ray, 0, 14, 1);
    ASSERT_EQ(profile.front().from, 0);
    ASSERT_EQ(profile.back().to, 14);
    for (int i = 0; i < 300; ++i) {
      const double t = r.uniform(0, 14);
      ASSERT_NEAR(value(profile, t), value(*tree, ray.at(t), 1), 1e-11) << "trial " << trial << ", t " << t;
    }
  }
}

TEST(Reference, SpansAgreeWithDenseMarching) {
  constexpr int k_steps = 20000;
  for (int trial = 0; trial < 60; ++trial) {
    Random r(1000 + trial);
    const NodePtr tree = random_tree(r, trial % 3);
    const Ray ray = random_ray(r);
    const std::vector<Span> spans = above(along_ray(*tree, ray, 0, 14, 1), 1);
    size_t next = 0;
    for (int i = 0; i <= k_steps; ++i) {
      const double t = 14.0 * i / k_steps, f = value(*tree, ray.at(t), 1);
      while (next < spans.size() && spans[next].to < t) ++next;
      const bool inside = next < spans.size() && spans[next].from <= t;
      if (std::abs(f - 1) > 1e-9) {
        ASSERT_EQ(inside, f > 1) << "trial " << trial << ", t " << t;
      }
    }
  }
}

/// Any shape of leaf.
Leaf random_solid(Random& r) {
  Leaf leaf = random_leaf(r);
  leaf.shape = static_cast<Leaf::Shape>(r.below(9));
  leaf.r = r.uniform(0, 0.5), leaf.s = r.uniform(0, 0.5), leaf.normal = r.point(1);
  leaf.towards = r.point(1), leaf.angle = r.uniform(0, 360), leaf.size = {r.uniform(0, 1), r.uniform(0, 1), r.uniform(0, 1)};
  leaf.r_thickness = r.uniform(0, 0.4), leaf.s_thickness = r.uniform(0, 0.4);
  leaf.points = {leaf.a};
  for (int i = r.below(6); i > 0; --i) leaf.points.push_back(r.point(1));
  return leaf;
}

Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

/// Any point of a solid that is not made of balls, the border more often than the inside.
Vec random_point_of(const Leaf& leaf, Random& r) {
  const auto often_an_end = [&] { return std::clamp(r.uniform(-0.3, 1.3), 0.0, 1.0); };
  if (leaf.shape == Leaf::Shape::hull) {
    Vec sum;
    double weights = 0;
    for (const Vec& p : leaf.points) {
      const double w = std::pow(r.uniform(0, 1), 6);
      sum = sum + p * w, weights += w;
    }
    return sum * (1 / weights);
  }
  const bool is_around_line = leaf.shape == Leaf::Shape::cone || leaf.shape == Leaf::Shape::wall;
  const Vec axis = is_around_line ? leaf.b - leaf.a : leaf.normal, e = length(axis) > 0 ? axis * (1 / length(axis)) : Vec{0, 1, 0};
  const Vec side = leaf.towards - e * dot(leaf.towards, e), t = side * (1 / length(side)), u = cross(e, t);
  if (leaf.shape == Leaf::Shape::box)
    return leaf.a + t * (leaf.size.x * (often_an_end() - 0.5)) + e * (leaf.size.y * (often_an_end() - 0.5)) +
           u * (leaf.size.z * (often_an_end() - 0.5));
  const double half = leaf.shape == Leaf::Shape::arc ? leaf.angle * std::acos(-1.0) / 360 : std::acos(-1.0),
               turn = half * (2 * often_an_end() - 1);
  const Vec out = t * std::cos(turn) + u * std::sin(turn);
  if (leaf.shape == Leaf::Shape::arc) return leaf.a + out * leaf.r;
  const double s = often_an_end(), radius = leaf.r * (1 - s) + leaf.s * s, height = s * length(axis);
  if (leaf.shape == Leaf::Shape::cone) return leaf.a + e * height + out * (radius * often_an_end());
  const double slant = std::hypot(length(axis), leaf.s - leaf.r),
               off = (often_an_end() - 0.5) * (leaf.r_thickness * (1 - s) + leaf.s_thickness * s);
  if (radius + off * length(axis) / slant < 0) return leaf.a + e * height + out * radius; // the wall ends at the axis
  return leaf.a + e * (height - off * (leaf.s - leaf.r) / slant) + out * (radius + off * length(axis) / slant);
}

/// The distance is that to the nearest of many points of the solid.
TEST(Reference, DistancesAreThoseToTheNearestPoint) {
  int compared = 0;
  for (int trial = 0; trial < 90; ++trial) {
    Random r(trial);
    const Leaf leaf = random_solid(r);
    if (leaf.shape == Leaf::Shape::torus && leaf.r == 0) continue; // a ball, of which a torus has no random point
    ++compared;
    const Vec p = r.point(2), n = leaf.normal * (1 / length(leaf.normal));
    double nearest = k_infinity;
    for (int i = 0; i < 40000; ++i) {
      Vec q = r.point(1), c = leaf.a;
      double within = leaf.r;
      if (leaf.shape > Leaf::Shape::torus) {
        c = random_point_of(leaf, r), within = 0;
      } else if (leaf.shape == Leaf::Shape::segment || leaf.shape == Leaf::Shape::cone_sphere) {
        const double s = r.uniform(0, 1);
        c = leaf.a * (1 - s) + leaf.b * s;
        within = leaf.shape == Leaf::Shape::segment ? 0 : leaf.r * (1 - s) + leaf.s * s;
      } else {
        Vec across = q - n * dot(q, n);
        across = across * (leaf.r / length(across));
        c = leaf.a + across * (leaf.shape == Leaf::Shape::disc ? std::sqrt(r.uniform(0, 1)) : 1.0);
        within = leaf.shape == Leaf::Shape::disc ? 0 : leaf.s;
      }
      nearest = std::min(nearest, std::max(0.0, length(p - c) - within));
    }
    EXPECT_LE(distance(leaf, p), nearest + 1e-9);
    EXPECT_NEAR(distance(leaf, p), nearest, 0.03) << "trial " << trial << ", shape " << int(leaf.shape);
  }
  EXPECT_GT(compared, 80);
}

TEST(Reference, InterpolatedSpansAgreeWithDenseMarching) {
  constexpr int k_steps = 20000;
  for (int trial = 0; trial < 100; ++trial) {
    Random r(2000 + trial);
    std::vector<NodePtr> children;
    for (int i = 0; i < 3; ++i) children.push_back(make({random_solid(r), random_solid(r)}));
    const NodePtr tree = make(static_cast<Node::Kind>(1 + trial % 4), children);
    const Ray ray = random_ray(r);
    const std::vector<Span> spans = above(along_ray(*tree, ray, 0, 14, 1), 1);
    size_t next = 0;
    for (int i = 0; i <= k_steps; ++i) {
      const double t = 14.0 * i / k_steps, f = value(*tree, ray.at(t), 1);
      while (next < spans.size() && spans[next].to < t) ++next;
      const bool inside = next < spans.size() && spans[next].from <= t;
      if (std::abs(f - 1) > 1e-5) {
        ASSERT_EQ(inside, f > 1) << "trial " << trial << ", t " << t;
      }
    }
  }
}

// A lone quartic blob of weight 2 is a sphere of radius R sqrt(1 - sqrt(1/2)) (threshold 1).
TEST(Reference, JudgesAnswersOnASphere) {
  const NodePtr blob = make({Leaf{.a = {}, .b = {}, .radius = 1, .weight = 2}});
  const double radius = std::sqrt(1 - std::sqrt(0.5));
  const Profile through = along_ray(*blob, {{-3, 0, 0}, {1, 0, 0}}, 0, 6, 1);
  EXPECT_EQ(judge(through, 1, 2, 3 - radius), Verdict::right);
  EXPECT_EQ(judge(through, 1, 2, 3 - radius + 1e-5), Verdict::right);
  EXPECT_EQ(judge(through, 1, 2, 3 - radius + 1e-3), Verdict::missed);
  EXPECT_EQ(judge(through, 1, 2, 3 + radius), Verdict::missed);
  EXPECT_EQ(judge(through, 1, 2, k_infinity), Verdict::missed);
  EXPECT_EQ(judge(through, 1, 2, 3 - radius - 1e-3), Verdict::false_hit);
  const Profile past = along_ray(*blob, {{-3, radius + 1e-3, 0}, {1, 0, 0}}, 0, 6, 1);
  EXPECT_EQ(judge(past, 1, 2, k_infinity), Verdict::right);
  EXPECT_EQ(judge(past, 1, 2, 3), Verdict::false_hit);
  // Within the tolerance of the field both answers are right.
  const Profile grazing = along_ray(*blob, {{-3, radius - 1e-8, 0}, {1, 0, 0}}, 0, 6, 1);
  EXPECT_EQ(judge(grazing, 1, 2, k_infinity), Verdict::right);
  EXPECT_EQ(judge(grazing, 1, 2, 3), Verdict::right);
}

// A drop of ten times the tolerated length, in a scene twenty thousand times its size.
TEST(Reference, SeesWhatIsThin) {
  const double radius = 1e-4;
  const NodePtr drop = make({Leaf{.a = {}, .b = {}, .radius = radius, .weight = 4}});
  const Profile profile = along_ray(*drop, {{-3, 0, 0}, {1, 0, 0}}, 0, 6, 1);
  EXPECT_EQ(judge(profile, 1, 2, k_infinity), Verdict::missed);
  const std::vector<Span> spans = above(profile, 1);
  ASSERT_EQ(spans.size(), 1u);
  EXPECT_NEAR(spans[0].to - spans[0].from, 2 * radius * std::sqrt(0.5), 1e-12);
}

} // namespace
} // namespace reference
