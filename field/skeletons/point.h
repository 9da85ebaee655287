#pragma once

#include "field/potential/blob.h"

namespace kelpie {

template <class Mode>
struct Point {
  static constexpr std::string_view k_name = "point";
  static constexpr std::string_view k_doc = R"(A blob: the potential around one point.

    f(p) = weight * falloff(|p - centre|^2 / radius^2)

The surface of a lone point at threshold T is a sphere; with the quartic falloff its radius is
`radius * sqrt(1 - sqrt(T / weight))`. A negative weight carves. Source: Barbier, Galin, Akkouche,
"Complex skeletal implicit surfaces…", leaves of the BlobTree; methods.md section 2.)";

  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{1.f};
  Falloff falloff = Falloff::quartic;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("centre", &Point::centre, "the skeleton").in(Unit::length).required(),
        parameter("radius", &Point::radius, "radius of influence: the potential is 0 beyond it").in(Unit::length).above(0).required(),
        parameter("weight", &Point::weight, "the potential at the centre; negative carves"),
        parameter("falloff", &Point::falloff, "how the potential decreases"),
    };
  }

  // Sampled: a cloud of one. Point clouds are what the fast solver knows, so points join it.
  void append_blobs(BlobCloud& out) const { out.push_back({centre, radius, weight, falloff}); }
};

} // namespace kelpie
