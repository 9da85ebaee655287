// Unions, intersections and differences: which formula each takes, and that all formulas have one surface.
#include <functional>

#include <gtest/gtest.h>

#include "renderer/program/evaluate.h"
#include "tests/support/random_scene.h"

namespace kelpie {
namespace {

constexpr double k_threshold = 0.7;

unsigned add_point(SampledField& field, const Vec3& centre, float weight = 2) {
  Point<SampledMode> point;
  point.centre = centre, point.radius = 1, point.weight = weight;
  return add(field, point);
}

/// Two overlapping points joined by a Boolean.
template <template <class> class Kind>
unsigned add_boolean(SampledField& field, BooleanFormula formula) {
  Kind<SampledMode> boolean;
  boolean.formula = formula;
  boolean.children = {add_point(field, Vec3(-0.3f, 0, 0)), add_point(field, Vec3(0.3f, 0.1f, 0))};
  return add(field, boolean);
}

/// What stands above: completes a field whose last node is `child`.
using Above = std::function<void(SampledField&, unsigned child)>;

template <template <class> class Kind>
void join_with_point(SampledField& field, unsigned child) {
  Kind<SampledMode> blend;
  blend.children = {child, add_point(field, Vec3(0, 0.9f, 0), 0.5f)};
  if constexpr (requires { blend.region; }) blend.region = add_point(field, Vec3(0, 0.4f, 0));
  add(field, blend);
}
template <template <class> class Kind>
unsigned warped(SampledField& field, unsigned child) {
  Kind<SampledMode> warp;
  if constexpr (requires { warp.rate; }) warp.rate = 30;
  warp.child = child;
  return add(field, warp);
}

template <template <class> class Kind>
FieldProgram program(BooleanFormula formula, const Above& above) {
  SampledField field;
  above(field, add_boolean<Kind>(field, formula));
  return compile(std::move(field), k_threshold);
}

/// The largest difference of two fields, and at how many places they lie on different sides of the threshold.
struct Apart {
  double most = 0;
  int sides = 0;
};
Apart apart(const FieldProgram& a, const FieldProgram& b) {
  Random r(1);
  Apart out;
  for (int i = 0; i < 3000; ++i) {
    const Vec3d p = r.in(Box3d{Vec3d(-1.4), Vec3d(1.4)});
    const Point3<double> at{p.x, p.y, p.z};
    const double f = evaluate(a, a.code, at), g = evaluate(b, b.code, at);
    out.most = std::max(out.most, std::abs(f - g));
    out.sides += (f > k_threshold) != (g > k_threshold);
  }
  return out;
}

template <class Test>
void for_each_boolean(Test&& test) {
  const auto one = [&]<template <class> class Kind>() {
    SCOPED_TRACE(Kind<SampledMode>::k_name);
    test.template operator()<Kind>();
  };
  one.template operator()<Union>(), one.template operator()<Intersection>(), one.template operator()<Difference>();
}

const std::vector<Above> k_no_blend_above{
    [](SampledField&, unsigned) {},
    [](SampledField& field, unsigned child) { warped<Twist>(field, child); },
    [](SampledField& field, unsigned child) { join_with_point<Union>(field, warped<Scale>(field, child)); },
    [](SampledField& field, unsigned child) { // of one child it is no blend
      Blend<SampledMode> lone;
      lone.children = {child};
      add(field, lone);
    },
};
const std::vector<Above> k_blend_above{
    join_with_point<Blend>,
    join_with_point<HyperBlend>,
    join_with_point<LocalBlend>,
    [](SampledField& field, unsigned child) { join_with_point<Blend>(field, warped<Twist>(field, child)); },
    [](SampledField& field, unsigned child) { join_with_point<Blend>(field, warped<Translate>(field, child)); },
    [](SampledField& field, unsigned child) {
      join_with_point<Blend>(field, child);
      join_with_point<Union>(field, unsigned(field.nodes.size() - 1));
    },
};

TEST(Booleans, AreSharpWhereNoBlendStandsAbove) {
  for_each_boolean([]<template <class> class Kind>() {
    for (const Above& above : k_no_blend_above) {
      EXPECT_EQ(apart(program<Kind>(BooleanFormula::automatic, above), program<Kind>(BooleanFormula::sharp, above)).most, 0);
    }
  });
}

/// Of any number of operands the bounds hold, and are of use: a union of many parts, none of which reaches another, is not lost.
TEST(Booleans, OfManyOperandsHaveBounds) {
  for (const size_t count : {2u, 10u, 11u, 16u, 1000u}) {
    SampledField field;
    Union<SampledMode> parts;
    parts.formula = BooleanFormula::smooth;
    for (size_t i = 0; i < count; ++i) parts.children.push_back(add_point(field, Vec3(2.5f * float(i), 0, 0)));
    add(field, parts);
    const FieldProgram program = compile(std::move(field), k_threshold);
    const float end = 2.5f * float(count);
    const auto box = [](Interval x) { return Point3<Interval>{x, {-1, 1}, {-1, 1}}; };
    for (const Interval x : {Interval{-1, end}, Interval{-1, 1}, Interval{end - 3, end - 2}, Interval{0.4, 2.1}}) {
      const Interval bound = evaluate(program, program.code, box(x));
      EXPECT_GE(bound.lo, -1e-9) << count;
      EXPECT_LE(bound.hi, 1e100) << count;
      for (int i = 0; i <= 20; ++i) {
        const double value = evaluate(program, program.code, Point3<double>{x.lo + (x.hi - x.lo) * i / 20, 0.1, 0});
        EXPECT_TRUE(bound.lo - 1e-9 <= value && value <= bound.hi + 1e-9) << count << " " << value;
      }
    }
    EXPECT_NEAR(evaluate(program, program.code, Point3<double>{end - 2.5, 0, 0}), 2, 1e-6);
  }
}

TEST(Booleans, AreSmoothBelowABlend) {
  for_each_boolean([]<template <class> class Kind>() {
    for (const Above& above : k_blend_above) {
      EXPECT_EQ(apart(program<Kind>(BooleanFormula::automatic, above), program<Kind>(BooleanFormula::smooth, above)).most, 0);
      EXPECT_GT(apart(program<Kind>(BooleanFormula::automatic, above), program<Kind>(BooleanFormula::sharp, above)).most, 0.02);
    }
  });
}

TEST(Booleans, HaveOneSurfaceWhateverTheirFormula) {
  for_each_boolean([]<template <class> class Kind>() {
    for (const Above& above : k_no_blend_above) {
      const Apart both = apart(program<Kind>(BooleanFormula::smooth, above), program<Kind>(BooleanFormula::sharp, above));
      EXPECT_EQ(both.sides, 0);
      EXPECT_GT(both.most, 0.02);
    }
  });
}

// --- fields below 0: carving weights ---

// A weight below 0 takes away where it reaches, and nothing else.
TEST(NegativeWeights, Carve) {
  SampledField field;
  Blend<SampledMode> blend;
  blend.children = {add_point(field, Vec3(0)), add_point(field, Vec3(0.4f, 0, 0), -3)};
  add(field, blend);
  const FieldProgram carved = compile(std::move(field), k_threshold);
  const auto at = [&](double x) { return evaluate(carved, carved.code, Point3<double>{x, 0, 0}); };
  EXPECT_LT(at(0.4), 0);
  EXPECT_LT(at(0.1), k_threshold); // inside the point alone
  EXPECT_GT(at(-0.3), k_threshold);
  EXPECT_NEAR(at(-0.7), 2 * std::pow(1 - 0.7 * 0.7, 3), 1e-7); // out of reach
}

// Below a blend a Boolean yields nothing below 0, so that no operand of it carves its neighbours; and an operand below 0 is
// as much outside as one that is 0.
TEST(NegativeWeights, HarmNoBoolean) {
  for_each_boolean([]<template <class> class Kind>() {
    Random r(2);
    const Kind<SampledMode> kind;
    for (int i = 0; i < 1000; ++i) {
      std::vector<double> f{r.uniform(-3, 3), r.uniform(-3, 3), r.uniform(-3, 3)}, clamped;
      for (const double x : f) clamped.push_back(std::max(0.0, x));
      const double value = kind.combine(std::span<const double>(f), k_threshold, Demand::value);
      EXPECT_GE(value, 0);
      for (const Demand demand : {Demand::value, Demand::sign})
        EXPECT_EQ(kind.combine(std::span<const double>(f), k_threshold, demand) > k_threshold,
                  kind.combine(std::span<const double>(clamped), k_threshold, demand) > k_threshold);
    }
  });
}

TEST(NegativeWeights, HarmNoHyperBlendAndNoRegion) {
  const HyperBlend<SampledMode> hyper_blend;
  const std::vector<double> f{1.5, -2}, alone{1.5};
  EXPECT_EQ(hyper_blend.combine(std::span<const double>(f), k_threshold, Demand::value),
            hyper_blend.combine(std::span<const double>(alone), k_threshold, Demand::value));
  const LocalBlend<SampledMode> local_blend;
  const std::vector<double> carved_region{1.5, 1, -2};
  EXPECT_EQ(local_blend.combine(std::span<const double>(carved_region), k_threshold, Demand::value), 1.5);
}

} // namespace
} // namespace kelpie
