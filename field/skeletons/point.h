#pragma once

#include "field/potential/blob.h"

namespace kelpie {

template <class Mode>
struct Point {
  static constexpr std::string_view k_name = "point";
  static constexpr std::string_view k_doc = R"(A blob: the potential around one point.

    f(p) = weight * falloff(|p - centre|^2 / radius^2)

The surface of a lone point at threshold T is a sphere of `surface_radius`, where falloff(surface_radius^2 / radius^2) = T / weight: of
weight 2 at 0.454 radius (`kelpie kinds falloff`). A negative weight carves. Source: Barbier, Galin, Akkouche,
"Complex skeletal implicit surfaces…", leaves of the BlobTree; methods.md section 2.)";

  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("centre", &Point::centre, "the skeleton").in(Unit::length).required(),
        parameter("radius", &Point::radius, "radius of influence: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Point::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Point::weight, "the potential at the centre; negative carves"),
        parameter("falloff", &Point::falloff, "how the potential decreases"),
    };
  }

  // Sampled: a cloud of one. Point clouds are what the fast solver knows, so points join it.
  void append_blobs(BlobCloud& out) const { out.push_back({centre, radius, weight, falloff}); }
};

} // namespace kelpie
