// What the parts of the conformance suite share: whatever stands in FieldKinds is held to the contracts of field/kinds.h, without a
// line for the kind.
#pragma once

#include <gtest/gtest.h>

#include "field/range.h"
#include "tests/support/random_kind.h"

namespace kelpie {

using ValueAndSlopes = Dual<double, 3>;
using GradientRange = Dual<Interval, 3>;

inline constexpr int k_trials = 200;

template <class Real>
Point3<Real> point(const Vec3d& p) {
  return {Real(p.x), Real(p.y), Real(p.z)};
}
inline Point3<Interval> box_point(const Box3d& b) { return {{b.lower.x, b.upper.x}, {b.lower.y, b.upper.y}, {b.lower.z, b.upper.z}}; }

/// x, y and z as independent variables.
inline Point3<ValueAndSlopes> variables(const Vec3d& p) {
  return {ValueAndSlopes::variable(p.x, 0), ValueAndSlopes::variable(p.y, 1), ValueAndSlopes::variable(p.z, 2)};
}
inline Point3<GradientRange> variables(const Box3d& b) {
  const Point3<Interval> p = box_point(b);
  return {GradientRange::variable(p.x, 0), GradientRange::variable(p.y, 1), GradientRange::variable(p.z, 2)};
}

inline bool holds(Interval i, double v, double tolerance = 1e-10) { return i.lo - tolerance <= v && v <= i.hi + tolerance; }

/// A box of any size around somewhere near the shape.
inline Box3d random_box(Random& r, const Box3d& near) {
  const Vec3d centre = r.in(near.padded(0.2)), half(r.log_uniform(1e-4, 1), r.log_uniform(1e-4, 1), r.log_uniform(1e-4, 1));
  return {centre - half, centre + half};
}

/// Compares gradients of one kind with differences, unless a point is at a kink: where one-sided differences disagree.
class GradientCheck {
public:
  template <class Field>
  void compare(const Field& f, const ValueAndSlopes& g, const Vec3d& p) {
    constexpr double k_step = 1e-6;
    for (int i = 0; i < 3; ++i) {
      Vec3d h(0);
      h[i] = k_step;
      const double ahead = (f(p + h) - f(p)) / k_step, behind = (f(p) - f(p - h)) / k_step;
      if (std::abs(ahead - behind) > 1e-3 * (1 + std::abs(ahead))) {
        ++kinks_;
        continue;
      }
      ++compared_;
      sloping_ += ahead != 0;
      EXPECT_NEAR(g.d[i], 0.5 * (ahead + behind), 1e-3 * (1 + std::abs(ahead)));
    }
  }
  /// Kinks are rare: most are where operands are 0. Many places have a slope, though few of a plane, which has no end.
  void expect_enough() const {
    EXPECT_GT(compared_, 500);
    EXPECT_LT(kinks_, compared_ / 4);
    EXPECT_GT(sloping_, compared_ / 15);
  }

private:
  int compared_ = 0, kinks_ = 0, sloping_ = 0;
};

/// Calls test.template operator()<Kind>() for every kind of field.
template <class Test>
void for_each_field_kind(Test&& test) {
  FieldKinds::for_each([&]<template <class> class Kind>() {
    SCOPED_TRACE(Kind<SampledMode>::k_name);
    test.template operator()<Kind>();
  });
}

/// Another state of a kind: any, or close by.
template <template <class> class Kind>
Kind<SampledMode> random_other(const Kind<SampledMode>& kind, Random& r) {
  Kind<SampledMode> other = kind;
  interpolate(kind, random_kind<Kind>(r), r.below(3) ? r.log_uniform(1e-3, 1) : 1, other);
  return other;
}

} // namespace kelpie
