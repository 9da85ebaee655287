#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/section_solid.h"

namespace kelpie {

template <class Mode>
struct Cylinder {
  static constexpr std::string_view k_name = "cylinder";
  static constexpr std::string_view k_doc = R"(The potential around a solid cylinder with flat ends.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the solid, 0 inside it

The distance is exact. `cylinder_radius` 0 makes it a `segment`; equal ends make it a `disc` across y. With round ends
it is a `cone_sphere` of equal radii. Source: methods.md section 2, skeletons.)";

  Value<Mode, Vec3> from{Vec3(0)};
  Value<Mode, Vec3> to{Vec3(0, 1, 0)};
  Value<Mode, float> cylinder_radius{1.f};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("from", &Cylinder::from, "the centre of the first end").in(Unit::length).required(),
        parameter("to", &Cylinder::to, "the centre of the second end").in(Unit::length).required(),
        parameter("cylinder_radius", &Cylinder::cylinder_radius, "the radius of the cylinder itself")
            .in(Unit::length)
            .at_least(0)
            .required(),
        parameter("radius", &Cylinder::radius, "radius of influence, from the solid's surface: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Cylinder::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Cylinder::weight, "the potential in the solid; negative carves"),
        parameter("falloff", &Cylinder::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  Box3 support() const { return frustum_support(from, cylinder_radius, to, cylinder_radius, radius); }

  /// How far the solid moves between two states, and any two states interpolated between them.
  double displacement_from(const Cylinder& other) const {
    return displacement_of_frustum(Vec3d(from), cylinder_radius, Vec3d(to), cylinder_radius, //
                                   Vec3d(other.from), other.cylinder_radius, Vec3d(other.to), other.cylinder_radius);
  }

  SectionSolid solid() const {
    const Vec3d axis = Vec3d(to) - Vec3d(from);
    const double r = cylinder_radius;
    return SectionSolid::turned({Vec3d(from) + 0.5 * axis, axis}).with_rectangle(-r, r, 0.5 * glm::length(axis));
  }
};

} // namespace kelpie
