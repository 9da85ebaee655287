#pragma once

#include <limits>

#include "base/box.h"
#include "field/skeletons/frame.h"
#include "field/warps/warp_way.h"

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

  /// Half the largest second derivative of child_from_parent in a box, in any direction; infinite across a kink.
  double most_bending(const Point3<Interval>& p) const {
    const AxisFrame frame{Vec3d(centre), Vec3d(axis)};
    const Point3<Interval> q = frame.local(p);
    if (length > 0 && (q.z.hi < 0 || q.z.lo > double(length))) return 0;
    if (length > 0 && (q.z.lo < 0 || q.z.hi > double(length))) return std::numeric_limits<double>::infinity();
    const double by_height = std::abs(glm::radians(double(rate)));
    return 0.5 * (square(by_height) * norm(q.x, q.y).hi + by_height);
  }

  /// How far apart two states, and any two states interpolated between them, take a point of a box, the same either way:
  /// the parts of centre, axis, rate and length one after the other.
  Vec3d displacement_from(const Twist& other, const Box3d& box, WarpWay) const {
    const AxisFrame a{Vec3d(centre), Vec3d(axis)}, b{Vec3d(other.centre), Vec3d(other.axis)};
    double reach = 0; // from any centre on the way to any point
    for (const Vec3d& from : {a.origin, b.origin})
      reach = std::max(reach, glm::length(glm::max(glm::abs(box.lower - from), glm::abs(box.upper - from))));
    const double most_rate = glm::radians(double(std::max(std::abs(rate), std::abs(other.rate))));
    // A limit that is 0 at one end appears, or ends, on the way: there is nothing to interpolate.
    const bool limit_jumps = (length > 0) != (other.length > 0);
    const double most_height = length > 0 && other.length > 0 ? std::min(reach, double(std::max(length, other.length))) : reach;
    const double shift = glm::distance(a.origin, b.origin), turn = turn_between(a.e, b.e);
    // The angle changes with the height along the axis, with the rate and with the limit.
    double angle = most_rate * (shift + reach * turn) + most_height * std::abs(glm::radians(double(rate) - double(other.rate)));
    angle += most_rate * (limit_jumps ? reach : std::abs(double(length) - double(other.length)));
    // Turning about another axis, or another centre, by the same angle.
    const double most_angle = std::min(2.0, most_rate * most_height);
    return Vec3d(std::min(2 * reach + shift, reach * (angle + 2 * most_angle * turn) + most_angle * shift));
  }

private:
  /// The length of the difference of the unit vectors; 2, the most there is, where an interpolated axis may vanish.
  static double turn_between(const Vec3d& e, const Vec3d& f) { return glm::dot(e, f) > 0 ? glm::distance(e, f) : 2; }

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
