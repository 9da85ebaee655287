#pragma once

#include <array>

#include "base/kind.h"
#include "base/vec.h"
#include "colour/colour.h"

namespace kelpie {

/// Environments that need no file.
enum class EnvironmentPreset { studio, cyclorama, sky, white };

template <>
struct EnumNames<EnvironmentPreset> {
  static constexpr std::array<std::pair<std::string_view, EnvironmentPreset>, 4> values{{{"studio", EnvironmentPreset::studio},
                                                                                         {"cyclorama", EnvironmentPreset::cyclorama},
                                                                                         {"sky", EnvironmentPreset::sky},
                                                                                         {"white", EnvironmentPreset::white}}};
};

template <class Mode>
struct EnvironmentLight {
  static constexpr std::string_view k_name = "environment";
  static constexpr std::string_view k_doc = R"(Light from all around: a latitude-longitude map from a Radiance HDR or EXR file, or a preset.

Presets: `studio` (soft boxes in a dark room, made for metal), `cyclorama` (large soft boxes around a slate backdrop, which lies in the
direction -z: a floor of `matte` with the colour [0.15, 0.165, 0.19], lit by nothing else, runs into it without a seam), `sky` (a clear
sky over a horizon), `white` (the same from everywhere).
The middle of the map lies in the direction -z, its top is +y.)";

  AssetPath file;
  EnvironmentPreset preset = EnvironmentPreset::studio;
  Value<Mode, float> strength{1.f};
  Value<Mode, float> rotation{0.f};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("file", &EnvironmentLight::file, "the map (.hdr: linear Rec.709; .exr: as its header says, else linear Rec.709)")
            .alternative_to("preset"),
        parameter("preset", &EnvironmentLight::preset, "an environment that needs no file").alternative_to("file"),
        parameter("strength", &EnvironmentLight::strength, "factor of the map's radiance").at_least(0),
        parameter("rotation", &EnvironmentLight::rotation, "turns the map about +y").in(Unit::degrees),
    };
  }
};

template <class Mode>
struct SunLight {
  static constexpr std::string_view k_name = "sun";
  static constexpr std::string_view k_doc = "Parallel light from far away; `angle` makes it a disc with soft shadows.";

  Value<Mode, Vec3> direction{Vec3(1, 2, 1)};
  Value<Mode, Colour> colour{Colour{Vec3(1)}};
  Value<Mode, float> strength{3.f};
  Value<Mode, float> angle{0.53f};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("direction", &SunLight::direction, "points towards the sun").nonzero(),
        parameter("colour", &SunLight::colour, "colour of the light").at_least(0),
        parameter("strength", &SunLight::strength, "irradiance on a surface that faces the sun").at_least(0),
        parameter("angle", &SunLight::angle, "angular diameter; 0: sharp shadows").in(Unit::degrees).at_least(0).at_most(90),
    };
  }
};

// Of lights that have a place in the scene:
inline constexpr std::string_view k_strength_doc =
    "the irradiance on a surface that faces it straight on, one scene unit away, were it small; it falls with the square of the distance";
inline constexpr std::string_view k_visible_doc = "whether the camera sees it; mirrors and glass show it in any case";

template <class Mode>
struct RectangleLight {
  static constexpr std::string_view k_name = "rectangle";
  static constexpr std::string_view k_doc = R"(A rectangle that shines to one side, as a window or a soft box.

Its radiance is `strength` / (`width` * `height`): a larger one makes softer shadows, and what it lights is as bright as before.
It hides nothing.)";

  Value<Mode, Vec3> position{Vec3(0, 4, 0)};
  Value<Mode, Vec3> target{Vec3(0)};
  Value<Mode, Vec3> up{Vec3(0, 1, 0)};
  Value<Mode, float> width{1.f};
  Value<Mode, float> height{1.f};
  Value<Mode, Colour> colour{Colour{Vec3(1)}};
  Value<Mode, float> strength{30.f};
  bool visible = true;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("position", &RectangleLight::position, "of its middle").in(Unit::length),
        parameter("target", &RectangleLight::target, "a point that it faces; where that is `position`, it faces down").in(Unit::length),
        parameter("up", &RectangleLight::up, "its height runs along this, as nearly as it can").nonzero(),
        parameter("width", &RectangleLight::width, "its size across").in(Unit::length).above(0),
        parameter("height", &RectangleLight::height, "its size along `up`").in(Unit::length).above(0),
        parameter("colour", &RectangleLight::colour, "colour of the light").at_least(0),
        parameter("strength", &RectangleLight::strength, k_strength_doc).at_least(0),
        parameter("visible", &RectangleLight::visible, k_visible_doc),
    };
  }
};

template <class Mode>
struct DiscLight {
  static constexpr std::string_view k_name = "disc";
  static constexpr std::string_view k_doc = R"(A disc that shines to one side.

Its radiance is `strength` / (pi * `radius`^2): a larger one makes softer shadows, and what it lights is as bright as before.
It hides nothing.)";

  Value<Mode, Vec3> position{Vec3(0, 4, 0)};
  Value<Mode, Vec3> target{Vec3(0)};
  Value<Mode, float> radius{0.5f};
  Value<Mode, Colour> colour{Colour{Vec3(1)}};
  Value<Mode, float> strength{30.f};
  bool visible = true;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("position", &DiscLight::position, "of its middle").in(Unit::length),
        parameter("target", &DiscLight::target, "a point that it faces; where that is `position`, it faces down").in(Unit::length),
        parameter("radius", &DiscLight::radius, "its size").in(Unit::length).above(0),
        parameter("colour", &DiscLight::colour, "colour of the light").at_least(0),
        parameter("strength", &DiscLight::strength, k_strength_doc).at_least(0),
        parameter("visible", &DiscLight::visible, k_visible_doc),
    };
  }
};

template <class Mode>
struct SphereLight {
  static constexpr std::string_view k_name = "sphere";
  static constexpr std::string_view k_doc = R"(A ball that shines to all sides.

Its radiance is `strength` / (pi * `radius`^2): a larger one makes softer shadows, and what it lights is as bright as before.
It hides nothing, and lights nothing that lies in it.)";

  Value<Mode, Vec3> position{Vec3(0, 4, 0)};
  Value<Mode, float> radius{0.25f};
  Value<Mode, Colour> colour{Colour{Vec3(1)}};
  Value<Mode, float> strength{30.f};
  bool visible = true;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("position", &SphereLight::position, "of its middle").in(Unit::length),
        parameter("radius", &SphereLight::radius, "its size").in(Unit::length).above(0),
        parameter("colour", &SphereLight::colour, "colour of the light").at_least(0),
        parameter("strength", &SphereLight::strength, k_strength_doc).at_least(0),
        parameter("visible", &SphereLight::visible, k_visible_doc),
    };
  }
};

template <class Mode>
struct PointLight {
  static constexpr std::string_view k_name = "point";
  static constexpr std::string_view k_doc = "A point that shines to all sides: sharp shadows. Nothing shows it, not even a mirror.";

  Value<Mode, Vec3> position{Vec3(0, 4, 0)};
  Value<Mode, Colour> colour{Colour{Vec3(1)}};
  Value<Mode, float> strength{30.f};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("position", &PointLight::position, "where it is").in(Unit::length),
        parameter("colour", &PointLight::colour, "colour of the light").at_least(0),
        parameter("strength", &PointLight::strength, k_strength_doc).at_least(0),
    };
  }
};

using LightKinds = KindList<EnvironmentLight, SunLight, RectangleLight, DiscLight, SphereLight, PointLight>;

} // namespace kelpie
