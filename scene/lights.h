#pragma once

#include <array>

#include "base/kind.h"
#include "base/vec.h"
#include "colour/colour.h"

namespace kelpie {

/// Environments that need no file.
enum class EnvironmentPreset { studio, sky, white };

template <>
struct EnumNames<EnvironmentPreset> {
  static constexpr std::array<std::pair<std::string_view, EnvironmentPreset>, 3> values{
      {{"studio", EnvironmentPreset::studio}, {"sky", EnvironmentPreset::sky}, {"white", EnvironmentPreset::white}}};
};

template <class Mode>
struct EnvironmentLight {
  static constexpr std::string_view k_name = "environment";
  static constexpr std::string_view k_doc = R"(Light from all around: a latitude-longitude map from a Radiance HDR or EXR file, or a preset.

Presets: `studio` (soft boxes in a dark room, made for metal), `sky` (a clear sky over a horizon), `white` (the same from everywhere).
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

using LightKinds = KindList<EnvironmentLight, SunLight>;

} // namespace kelpie
