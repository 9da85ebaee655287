#pragma once

#include "materials/openpbr.h"

namespace kelpie {

template <class Mode>
struct Glass {
  static constexpr std::string_view k_name = "glass";
  static constexpr std::string_view k_doc = R"(A clear dielectric, polished or frosted (`openpbr` with `transmission_weight` 1).

With a `depth`, light is coloured on its way through: thin parts are pale, thick ones deep. `"ior": 1.33` is water.)";

  Value<Mode, Colour> colour{Colour{Vec3(1)}};
  Value<Mode, float> depth{0.f};
  Value<Mode, float> ior{1.5f};
  Value<Mode, float> roughness{0.f};
  Value<Mode, float> bump_height{0.f};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("colour", &Glass::colour, "what is left of white light after `depth`; where that is 0, each time it passes the surface")
            .at_least(0)
            .at_most(1),
        parameter("depth", &Glass::depth, "the way through it that colours light; 0: see there").in(Unit::length).at_least(0),
        parameter("ior", &Glass::ior, "index of refraction").at_least(1).at_most(4),
        parameter("roughness", &Glass::roughness, "0 is polished, 1 is dull; the microfacets' alpha is its square").at_least(0).at_most(1),
        parameter("bump_height", &Glass::bump_height, k_bump_height_doc).in(Unit::length),
    };
  }

  // Sampled:
  SurfaceParameters surface() const {
    SurfaceParameters s;
    s.transmission_weight = 1, s.transmission_color = colour, s.transmission_depth = depth;
    s.specular_ior = ior, s.specular_roughness = roughness;
    s.bump_height = bump_height;
    return s;
  }
};

} // namespace kelpie
