#pragma once

#include "base/kind.h"
#include "base/vec.h"

namespace kelpie {

template <class Mode>
struct Camera {
  static constexpr std::string_view k_name = "camera";
  static constexpr std::string_view k_doc = "A thin-lens camera. World space is right-handed, y up.";

  Value<Mode, Vec3> position{Vec3(0, 1, 6)};
  Value<Mode, Vec3> look_at{Vec3(0)};
  Value<Mode, Vec3> up{Vec3(0, 1, 0)};
  Value<Mode, float> fov{35.f};
  Value<Mode, float> shutter{0.f};
  Value<Mode, float> aperture{0.f};
  Value<Mode, float> focus{6.f};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("position", &Camera::position, "the centre of the lens").in(Unit::length),
        parameter("look_at", &Camera::look_at, "the point in the middle of the picture").in(Unit::length),
        parameter("up", &Camera::up, "the direction that is up in the picture").nonzero(),
        parameter("fov", &Camera::fov, "vertical field of view").in(Unit::degrees).above(0).below(180),
        parameter("shutter", &Camera::shutter, "how long the shutter is open, centred on the frame").in(Unit::frames).at_least(0),
        parameter("aperture", &Camera::aperture, "diameter of the lens; 0: everything is sharp").in(Unit::length).at_least(0),
        parameter("focus", &Camera::focus, "distance of the plane in focus").in(Unit::length).above(0),
    };
  }
};

} // namespace kelpie
