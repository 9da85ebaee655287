#pragma once

#include "materials/openpbr.h"

namespace kelpie {

template <class Mode>
struct Matte {
  static constexpr std::string_view k_name = "matte";
  static constexpr std::string_view k_doc =
      "A diffuse surface without a highlight: Lambert's, or rough like plaster and clay (`openpbr` without its specular).";

  Value<Mode, Colour> colour{Colour{Vec3(0.5f)}};
  Value<Mode, float> roughness{0.f};
  Value<Mode, float> bump_height{0.f};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("colour", &Matte::colour, "albedo").at_least(0).at_most(1),
        parameter("roughness", &Matte::roughness, "0 is Lambert's, 1 is dusty and flat").at_least(0).at_most(1),
        parameter("bump_height", &Matte::bump_height, k_bump_height_doc).in(Unit::length),
    };
  }

  // Sampled:
  SurfaceParameters surface() const {
    SurfaceParameters s;
    s.base_color = colour, s.base_diffuse_roughness = roughness, s.specular_weight = 0;
    s.bump_height = bump_height;
    return s;
  }
};

} // namespace kelpie
