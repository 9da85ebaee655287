#pragma once

#include <limits>

#include "base/box.h"
#include "field/skeletons/frame.h"
#include "field/warps/warp_way.h"

namespace kelpie {

template <class Mode>
struct Taper {
  static constexpr std::string_view k_name = "taper";
  static constexpr std::string_view k_doc = R"(Tapers its child along an axis: the farther along it, the thinner or the thicker.

    f(p) = f_child(W^-1 p),   W multiplies what lies across the axis by s(h), h the height above `centre` along it

s goes straight from 1 at `centre` to `by` at `length`; before and beyond it stays as it is there. Heights stay.
Source: Barr 1984, "Global and local deformations of solid primitives"; methods.md section 2, warps.)";

  Value<Mode, Vec3> axis{Vec3(0, 1, 0)};
  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, float> by{0.5f};
  Value<Mode, float> length{1.f};
  typename Mode::Child child{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("axis", &Taper::axis, "direction of the axis; need not be a unit vector").nonzero(),
        parameter("centre", &Taper::centre, "the point on the axis where the taper begins").in(Unit::length),
        parameter("by", &Taper::by, "the factor at its end").above(0).required(),
        parameter("length", &Taper::length, "how far along the axis it acts").in(Unit::length).above(0).required(),
        parameter("child", &Taper::child, "the field to taper").required(),
    };
  }

  // Sampled:

  template <class Real>
  Point3<Real> child_from_parent(const Point3<Real>& p) const {
    const AxisFrame frame{Vec3d(centre), Vec3d(axis)};
    const Point3<Real> q = frame.local(p);
    const Real s = factor(q.z);
    return frame.global(Point3<Real>{q.x / s, q.y / s, q.z});
  }
  template <class Real>
  Point3<Real> parent_from_child(const Point3<Real>& p) const {
    const AxisFrame frame{Vec3d(centre), Vec3d(axis)};
    const Point3<Real> q = frame.local(p);
    const Real s = factor(q.z);
    return frame.global(Point3<Real>{q.x * s, q.y * s, q.z});
  }

  /// A box around the image of a box.
  Box3d image_of(const Box3d& box) const {
    const Point3<Interval> r =
        parent_from_child(Point3<Interval>{{box.lower.x, box.upper.x}, {box.lower.y, box.upper.y}, {box.lower.z, box.upper.z}});
    return {Vec3d(r.x.lo, r.y.lo, r.z.lo), Vec3d(r.x.hi, r.y.hi, r.z.hi)};
  }

  /// Half the largest second derivative of child_from_parent in a box, in any direction; infinite across a kink.
  double most_bending(const Point3<Interval>& p) const {
    const AxisFrame frame{Vec3d(centre), Vec3d(axis)};
    const Point3<Interval> q = frame.local(p);
    if (q.z.hi < 0 || q.z.lo > double(length)) return 0;
    if (q.z.lo < 0 || q.z.hi > double(length)) return std::numeric_limits<double>::infinity();
    const double slope = std::abs(double(by) - 1) / double(length), least = factor(q.z).lo;
    return 0.5 * (2 * norm(q.x, q.y).hi * square(slope) / (least * least * least) + slope / square(least));
  }

  /// How far apart two states, and any two states interpolated between them, take a point of a box.
  Vec3d displacement_from(const Taper& other, const Box3d& box, WarpWay way) const {
    const AxisFrame a{Vec3d(centre), Vec3d(axis)}, b{Vec3d(other.centre), Vec3d(other.axis)};
    double reach = 0; // from any centre on the way to any point
    for (const Vec3d& from : {a.origin, b.origin})
      reach = std::max(reach, glm::length(glm::max(glm::abs(box.lower - from), glm::abs(box.upper - from))));
    const double shift = glm::distance(a.origin, b.origin), turn = glm::dot(a.e, b.e) > 0 ? glm::distance(a.e, b.e) : 2;
    // With h / length clamped to [0, 1]: the farthest that it is from 0, and by how much it changes at a point.
    const double shortest = std::min(length, other.length), top = std::min(1.0, reach / shortest);
    const double rise = std::min(1.0, (shift + turn * reach) / shortest + top * std::abs(double(length) - double(other.length)) / shortest);
    const double farthest = std::max(std::abs(double(by) - 1), std::abs(double(other.by) - 1));
    double change = rise * farthest + top * std::abs(double(by) - double(other.by)), strength = top * farthest;
    if (way == WarpWay::to_child) { // of 1 / s
      const double least = std::min({1.0, double(by), double(other.by)});
      change /= square(least), strength /= least;
    }
    // What lies across the axis is no longer than `reach`, and turns with the axis.
    return Vec3d(change * reach + strength * (shift + std::min(1.0, turn) * reach));
  }

private:
  template <class Real>
  Real factor(const Real& height) const {
    return Real(1.0) + clamp(height, 0, length) * ((double(by) - 1) / double(length));
  }
};

} // namespace kelpie
