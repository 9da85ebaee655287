// The affine warps: translate, rotate, scale. f(p) = f_child(W^-1 p).
#pragma once

#include <glm/gtc/matrix_transform.hpp>

#include "base/affine.h"
#include "base/kind.h"

namespace kelpie {

template <class Mode>
struct Translate {
  static constexpr std::string_view k_name = "translate";
  static constexpr std::string_view k_doc = "Moves its child by `by`.";

  Value<Mode, Vec3> by{Vec3(0)};
  typename Mode::Child child{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("by", &Translate::by, "the displacement").in(Unit::length).required(),
        parameter("child", &Translate::child, "the field to move").required(),
    };
  }
  Affine parent_from_child() const { return {Mat3d(1.0), Vec3d(by)}; }
};

template <class Mode>
struct Rotate {
  static constexpr std::string_view k_name = "rotate";
  static constexpr std::string_view k_doc = "Turns its child by `angle` about an axis through `centre`, right-handed.";

  Value<Mode, Vec3> axis{Vec3(0, 1, 0)};
  Value<Mode, float> angle{0.f};
  Value<Mode, Vec3> centre{Vec3(0)};
  typename Mode::Child child{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("axis", &Rotate::axis, "direction of the axis; need not be a unit vector").nonzero(),
        parameter("angle", &Rotate::angle, "angle of rotation").in(Unit::degrees).required(),
        parameter("centre", &Rotate::centre, "a point on the axis").in(Unit::length),
        parameter("child", &Rotate::child, "the field to turn").required(),
    };
  }
  Affine parent_from_child() const {
    const Vec3d a(axis);
    const double length = glm::length(a);
    if (!(length > 0)) return {}; // an animated axis that passes through zero: no rotation
    const Mat3d m(glm::rotate(glm::dmat4(1.0), glm::radians(double(angle)), a / length));
    return {m, Vec3d(centre) - m * Vec3d(centre)};
  }
};

template <class Mode>
struct Scale {
  static constexpr std::string_view k_name = "scale";
  static constexpr std::string_view k_doc =
      "Scales its child by a factor for each axis about `centre`. The potential itself is not scaled.";

  Value<Mode, Vec3> by{Vec3(1)};
  Value<Mode, Vec3> centre{Vec3(0)};
  typename Mode::Child child{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("by", &Scale::by, "a factor for each axis, or one for all; a negative one mirrors")
            .other_than_zero()
            .or_number_for_all()
            .required(),
        parameter("centre", &Scale::centre, "the point that stays").in(Unit::length),
        parameter("child", &Scale::child, "the field to scale").required(),
    };
  }
  Affine parent_from_child() const {
    Mat3d m(1.0);
    for (int i = 0; i < 3; ++i) m[i][i] = by[i];
    return {m, Vec3d(centre) - m * Vec3d(centre)};
  }
};

/// p -> position + rotation(scale * p): how what has an origin of its own is placed.
inline Affine placement(const Vec3& position, const Vec3& axis, float angle, const Vec3& scale) {
  return Translate<SampledMode>{position}.parent_from_child() * Rotate<SampledMode>{axis, angle}.parent_from_child() *
         Scale<SampledMode>{scale}.parent_from_child();
}

} // namespace kelpie
