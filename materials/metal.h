#pragma once

#include "materials/openpbr.h"

namespace kelpie {

template <class Mode>
struct Metal {
  static constexpr std::string_view k_name = "metal";
  static constexpr std::string_view k_doc = R"(A metal, polished or rough (`openpbr` with `base_metalness` 1).

The default is polished chrome; `"colour": [1.0, 0.77, 0.34]` is gold.)";

  Value<Mode, Colour> colour{Colour{Vec3(0.9f)}};
  Value<Mode, float> roughness{0.1f};
  Value<Mode, float> bump_height{0.f};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("colour", &Metal::colour, "reflectance at normal incidence").at_least(0).at_most(1),
        parameter("roughness", &Metal::roughness, "0 is a mirror, 1 is dull; the microfacets' alpha is its square").at_least(0).at_most(1),
        parameter("bump_height", &Metal::bump_height, k_bump_height_doc).in(Unit::length),
    };
  }

  // Sampled:
  SurfaceParameters surface() const {
    SurfaceParameters s;
    s.base_color = colour, s.base_metalness = 1, s.specular_roughness = roughness;
    s.bump_height = bump_height;
    return s;
  }
};

} // namespace kelpie
