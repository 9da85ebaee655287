// Reflectance models as scene files describe them. Their sampling is in renderer/integrate/.
#pragma once

#include "base/kind.h"
#include "colour/colour.h"

namespace kelpie {

template <class Mode>
struct Matte {
  static constexpr std::string_view k_name = "matte";
  static constexpr std::string_view k_doc = "A perfectly diffuse (Lambertian) surface.";

  Value<Mode, Colour> colour{Colour{Vec3(0.5f)}};

  static constexpr auto parameters() { return std::tuple{parameter("colour", &Matte::colour, "albedo").at_least(0).at_most(1)}; }
};

template <class Mode>
struct Metal {
  static constexpr std::string_view k_name = "metal";
  static constexpr std::string_view k_doc =
      R"(A metal: GGX microfacets (Walter et al. 2007; visible normals after Heitz 2018) under Schlick's Fresnel term.

The default is polished chrome; `"colour": [1.0, 0.77, 0.34]` is gold.)";

  Value<Mode, Colour> colour{Colour{Vec3(0.9f)}};
  Value<Mode, float> roughness{0.1f};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("colour", &Metal::colour, "reflectance at normal incidence").at_least(0).at_most(1),
        parameter("roughness", &Metal::roughness, "0 is a mirror, 1 is dull; the microfacets' alpha is its square").at_least(0).at_most(1),
    };
  }
};

using SurfaceKinds = KindList<Matte, Metal>;

} // namespace kelpie
