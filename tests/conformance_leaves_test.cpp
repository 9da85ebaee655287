// Every leaf keeps the contracts of field/kinds.h: skeletons, signed distances, clouds, and the pieces of complex primitives.
#include "tests/support/conformance.h"

namespace kelpie {
namespace {

/// Of what has no end, the part that has anything to it.
const Box3d k_looked_at{Vec3d(-9), Vec3d(9)};

/// Calls test(field, support, random) for a skeleton.
template <Skeleton K, class Test>
void test_skeleton(const K& kind, Test&& test, Random& r) {
  const Box3d support{Vec3d(kind.support().lower), Vec3d(kind.support().upper)};
  test([&](const auto& p) { return potential(kind, p); }, intersect(support, k_looked_at), r);
}

/// The same for a sum of blobs.
template <class Test>
void test_blobs(const BlobCloud& cloud, Test&& test, Random& r) {
  ASSERT_FALSE(cloud.empty());
  const auto sum = [&]<class Real>(const Point3<Real>& p) {
    Real f(0.0);
    for (const Blob& b : cloud) {
      const Real x = p.x - Real(b.centre.x), y = p.y - Real(b.centre.y), z = p.z - Real(b.centre.z);
      const Mat3d m = to_unit_ball(b).matrix();
      Real u2 = (square(x) + square(y) + square(z)) * (1 / square(double(b.radius)));
      if (!is_round(b)) {
        u2 = Real(0.0);
        for (int i = 0; i < 3; ++i) u2 = u2 + square(x * m[0][i] + y * m[1][i] + z * m[2][i]);
      }
      f = f + double(b.weight) * falloff(b.falloff, u2);
    }
    return f;
  };
  Box3 box;
  for (const Blob& b : cloud) box.extend(support(b));
  test(sum, Box3d{Vec3d(box.lower), Vec3d(box.upper)}, r);
}

/// The same for one of the pieces of a complex primitive.
template <ComplexPrimitive K, class Test>
void test_piece(const K& kind, Test&& test, Random& r) {
  const Divisions divisions = kind.divisions();
  int count = 0;
  kind.for_each_piece(divisions, [&](const auto&) { ++count; });
  ASSERT_GT(count, 0);
  int left = r.below(count);
  kind.for_each_piece(divisions, [&](const auto& piece) {
    if (left-- == 0) test_skeleton(piece, test, r);
  });
}

/// Calls test(field, support, random) for random leaves of a kind.
template <template <class> class Kind, class Test>
void for_leaves_of(Test&& test) {
  using K = Kind<SampledMode>;
  constexpr unsigned trials = Skeleton<K> ? k_trials : k_trials / 5; // a morph takes milliseconds to make, so do many pieces
  for (unsigned trial = 0; trial < trials && !testing::Test::HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    if constexpr (Skeleton<K>) {
      test_skeleton(random_kind<Kind>(r), test, r);
    } else if constexpr (ComplexPrimitive<K>) {
      test_piece(random_kind<Kind>(r), test, r);
    } else {
      BlobCloud cloud;
      random_kind<Kind>(r).append_blobs(cloud);
      test_blobs(cloud, test, r);
    }
  }
}

/// Calls test_kind(for_its_leaves) for every kind that has leaves; for_its_leaves(test) calls test(field, support, random) for random ones.
template <class TestKind>
void for_each_leaf_kind(TestKind&& test_kind) {
  for_each_field_kind([&]<template <class> class Kind>() {
    using K = Kind<SampledMode>;
    if (testing::Test::HasFailure()) return;
    if constexpr (Skeleton<K> || ComplexPrimitive<K> || BlobSource<K>) test_kind([](auto&& test) { for_leaves_of<Kind>(test); });
  });
}

/// Calls test(field, support, random) for random leaves of every kind that has any.
template <class Test>
void for_each_leaf(Test&& test) {
  for_each_leaf_kind([&](auto&& for_its_leaves) { for_its_leaves(test); });
}

TEST(Conformance, RangeOverABoxContainsItsSamples) {
  int boxes = 0, telling = 0;
  for_each_leaf([&](const auto& field, const Box3d& support, Random& r) {
    const Box3d box = random_box(r, support);
    const Interval range = field(box_point(box));
    const GradientRange slopes = field(variables(box));
    EXPECT_TRUE(std::isfinite(range.lo) && std::isfinite(range.hi));
    ++boxes, telling += range.width() > 0;
    for (int i = 0; i < 30; ++i) {
      const Vec3d p = r.in(box);
      EXPECT_TRUE(holds(range, field(point<double>(p))));
      const ValueAndSlopes g = field(variables(p));
      for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(holds(slopes.d[axis], g.d[axis], 1e-8));
    }
  });
  EXPECT_GT(boxes, 20 * k_trials);
  EXPECT_GT(telling, boxes / 3) << "of the others a field is the same everywhere";
}

// A range that does not shrink with its box proves nothing: subdivision would never end.
TEST(Conformance, RangeShrinksWithTheBox) {
  int boxes = 0, telling = 0;
  for_each_leaf([&](const auto& field, const Box3d& support, Random& r) {
    const Vec3d centre = r.in(support);
    const double width = field(box_point({centre - 1e-7, centre + 1e-7})).width();
    EXPECT_LT(width, 1e-3);
    ++boxes, telling += width > 0;
  });
  EXPECT_GT(telling, boxes / 3);
}

TEST(Conformance, GradientAgreesWithDifferences) {
  for_each_leaf_kind([](auto&& for_its_leaves) {
    GradientCheck check;
    for_its_leaves([&](const auto& field, const Box3d& support, Random& r) {
      for (int i = 0; i < 5; ++i) {
        const Vec3d p = r.in(support);
        check.compare([&](const Vec3d& q) { return field(point<double>(q)); }, field(variables(p)), p);
      }
    });
    check.expect_enough();
  });
}

TEST(Conformance, ZeroOutsideTheSupport) {
  int leaves = 0, outside = 0;
  for_each_leaf([&](const auto& field, const Box3d& support, Random& r) {
    ++leaves;
    for (int i = 0; i < 50; ++i) {
      const Vec3d p = r.in(support.padded(0.1 * support.diagonal()));
      if (support.contains(p) || !k_looked_at.contains(p)) continue;
      ++outside;
      EXPECT_EQ(field(point<double>(p)), 0);
    }
  });
  EXPECT_GT(outside, 10 * leaves);
}

// The steepest slope of a falloff bounds that of every potential; some come near.
TEST(Conformance, SolidsAreNoSteeperThanTheirFalloffs) {
  for_each_field_kind([]<template <class> class Kind>() {
    if constexpr (SolidSkeleton<Kind<SampledMode>>) {
      double closest = 0;
      for (unsigned trial = 0; trial < k_trials; ++trial) {
        Random r(trial);
        const auto kind = random_kind<Kind>(r);
        const Box3d support{Vec3d(kind.support().lower), Vec3d(kind.support().upper)};
        const double most = std::abs(double(kind.weight)) * steepest(kind.falloff).most / double(kind.radius);
        for (int i = 0; i < 20; ++i) {
          const ValueAndSlopes f = potential(kind, variables(r.in(support)));
          const double slope = glm::length(Vec3d(f.d[0], f.d[1], f.d[2]));
          EXPECT_LE(slope, most * (1 + 1e-9)) << trial;
          closest = std::max(closest, slope / most);
        }
      }
      EXPECT_GT(closest, 0.95);
    }
  });
}

// --- complex primitives ---

/// From the potential (weight 1, quartic) of a union of pieces to the distance from the solid; the radius where it is 0.
double distance_of(double potential, double radius) { return radius * std::sqrt(std::max(0.0, 1 - std::sqrt(potential))); }

template <ComplexPrimitive K>
double distance_to_pieces(const K& kind, const Vec3d& p) {
  Vec3d local = p;
  if constexpr (requires { kind.parent_from_pieces(); }) local = inverse(kind.parent_from_pieces())(p);
  double most = 0;
  kind.for_each_piece(kind.divisions(), [&](const auto& piece) { most = std::max(most, potential(piece, point<double>(local))); });
  return distance_of(most, double(kind.radius));
}

// As many pieces as its detail asks for are within that detail of many more.
TEST(Conformance, ComplexPrimitivesAreWithinTheirDetail) {
  int kinds = 0;
  for_each_field_kind([&]<template <class> class Kind>() {
    if constexpr (ComplexPrimitive<Kind<SampledMode>>) {
      ++kinds;
      double farthest = 0;
      for (unsigned trial = 0; trial < k_trials / 10; ++trial) {
        SCOPED_TRACE(trial);
        Random r(trial);
        auto coarse = random_kind<Kind>(r);
        coarse.radius = 6, coarse.weight = 1, coarse.falloff = Falloff::quartic, coarse.detail = float(r.log_uniform(0.03, 0.3));
        auto fine = coarse;
        fine.detail *= 0.02f;
        for (int i = 0; i < 10; ++i) {
          const Vec3d p = r.in(Box3d{Vec3d(-2), Vec3d(2)});
          const double apart = std::abs(distance_to_pieces(coarse, p) - distance_to_pieces(fine, p));
          farthest = std::max(farthest, apart / double(coarse.detail));
        }
      }
      RecordProperty(std::string(Kind<SampledMode>::k_name), std::to_string(farthest));
      EXPECT_LT(farthest, 1.04);
    }
  });
  EXPECT_EQ(kinds, 4);
}

// --- motion: two states of a kind, and all that are interpolated between them ---

/// The distance to a skeleton's solid.
template <Skeleton K>
double solid_distance(const K& kind, const Vec3d& p) {
  if constexpr (SignedDistance<K>)
    return kind.signed_distance(point<double>(p));
  else
    return std::sqrt(squared_distance(kind.solid(), point<double>(p)));
}

// From any place a solid seems to move no farther than it says.
TEST(Conformance, SkeletonsMoveNoFartherThanTheySay) {
  int standing = 0;
  for_each_field_kind([&]<template <class> class Kind>() {
    if constexpr (MovingSkeleton<Kind<SampledMode>>) {
      double closest = 0;
      bool moves = false;
      for (unsigned trial = 0; trial < 2 * k_trials; ++trial) {
        Random r(trial);
        const auto a = random_kind<Kind>(r), b = random_other<Kind>(a, r);
        const Box3d box = random_box(r, {Vec3d(-2), Vec3d(2)});
        const double most = displacement(a, b, box);
        moves |= most > 0;
        for (int i = 0; i < 20; ++i) {
          const Vec3d p = r.in(box);
          const auto at = [&](double u) { return solid_distance(interpolated(a, b, u), p); };
          const double moved = std::abs(at(r.uniform(0, 1)) - at(r.below(2) ? 1 : r.uniform(0, 1)));
          EXPECT_LE(moved, most + 1e-5) << trial; // states are float
          if (most > 1e-3) closest = std::max(closest, moved / most);
        }
      }
      EXPECT_TRUE(!moves || closest > 0.5) << "a bound that is far off helps little: " << closest;
      standing += !moves;
    }
  });
  EXPECT_EQ(standing, 1) << "only a mesh has no place that could move";
}

TEST(Conformance, MovingSkeletonsKeepTheirBounds) {
  for_each_field_kind([&]<template <class> class Kind>() {
    if constexpr (MovingSkeleton<Kind<SampledMode>>) {
      int trivial = 0, telling = 0;
      for (unsigned trial = 0; trial < 5 * k_trials && !HasFailure(); ++trial) {
        SCOPED_TRACE(trial);
        Random r(trial);
        const auto a = random_kind<Kind>(r), b = random_other<Kind>(a, r);
        const Box3 support = a.support();
        const Box3d box = random_box(r, intersect({Vec3d(support.lower), Vec3d(support.upper)}, k_looked_at));
        const Interval range = moving_potential_range(a, b, box);
        for (int i = 0; i < 40; ++i)
          EXPECT_TRUE(holds(range, potential(interpolated(a, b, r.uniform(0, 1)), point<double>(r.in(box))), 1e-6)); // states are float
        trivial += range.width() >= std::abs(a.weight) && box.diagonal() < 0.1 * reach_of(a) && displacement(a, b, box) < 0.1 * reach_of(a);
        telling += range.width() > 0;
      }
      EXPECT_LT(trivial, k_trials / 50) << "bounds that say nothing prune nothing";
      EXPECT_GT(telling, k_trials);
    }
  });
}

} // namespace
} // namespace kelpie
