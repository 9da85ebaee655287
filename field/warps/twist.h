#pragma once

#include "base/box.h"
#include "field/skeletons/frame.h"

namespace kelpie {

template <class Mode>
struct Twist {
  static constexpr std::string_view k_name = "twist";
  static constexpr std::string_view k_doc = R"(Twists its child about an axis: the farther along the axis, the farther it is turned.

    f(p) = f_child(W^-1 p),   W^-1 turns p about the axis by -rate * h, h the height of p above `centre` along the axis

Right-handed. With a `length` the twist acts between `centre` and that far along the axis; before, nothing is turned,
beyond, all is turned by the full angle. `length` 0 is no limit, either way. Lengths across the axis grow the farther
from it: at distance r by up to (k r + sqrt(k^2 r^2 + 4)) / 2, k the rate in radians. Source: methods.md section 2, warps.)";

  Value<Mode, Vec3> axis{Vec3(0, 1, 0)};
  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, float> rate{0.f};
  Value<Mode, float> length{0.f};
  typename Mode::Child child{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("axis", &Twist::axis, "direction of the axis; need not be a unit vector").nonzero(),
        parameter("centre", &Twist::centre, "the point on the axis where nothing is turned").in(Unit::length),
        parameter("rate", &Twist::rate, "degrees per scene unit along the axis").required(),
        parameter("length", &Twist::length, "how far along the axis it acts; 0: everywhere").in(Unit::length).at_least(0),
        parameter("child", &Twist::child, "the field to twist").required(),
    };
  }

  // Sampled:

  template <class Real>
  Point3<Real> child_from_parent(const Point3<Real>& p) const {
    return turned(p, -1);
  }
  template <class Real>
  Point3<Real> parent_from_child(const Point3<Real>& p) const {
    return turned(p, 1);
  }

  /// A box around the image of a box: heights and distances from the axis stay.
  Box3d image_of(const Box3d& box) const {
    const AxisFrame frame{Vec3d(centre), Vec3d(axis)};
    const Point3<Interval> q =
        frame.local(Point3<Interval>{{box.lower.x, box.upper.x}, {box.lower.y, box.upper.y}, {box.lower.z, box.upper.z}});
    const double distance = norm(q.x, q.y).hi;
    Box3d image;
    for (int i = 0; i < 3; ++i) {
      const Interval along = q.z * frame.e[i];
      const double across = distance * std::sqrt(std::max(0.0, 1 - square(frame.e[i])));
      image.lower[i] = frame.origin[i] + along.lo - across, image.upper[i] = frame.origin[i] + along.hi + across;
    }
    return image;
  }

private:
  template <class Real>
  Point3<Real> turned(const Point3<Real>& p, double sign) const {
    const AxisFrame frame{Vec3d(centre), Vec3d(axis)};
    const Point3<Real> q = frame.local(p);
    const Real height = length > 0 ? clamp(q.z, 0, length) : q.z, angle = height * (sign * glm::radians(double(rate)));
    const Real c = cos(angle), s = sin(angle);
    return frame.global(Point3<Real>{q.x * c - q.y * s, q.x * s + q.y * c, q.z});
  }
};

} // namespace kelpie
