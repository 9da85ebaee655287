// Frames that go along a curve without turning about it.
#pragma once

#include "base/spline.h"
#include "field/warps/axis_curve.h"

namespace kelpie {

/// The coordinate frame of an axis in one place, and its derivative by t: columns x, y, z; z along the axis.
struct CurveFrame {
  Vec3d at, velocity;
  Mat3d axes{1.0}, slopes{0.0};
};

/// Frames by normal plane projection in the limit of short steps: those that turn about their axis nowhere. By double reflection
/// (Wang, Jüttler, Zheng, Liu 2008, "Computation of rotation minimizing frames"), of fourth order.
class FrameWalk {
public:
  /// `tangent` and `normal` are those at the beginning of the curve, or near them.
  explicit FrameWalk(const Vec3d& tangent, const Vec3d& normal) : tangent_(tangent), normal_(normal) { straighten(); }

  CurveFrame go(const CubicStep<Vec3d>& c, double s) {
    const Vec3d at = c(s), first = c.first(s), second = c.second(s);
    const double speed = glm::length(first);
    const Vec3d tangent = speed > 0 ? first / speed : tangent_;
    if (has_begun_) {
      const Vec3d chord = at - at_;
      const double squared = glm::dot(chord, chord);
      if (squared > 0) {
        const auto reflect = [](const Vec3d& v, const Vec3d& by, double by2) { return v - (2 * glm::dot(by, v) / by2) * by; };
        const Vec3d normal = reflect(normal_, chord, squared), turned = tangent - reflect(tangent_, chord, squared);
        const double turned2 = glm::dot(turned, turned);
        normal_ = turned2 > 0 ? reflect(normal, turned, turned2) : normal;
      }
    }
    has_begun_ = true, at_ = at, tangent_ = tangent;
    straighten();
    CurveFrame frame{at, first};
    frame.axes = {glm::cross(normal_, tangent_), normal_, tangent_};
    const Vec3d turn = speed > 0 ? (second - tangent * glm::dot(second, tangent)) / speed : Vec3d(0);
    frame.slopes = {-glm::dot(frame.axes[0], turn) * tangent, -glm::dot(frame.axes[1], turn) * tangent, turn};
    return frame;
  }

private:
  void straighten() { normal_ = glm::normalize(normal_ - tangent_ * glm::dot(normal_, tangent_)); }

  Vec3d at_{0.0}, tangent_, normal_;
  bool has_begun_ = false;
};

/// What of `wanted` is across the tangent; where nothing is, any direction.
inline Vec3d first_normal(const Vec3d& wanted, const Vec3d& tangent) {
  for (const Vec3d& v : {wanted, Vec3d(0, 1, 0), Vec3d(0, 0, 1), Vec3d(1, 0, 0)}) {
    const Vec3d across = v - tangent * glm::dot(v, tangent);
    if (glm::dot(across, across) > 1e-6 * glm::dot(v, v)) return glm::normalize(across);
  }
  return {0, 1, 0};
}

/// Turned as the shortest turn takes one unit vector to another.
inline Vec3d carried(const Vec3d& v, const Vec3d& from, const Vec3d& to) {
  const Vec3d middle = from + to;
  const double squared = glm::dot(middle, middle);
  if (squared < 1e-12) return v;                         // right about: v is across both
  const Vec3d once = v - (2 * glm::dot(v, from)) * from; // two reflections make the turn
  return once - (2 * glm::dot(once, middle) / squared) * middle;
}

/// The first direction that a spline has.
inline Vec3d first_tangent(const Spline<Vec3d>& curve) {
  for (double t = 0; t < 1; t += 1.0 / 64) {
    const Vec3d v = curve.jet(t).first;
    const double length = glm::length(v);
    if (length > 0) return v / length;
  }
  return {0, 0, 1};
}

} // namespace kelpie
