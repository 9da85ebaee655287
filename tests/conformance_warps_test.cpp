// Every warp keeps the contracts of field/kinds.h, standing and in motion.
#include "tests/support/conformance.h"

namespace kelpie {
namespace {

TEST(Conformance, AffineWarpsInvert) {
  for_each_field_kind([&]<template <class> class Kind>() {
    if constexpr (AffineWarp<Kind<SampledMode>>)
      for (unsigned trial = 0; trial < k_trials; ++trial) {
        SCOPED_TRACE(trial);
        Random r(trial);
        const Affine forward = random_kind<Kind>(r).parent_from_child(), back = inverse(forward);
        const Box3d box = random_box(r, {Vec3d(-2), Vec3d(2)});
        const Point3<Interval> range = forward.apply(box_point(box));
        for (int i = 0; i < 20; ++i) {
          const Vec3d p = r.in(box), q = forward(p);
          EXPECT_LT(glm::distance(back(q), p), 1e-10);
          EXPECT_LT(glm::distance((back * forward)(p), p), 1e-10);
          EXPECT_TRUE(holds(range.x, q.x) && holds(range.y, q.y) && holds(range.z, q.z));
        }
      }
  });
}

TEST(Conformance, WarpsInvertAndBoundTheirImages) {
  for_each_field_kind([&]<template <class> class Kind>() {
    if constexpr (Warp<Kind<SampledMode>>) {
      GradientCheck check;
      for (unsigned trial = 0; trial < 2 * k_trials; ++trial) {
        SCOPED_TRACE(trial);
        Random r(trial);
        auto kind = random_kind<Kind>(r);
        if constexpr (requires { kind.rate; }) kind.rate *= 100; // degrees
        const Box3d box = random_box(r, {Vec3d(-2), Vec3d(2)}), image = kind.image_of(box).padded(1e-9);
        const Point3<Interval> range = kind.child_from_parent(box_point(box));
        const Point3<GradientRange> slopes = kind.child_from_parent(variables(box));
        for (int i = 0; i < 20; ++i) {
          const Vec3d p = r.in(box);
          const Point3<double> q = kind.child_from_parent(point<double>(p)), back = kind.parent_from_child(q),
                               moved = kind.parent_from_child(point<double>(p));
          EXPECT_LT(glm::distance(Vec3d(back.x, back.y, back.z), p), 1e-9);
          EXPECT_TRUE(image.contains(Vec3d(moved.x, moved.y, moved.z)));
          EXPECT_TRUE(holds(range.x, q.x) && holds(range.y, q.y) && holds(range.z, q.z));
          const Point3<ValueAndSlopes> g = kind.child_from_parent(variables(p));
          for (int axis = 0; axis < 3; ++axis)
            EXPECT_TRUE(holds(slopes.x.d[axis], g.x.d[axis], 1e-9) && holds(slopes.y.d[axis], g.y.d[axis], 1e-9) &&
                        holds(slopes.z.d[axis], g.z.d[axis], 1e-9));
          check.compare([&](const Vec3d& at) { return kind.child_from_parent(point<double>(at)).x; }, g.x, p);
        }
      }
      check.expect_enough();
    }
  });
}

// Second derivatives are bounded: so far a warp parts from its tangent.
TEST(Conformance, WarpsPartFromTheirTangentsAsTheySay) {
  for_each_field_kind([&]<template <class> class Kind>() {
    if constexpr (requires(const Kind<SampledMode> kind, Point3<Interval> p) { kind.most_bending(p); }) {
      SCOPED_TRACE(Kind<SampledMode>::k_name);
      int bounded = 0;
      double closest = 0;
      for (unsigned trial = 0; trial < 5 * k_trials && !HasFailure(); ++trial) {
        SCOPED_TRACE(trial);
        Random r(trial);
        auto kind = random_kind<Kind>(r);
        if constexpr (requires { kind.rate; }) kind.rate *= 100; // degrees
        const Box3d box = random_box(r, {Vec3d(-2), Vec3d(2)});
        const double most = kind.most_bending(box_point(box));
        if (!(most < 1e6)) continue;
        ++bounded;
        for (int i = 0; i < 20; ++i) {
          const Vec3d p = r.in(box), q = r.in(box);
          const Point3<ValueAndSlopes> at_p = kind.child_from_parent(variables(p));
          const Point3<double> at_q = kind.child_from_parent(point<double>(q));
          const auto apart = [&](const ValueAndSlopes& f, double g) {
            return g - f.value - (f.d[0] * (q.x - p.x) + f.d[1] * (q.y - p.y) + f.d[2] * (q.z - p.z));
          };
          const double squared = glm::dot(q - p, q - p);
          const double parts = glm::length(Vec3d(apart(at_p.x, at_q.x), apart(at_p.y, at_q.y), apart(at_p.z, at_q.z)));
          EXPECT_LE(parts, most * squared * (1 + 1e-9) + 1e-9);
          if (most > 0 && squared > 1e-6) closest = std::max(closest, parts / (most * squared));
        }
      }
      EXPECT_GT(bounded, k_trials / 2);
      EXPECT_GT(closest, 0.5) << "a bound that is far off helps little";
    }
  });
}

// Where a box meets a tear: its images are in boxes that say more than one box around all of them.
TEST(Conformance, TornImagesHoldAllThatIsSomewhere) {
  for_each_field_kind([&]<template <class> class Kind>() {
    if constexpr (TearingWarp<Kind<SampledMode>>) {
      SCOPED_TRACE(Kind<SampledMode>::k_name);
      const auto volume = [](const Box3d& b) { return b.extent().x * b.extent().y * b.extent().z; };
      int torn = 0, narrow = 0;
      for (unsigned trial = 0; trial < 20 * k_trials; ++trial) {
        Random r(trial);
        const auto kind = random_kind<Kind>(r);
        const Box3d box = random_box(r, {Vec3d(-2), Vec3d(2)});
        std::vector<Box3d> images;
        if (!kind.torn_images(box, images)) continue;
        ++torn;
        const Point3<Interval> range = kind.child_from_parent(box_point(box));
        double all = 0;
        for (const Box3d& image : images) all += volume(image);
        narrow += all < 0.5 * volume({{range.x.lo, range.y.lo, range.z.lo}, {range.x.hi, range.y.hi, range.z.hi}});
        for (int i = 0; i < 20; ++i) {
          const Point3<double> q = kind.child_from_parent(point<double>(r.in(box)));
          const bool is_somewhere = q.x < 1e4;
          EXPECT_TRUE(!is_somewhere || std::any_of(images.begin(), images.end(),
                                                   [&](const Box3d& b) { return b.padded(1e-9).contains(Vec3d(q.x, q.y, q.z)); }));
        }
      }
      EXPECT_GT(torn, k_trials / 10);
      EXPECT_GT(narrow, torn / 2);
    }
  });
}

TEST(Conformance, MovingWarpsKeepTheirBounds) {
  for_each_field_kind([&]<template <class> class Kind>() {
    if constexpr (MovingWarp<Kind<SampledMode>>) {
      double closest = 0;
      for (unsigned trial = 0; trial < 5 * k_trials && !HasFailure(); ++trial) {
        SCOPED_TRACE(trial);
        Random r(trial);
        auto a = random_kind<Kind>(r);
        if constexpr (requires { a.rate; }) a.rate *= float(r.log_uniform(1, 100)); // degrees
        const auto b = random_other<Kind>(a, r);
        const Box3d box = random_box(r, {Vec3d(-2), Vec3d(2)});
        const Vec3d to_child = a.displacement_from(b, box, WarpWay::to_child) + 1e-5; // states are float
        const Vec3d to_parent = a.displacement_from(b, box, WarpWay::to_parent) + 1e-5;
        for (int i = 0; i < 40; ++i) {
          const auto at_u = interpolated(a, b, r.uniform(0, 1)), at_v = r.below(2) ? a : interpolated(a, b, r.uniform(0, 1));
          const Point3<double> p = point<double>(r.in(box));
          const auto apart = [](const Point3<double>& x, const Point3<double>& y) {
            return glm::abs(Vec3d(x.x - y.x, x.y - y.y, x.z - y.z));
          };
          const auto holds_all = [](const Vec3d& moved, const Vec3d& most) { return glm::all(glm::lessThanEqual(moved, most)); };
          const Vec3d moved = apart(at_u.child_from_parent(p), at_v.child_from_parent(p));
          EXPECT_TRUE(holds_all(moved, to_child));
          if (glm::length(to_child) > 1e-3) closest = std::max(closest, glm::length(moved) / glm::length(to_child));
          EXPECT_TRUE(holds_all(apart(at_u.parent_from_child(p), at_v.parent_from_child(p)), to_parent));
        }
      }
      EXPECT_GT(closest, 0.1) << "a bound that is far off helps little";
    }
  });
}

} // namespace
} // namespace kelpie
