// Ordinary geometry: set dressing that is not a field.
#pragma once

#include "base/kind.h"
#include "base/vec.h"

namespace kelpie {

template <class Mode>
struct Plane {
  static constexpr std::string_view k_name = "plane";
  static constexpr std::string_view k_doc = "An infinite plane, to stand things on.";

  Value<Mode, Vec3> position{Vec3(0)};
  Value<Mode, Vec3> normal{Vec3(0, 1, 0)};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("position", &Plane::position, "a point of the plane").in(Unit::length),
        parameter("normal", &Plane::normal, "its upper side; need not be a unit vector").nonzero(),
    };
  }
};

using GeometryKinds = KindList<Plane>;

} // namespace kelpie
