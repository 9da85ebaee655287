#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/section_solid.h"

namespace kelpie {

template <class Mode>
struct Cone {
  static constexpr std::string_view k_name = "cone";
  static constexpr std::string_view k_doc = R"(The potential around a solid cone with flat ends, truncated unless one of its radii is 0.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the solid, 0 inside it

The distance is exact. Equal radii make it a `cylinder`, radii of 0 a `segment`, equal ends the larger `disc`, across y.
With round ends it is a `cone_sphere`. Source: methods.md section 2, skeletons.)";

  Value<Mode, Vec3> from{Vec3(0)};
  Value<Mode, Vec3> to{Vec3(0, 1, 0)};
  Value<Mode, float> from_radius{1.f};
  Value<Mode, float> to_radius{0.f};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("from", &Cone::from, "the centre of the first end").in(Unit::length).required(),
        parameter("to", &Cone::to, "the centre of the second end").in(Unit::length).required(),
        parameter("from_radius", &Cone::from_radius, "the radius of the first end").in(Unit::length).at_least(0).required(),
        parameter("to_radius", &Cone::to_radius, "the radius of the second end").in(Unit::length).at_least(0),
        parameter("radius", &Cone::radius, "radius of influence, from the solid's surface: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Cone::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Cone::weight, "the potential in the solid; negative carves"),
        parameter("falloff", &Cone::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  Box3 support() const { return frustum_support(from, from_radius, to, to_radius, radius); }

  /// How far the solid moves between two states, and any two states interpolated between them.
  double displacement_from(const Cone& other) const {
    return displacement_of_frustum(Vec3d(from), from_radius, Vec3d(to), to_radius, //
                                   Vec3d(other.from), other.from_radius, Vec3d(other.to), other.to_radius);
  }

  SectionSolid solid() const {
    const Vec3d axis = Vec3d(to) - Vec3d(from);
    const double a = from_radius, b = to_radius, length = glm::length(axis);
    // Both halves of the section, so that the axis is no border.
    ConvexPolygon section;
    section.push({-a, 0}), section.push({a, 0}), section.push({b, length}), section.push({-b, length});
    return SectionSolid::turned({Vec3d(from), axis}).with_polygon(section);
  }
};

} // namespace kelpie
