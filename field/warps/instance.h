// A part of the scene, somewhere else and at another time.
#pragma once

#include "base/time_map.h"
#include "field/warps/affine.h"

namespace kelpie {

template <class Mode>
struct Instance {
  static constexpr std::string_view k_name = "instance";
  static constexpr std::string_view k_doc = R"(One of the scene's `parts`, in a place and at a time of its own.

A part is described once, and may be used by any number of instances, in shapes and in other parts. A point p of it
is at position + rotation(scale * p), and what it does at frame f it does here at frame `time_offset` + f / `time_scale`.
What stands in the part's own instances is moved, shifted and slowed along with it. The potential itself is not scaled.

    "parts": { "drop": { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 2 } }
    …
    { "kind": "instance", "of": "drop", "position": [2, 0, 0], "time_offset": 12 })";

  Value<Mode, Vec3> position{Vec3(0)};
  Value<Mode, Vec3> axis{Vec3(0, 1, 0)};
  Value<Mode, float> angle{0.f};
  Value<Mode, Vec3> scale{Vec3(1)};
  double time_offset = 0, time_scale = 1;
  typename Mode::Reference child{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("of", &Instance::child, "which part").required().such_as("part"),
        parameter("position", &Instance::position, "where the part's origin goes").in(Unit::length),
        parameter("axis", &Instance::axis, "direction of the axis that it is turned about; need not be a unit vector").nonzero(),
        parameter("angle", &Instance::angle, "how far it is turned, right-handed").in(Unit::degrees),
        parameter("scale", &Instance::scale, "a factor for each axis of the part, or one for all; a negative one mirrors")
            .other_than_zero()
            .or_number_for_all(),
        parameter("time_offset", &Instance::time_offset, "how much later the part moves").in(Unit::frames),
        parameter("time_scale", &Instance::time_scale, "how many times as fast the part moves; 0.5: at half its speed")
            .at_least(0.001)
            .at_most(1000),
    };
  }
  TimeMap time_below() const { return {time_offset, time_scale}; }
  Affine parent_from_child() const { return placement(position, axis, angle, scale); }
};

} // namespace kelpie
