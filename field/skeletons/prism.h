#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/section_solid.h"
#include "field/skeletons/triangle_plane.h"

namespace kelpie {

template <class Mode>
struct Prism {
  static constexpr std::string_view k_name = "prism";
  static constexpr std::string_view k_doc = R"(The potential around a solid prism: a triangle with thickness.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the prism, 0 inside it

The thickness lies half on either side of the triangle's plane. The distance is exact. `thickness` 0 makes it a
`triangle`; corners on a line make it a `rectangle` through that line, its thickness as near to y as may be.
Source: methods.md section 2, skeletons (surface patches).)";

  Value<Mode, Vec3> a{Vec3(0)};
  Value<Mode, Vec3> b{Vec3(1, 0, 0)};
  Value<Mode, Vec3> c{Vec3(0, 1, 0)};
  Value<Mode, float> thickness{1.f};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("a", &Prism::a, "a corner of the triangle").in(Unit::length).required(),
        parameter("b", &Prism::b, "a corner of the triangle").in(Unit::length).required(),
        parameter("c", &Prism::c, "a corner of the triangle").in(Unit::length).required(),
        parameter("thickness", &Prism::thickness, "from one face to the other").in(Unit::length).at_least(0).required(),
        parameter("radius", &Prism::radius, "radius of influence, from the prism: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Prism::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Prism::weight, "the potential in the prism; negative carves"),
        parameter("falloff", &Prism::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  Box3 support() const { return TrianglePlane(a, b, c).support(0.5 * double(thickness), radius); }

  /// How far the solid moves between two states, and any two states interpolated between them.
  double displacement_from(const Prism& other) const {
    const std::array<Vec3d, 3> p{a, b, c}, q{other.a, other.b, other.c};
    const double corners = std::max({glm::distance(p[0], q[0]), glm::distance(p[1], q[1]), glm::distance(p[2], q[2])});
    return corners + 0.5 * std::abs(double(thickness) - double(other.thickness)) +
           0.5 * double(std::max(thickness, other.thickness)) * TrianglePlane::turn(p, q);
  }

  SectionSolid solid() const {
    const TrianglePlane plane(a, b, c);
    return SectionSolid::extruded(plane.frame, 0.5 * double(thickness)).with_polygon(plane.triangle);
  }
};

} // namespace kelpie
