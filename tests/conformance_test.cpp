// One suite over every kind of field: whatever stands in FieldKinds is held to the contracts of
// field/kinds.h, without a line here for the kind.
#include <set>

#include <gtest/gtest.h>

#include "field/range.h"
#include "scene/parameter_types.h"
#include "tests/support/random_kind.h"

namespace kelpie {
namespace {

using Gradient = Dual<double, 3>;
using GradientRange = Dual<Interval, 3>;

constexpr int k_trials = 200;

template <class Real>
Point3<Real> point(const Vec3d& p) {
  return {Real(p.x), Real(p.y), Real(p.z)};
}
Point3<Interval> box_point(const Box3d& b) { return {{b.lower.x, b.upper.x}, {b.lower.y, b.upper.y}, {b.lower.z, b.upper.z}}; }

/// x, y and z as independent variables.
Point3<Gradient> variables(const Vec3d& p) { return {Gradient::variable(p.x, 0), Gradient::variable(p.y, 1), Gradient::variable(p.z, 2)}; }
Point3<GradientRange> variables(const Box3d& b) {
  const Point3<Interval> p = box_point(b);
  return {GradientRange::variable(p.x, 0), GradientRange::variable(p.y, 1), GradientRange::variable(p.z, 2)};
}

bool holds(Interval i, double v, double tolerance = 1e-10) { return i.lo - tolerance <= v && v <= i.hi + tolerance; }

/// A box of any size around somewhere near the shape.
Box3d random_box(Random& r, const Box3d& near) {
  const Vec3d centre = r.in(near.padded(0.2)), half(r.log_uniform(1e-4, 1), r.log_uniform(1e-4, 1), r.log_uniform(1e-4, 1));
  return {centre - half, centre + half};
}

/// Compares a gradient with differences of f, unless p is at a kink: where one-sided differences disagree.
template <class Field>
void expect_gradient(const Field& f, const Gradient& g, const Vec3d& p, int& kinks) {
  constexpr double k_step = 1e-6;
  for (int i = 0; i < 3; ++i) {
    Vec3d h(0);
    h[i] = k_step;
    const double ahead = (f(p + h) - f(p)) / k_step, behind = (f(p) - f(p - h)) / k_step;
    if (std::abs(ahead - behind) > 1e-3 * (1 + std::abs(ahead))) {
      ++kinks;
      continue;
    }
    EXPECT_NEAR(g.d[i], 0.5 * (ahead + behind), 1e-3 * (1 + std::abs(ahead)));
  }
}

/// Calls test.template operator()<Kind>(name) for every kind of field.
template <class Test>
void for_each_field_kind(Test&& test) {
  FieldKinds::for_each([&]<template <class> class Kind>() {
    SCOPED_TRACE(Kind<SampledMode>::k_name);
    test.template operator()<Kind>();
  });
}

// --- tables ---

template <class T>
void expect_default_in_range(const T& value, const ParameterRules& rules) {
  const auto number = [&](double v) { EXPECT_TRUE(rules.range.contains(v)) << rules.name << " = " << v; };
  if constexpr (IsAnimated<T>)
    expect_default_in_range(value.at(0), rules);
  else if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, unsigned>)
    number(value);
  else if constexpr (requires {
                       value.length();
                       value[0];
                     } &&
                     !std::is_same_v<T, std::string>)
    for (size_t i = 0; i < static_cast<size_t>(value.length()); ++i) number(value[i]);
  else if constexpr (std::is_same_v<T, Colour>)
    for (int i = 0; i < 3; ++i) number(value.rgb[i]);
}

template <class Described>
void expect_sound_table() {
  EXPECT_FALSE(Described::k_name.empty());
  EXPECT_FALSE(Described::k_doc.empty());
  const Described defaults{};
  std::set<std::string_view> names;
  const auto row = [&](const auto& parameter) {
    EXPECT_TRUE(names.insert(parameter.name).second) << "twice: " << parameter.name;
    EXPECT_FALSE(parameter.name.empty());
    EXPECT_FALSE(parameter.doc.empty()) << parameter.name;
    EXPECT_LE(parameter.range.lower, parameter.range.upper) << parameter.name;
    expect_default_in_range(defaults.*(parameter.member), parameter);
  };
  std::apply([&](const auto&... parameters) { (row(parameters), ...); }, Described::parameters());
  const auto alternative = [&](const ParameterRules& rules) {
    EXPECT_TRUE(rules.alternative.empty() || names.count(rules.alternative)) << rules.name;
  };
  std::apply([&](const auto&... parameters) { (alternative(parameters), ...); }, Described::parameters());
}

TEST(Conformance, TablesAreSound) {
  for_each_group([]<class Group>(const Group& group) {
    std::set<std::string_view> names;
    group.for_each([&]<class T>() {
      SCOPED_TRACE(T::k_name);
      EXPECT_TRUE(names.insert(T::k_name).second);
      expect_sound_table<T>();
    });
  });
}

TEST(Conformance, EveryKindOfFieldIsOneTheEngineKnows) {
  for_each_field_kind([]<template <class> class Kind>() {
    using K = Kind<SampledMode>;
    EXPECT_EQ(int(BlobSource<K>) + int(Skeleton<K>) + int(Operator<K>) + int(AffineWarp<K>) + int(Warp<K>) + int(ComplexPrimitive<K>), 1);
  });
}

// --- leaves ---

/// Of what has no end, the part that has anything to it.
const Box3d k_looked_at{Vec3d(-9), Vec3d(9)};

/// Calls test(field, support, random) for every leaf: skeletons, and the sums of blob sources.
template <class Test>
void for_each_leaf(Test&& test) {
  for_each_field_kind([&]<template <class> class Kind>() {
    using K = Kind<SampledMode>;
    constexpr unsigned trials = Skeleton<K> ? k_trials : k_trials / 5; // a morph takes milliseconds to make
    for (unsigned trial = 0; trial < trials && !testing::Test::HasFailure(); ++trial) {
      SCOPED_TRACE(trial);
      Random r(trial);
      if constexpr (Skeleton<K>) {
        const K kind = random_kind<Kind>(r);
        const Box3d support{Vec3d(kind.support().lower), Vec3d(kind.support().upper)};
        test([&](const auto& p) { return potential(kind, p); }, intersect(support, k_looked_at), r);
      } else if constexpr (BlobSource<K>) {
        BlobCloud cloud;
        random_kind<Kind>(r).append_blobs(cloud);
        ASSERT_FALSE(cloud.empty());
        const auto sum = [&]<class Real>(const Point3<Real>& p) {
          Real f(0.0);
          for (const Blob& b : cloud) {
            const Real d2 = square(p.x - Real(b.centre.x)) + square(p.y - Real(b.centre.y)) + square(p.z - Real(b.centre.z));
            f = f + double(b.weight) * falloff(b.falloff, d2 * (1 / square(double(b.radius))));
          }
          return f;
        };
        Box3 box;
        for (const Blob& b : cloud) box.extend(support(b));
        test(sum, Box3d{Vec3d(box.lower), Vec3d(box.upper)}, r);
      }
    }
  });
}

TEST(Conformance, RangeOverABoxContainsItsSamples) {
  for_each_leaf([](const auto& field, const Box3d& support, Random& r) {
    const Box3d box = random_box(r, support);
    const Interval range = field(box_point(box));
    const GradientRange slopes = field(variables(box));
    EXPECT_TRUE(std::isfinite(range.lo) && std::isfinite(range.hi));
    for (int i = 0; i < 30; ++i) {
      const Vec3d p = r.in(box);
      EXPECT_TRUE(holds(range, field(point<double>(p))));
      const Gradient g = field(variables(p));
      for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(holds(slopes.d[axis], g.d[axis], 1e-8));
    }
  });
}

// A range that does not shrink with its box proves nothing: subdivision would never end.
TEST(Conformance, RangeShrinksWithTheBox) {
  for_each_leaf([](const auto& field, const Box3d& support, Random& r) {
    const Vec3d centre = r.in(support);
    EXPECT_LT(field(box_point({centre - 1e-7, centre + 1e-7})).width(), 1e-3);
  });
}

TEST(Conformance, GradientAgreesWithDifferences) {
  int kinks = 0, points = 0;
  for_each_leaf([&](const auto& field, const Box3d& support, Random& r) {
    for (int i = 0; i < 5; ++i, ++points) {
      const Vec3d p = r.in(support);
      expect_gradient([&](const Vec3d& q) { return field(point<double>(q)); }, field(variables(p)), p, kinks);
    }
  });
  EXPECT_LT(kinks, points / 10) << "too few points were compared";
}

TEST(Conformance, ZeroOutsideTheSupport) {
  for_each_leaf([](const auto& field, const Box3d& support, Random& r) {
    for (int i = 0; i < 50; ++i) {
      const Vec3d p = r.in(support.padded(0.1 * support.diagonal()));
      if (!support.contains(p) && k_looked_at.contains(p)) {
        EXPECT_EQ(field(point<double>(p)), 0);
      }
    }
  });
}

// --- falloffs ---

TEST(Conformance, FalloffsKeepTheirBoundsOfSlopeAndCurvature) {
  for (const auto& [name, kind] : EnumNames<Falloff>::values) {
    SCOPED_TRACE(name);
    const Falloff f = kind;
    const auto at = [&](double r2) { return falloff(f, r2); };
    EXPECT_EQ(at(0), 1);
    EXPECT_EQ(at(1), 0);
    EXPECT_EQ(at(1.5), 0);
    constexpr double k_step = 1e-4;
    double slope = 0, least = 0, most = 0;
    // Lines at every distance from the centre: a line's f is falloff(distance^2 + t^2).
    for (double distance = 0; distance < 1; distance += 1.0 / 128)
      for (double t = 0; t < 1; t += 1.0 / 1024) {
        const double d2 = square(distance), here = at(d2 + square(t)), ahead = at(d2 + square(t + k_step)),
                     behind = at(d2 + square(t - k_step));
        slope = std::max(slope, std::abs(ahead - behind) / (2 * k_step));
        const double curve = (ahead - 2 * here + behind) / square(k_step);
        least = std::min(least, curve), most = std::max(most, curve);
      }
    const FalloffCurvature bounds = curvature(f);
    // Bounds hold, and are not slack by more than half a per cent. (1e-3: the differences' own error.)
    EXPECT_LE(slope, steepest(f).most);
    EXPECT_GE(slope, 0.995 * steepest(f).most);
    EXPECT_GE(least, -bounds.c_plus * (1 + 1e-3));
    EXPECT_LE(least, -bounds.c_plus * 0.995);
    EXPECT_LE(most, bounds.c_minus * (1 + 1e-3));
    EXPECT_GE(most, bounds.c_minus * 0.995);
    const FalloffPolynomial p = polynomial(f);
    for (double u = 0; u < 1; u += 1.0 / 64) EXPECT_NEAR(at(u), square(1 - u) * (p.a + p.b * (1 - u)), 1e-14);
  }
}

// --- operators ---

struct Operands {
  double threshold;
  std::vector<Interval> ranges;

  /// At least so many.
  Operands(Random& r, size_t least) : threshold(r.uniform(0.2, 2)), ranges(least + size_t(r.below(5))) {
    for (Interval& i : ranges) {
      const double a = r.uniform(-1, 3), width = r.below(4) ? r.log_uniform(1e-3, 2) : 0;
      i = r.below(5) ? Interval{a, a + width} : Interval{0, 0}; // often one does not reach the cell
    }
  }
  std::vector<double> sample(Random& r) const {
    std::vector<double> f;
    for (const Interval& i : ranges) f.push_back(r.uniform(i.lo, std::nextafter(i.hi, INFINITY)));
    return f;
  }
};

template <class Test>
void for_each_operator(Test&& test) {
  for_each_field_kind([&]<template <class> class Kind>() {
    if constexpr (Operator<Kind<SampledMode>>)
      for (unsigned trial = 0; trial < 10 * k_trials && !testing::Test::HasFailure(); ++trial) {
        SCOPED_TRACE(trial);
        Random r(trial);
        const Kind<SampledMode> kind = random_kind<Kind>(r);
        test(kind, Operands(r, 1 + operands_of(kind).size()), trial % 2 ? Demand::value : Demand::sign, r);
      }
  });
}

TEST(Conformance, OperatorsBoundTheirValues) {
  for_each_operator([](const auto& kind, const Operands& operands, Demand mine, Random& r) {
    const Interval range = kind.combine(std::span<const Interval>(operands.ranges), operands.threshold, mine);
    for (int i = 0; i < 20; ++i) {
      const std::vector<double> f = operands.sample(r);
      EXPECT_TRUE(holds(range, kind.combine(std::span<const double>(f), operands.threshold, mine)));
    }
  });
}

TEST(Conformance, OperatorsDifferentiate) {
  int kinks = 0;
  for_each_operator([&](const auto& kind, const Operands& operands, Demand mine, Random& r) {
    const std::vector<double> f = operands.sample(r);
    const auto along = [&](const Vec3d& p) { // operands that move linearly with three variables
      std::vector<double> moved = f;
      for (size_t i = 0; i < f.size(); ++i) moved[i] += p[i % 3] * double(1 + i);
      return kind.combine(std::span<const double>(moved), operands.threshold, mine);
    };
    std::vector<Gradient> duals;
    for (size_t i = 0; i < f.size(); ++i) duals.push_back(Gradient(f[i]) + Gradient::variable(0, int(i % 3)) * double(1 + i));
    expect_gradient(along, kind.combine(std::span<const Gradient>(duals), operands.threshold, mine), Vec3d(0), kinks);
  });
}

// What is pruned cannot matter: the value is the same, or where only the side is asked for, the side.
TEST(Conformance, OperatorsKeepWhatMatters) {
  for_each_operator([]<class K>(const K& kind, const Operands& operands, Demand mine, Random& r) {
    for (const Demand demand : {Demand::value, Demand::sign}) { // of the cell
      if (mine < demand) continue;                              // it asks for no more than the whole tree does
      std::vector<char> kept(operands.ranges.size(), true);
      kind.keep(operands.ranges, operands.threshold, demand, kept);
      for (int i = 0; i < 20; ++i) {
        const std::vector<double> f = operands.sample(r);
        std::vector<double> rest;
        for (size_t k = 0; k < f.size(); ++k)
          if (kept[k] || is_positional<K>()) rest.push_back(kept[k] ? f[k] : 0);
        const double whole = kind.combine(std::span<const double>(f), operands.threshold, mine);
        const auto lone = std::find(kept.begin(), kept.end(), char(true));
        const bool is_lone = lone_of<K>() == Lone::itself && std::count(lone, kept.end(), char(true)) == 1;
        const double pruned = rest.empty() ? 0
                              : is_lone    ? f[size_t(lone - kept.begin())]
                                           : kind.combine(std::span<const double>(rest), operands.threshold, mine);
        if (demand == Demand::value && !rest.empty()) {
          EXPECT_NEAR(whole, pruned, 1e-12);
        } else if (demand == Demand::value) {
          EXPECT_LE(whole, 1e-12); // nothing reaches the cell
        } else {
          EXPECT_EQ(whole > operands.threshold, pruned > operands.threshold);
        }
      }
    }
  });
}

// --- warps ---

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
    if constexpr (Warp<Kind<SampledMode>>)
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
          const Point3<Gradient> g = kind.child_from_parent(variables(p));
          for (int axis = 0; axis < 3; ++axis)
            EXPECT_TRUE(holds(slopes.x.d[axis], g.x.d[axis], 1e-9) && holds(slopes.y.d[axis], g.y.d[axis], 1e-9) &&
                        holds(slopes.z.d[axis], g.z.d[axis], 1e-9));
          int kinks = 0;
          expect_gradient([&](const Vec3d& at) { return kind.child_from_parent(point<double>(at)).x; }, g.x, p, kinks);
        }
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
          const Point3<Gradient> at_p = kind.child_from_parent(variables(p));
          const Point3<double> at_q = kind.child_from_parent(point<double>(q));
          const auto apart = [&](const Gradient& f, double g) {
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

// --- motion: two states of a kind, and all that are interpolated between them ---

/// Another state of a kind: any, or close by.
template <template <class> class Kind>
Kind<SampledMode> random_other(const Kind<SampledMode>& kind, Random& r) {
  Kind<SampledMode> other = kind;
  interpolate(kind, random_kind<Kind>(r), r.below(3) ? r.log_uniform(1e-3, 1) : 1, other);
  return other;
}

TEST(Conformance, MovingSkeletonsKeepTheirBounds) {
  for_each_field_kind([&]<template <class> class Kind>() {
    if constexpr (MovingSkeleton<Kind<SampledMode>>) {
      int trivial = 0;
      for (unsigned trial = 0; trial < 5 * k_trials && !HasFailure(); ++trial) {
        SCOPED_TRACE(trial);
        Random r(trial);
        const auto a = random_kind<Kind>(r), b = random_other<Kind>(a, r);
        const Box3 support = a.support();
        const Box3d box = random_box(r, {Vec3d(support.lower), Vec3d(support.upper)});
        const Interval range = moving_potential_range(a, b, box);
        for (int i = 0; i < 40; ++i)
          EXPECT_TRUE(holds(range, potential(interpolated(a, b, r.uniform(0, 1)), point<double>(r.in(box))), 1e-6)); // states are float
        trivial += range.width() >= std::abs(a.weight) && box.diagonal() < 0.1 * reach_of(a) && displacement(a, b, box) < 0.1 * reach_of(a);
      }
      EXPECT_LT(trivial, k_trials / 50) << "bounds that say nothing prune nothing";
    }
  });
}

TEST(Conformance, MovingOperatorsKeepTheirBounds) {
  for_each_operator([&]<template <class> class Kind>(const Kind<SampledMode>& kind, const Operands& operands, Demand mine, Random& r) {
    const auto other = random_other<Kind>(kind, r);
    const Interval threshold{operands.threshold, operands.threshold * (r.below(2) ? r.uniform(1, 2) : 1)};
    const Interval range = moving_combine(kind, other, operands.ranges, threshold, mine);
    for (int i = 0; i < 20; ++i) {
      const std::vector<double> f = operands.sample(r);
      const auto between = interpolated(kind, other, r.uniform(0, 1));
      EXPECT_TRUE(holds(range, between.combine(std::span<const double>(f), r.uniform(threshold.lo, threshold.hi + 1e-12), mine), 1e-5));
    }
  });
}

TEST(Conformance, MovingWarpsKeepTheirBounds) {
  for_each_field_kind([&]<template <class> class Kind>() {
    if constexpr (MovingWarp<Kind<SampledMode>>)
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
          EXPECT_TRUE(holds_all(apart(at_u.child_from_parent(p), at_v.child_from_parent(p)), to_child));
          EXPECT_TRUE(holds_all(apart(at_u.parent_from_child(p), at_v.parent_from_child(p)), to_parent));
        }
      }
  });
}

} // namespace
} // namespace kelpie
