#pragma once

#include "field/falloff.h"
#include "field/skeletons/section_solid.h"

namespace kelpie {

template <class Mode>
struct HollowCone {
  static constexpr std::string_view k_name = "hollow_cone";
  static constexpr std::string_view k_doc =
      R"(The potential around a hollow cone: a wall turned about an axis, as of a funnel, a tube or a bowl.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the wall, 0 inside it

The middle of the wall goes straight from `from_radius` at `from` to `to_radius` at `to`; the wall's thickness, across it,
changes linearly. What would reach past the axis ends there. The distance is exact. Thickness 0 makes it the surface of
a cone, equal radii a tube, equal ends a flat ring across y, equal ends and radii a circle. Not convex.
Source: methods.md section 2, skeletons (surfaces of revolution with thickness).)";

  Value<Mode, Vec3> from{Vec3(0)};
  Value<Mode, Vec3> to{Vec3(0, 1, 0)};
  Value<Mode, float> from_radius{1.f};
  Value<Mode, float> to_radius{1.f};
  Value<Mode, float> from_thickness{0.f};
  Value<Mode, float> to_thickness{0.f};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{1.f};
  Falloff falloff = Falloff::quartic;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("from", &HollowCone::from, "the centre of the first end").in(Unit::length).required(),
        parameter("to", &HollowCone::to, "the centre of the second end").in(Unit::length).required(),
        parameter("from_radius", &HollowCone::from_radius, "from the axis to the middle of the wall, at the first end")
            .in(Unit::length)
            .at_least(0)
            .required(),
        parameter("to_radius", &HollowCone::to_radius, "the same at the second end").in(Unit::length).at_least(0).required(),
        parameter("from_thickness", &HollowCone::from_thickness, "of the wall at the first end").in(Unit::length).at_least(0),
        parameter("to_thickness", &HollowCone::to_thickness, "of the wall at the second end").in(Unit::length).at_least(0),
        parameter("radius", &HollowCone::radius, "radius of influence, from the wall's surface: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .required(),
        parameter("weight", &HollowCone::weight, "the potential in the wall; negative carves"),
        parameter("falloff", &HollowCone::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  Box3 support() const {
    return frustum_support(from, from_radius, to, to_radius, double(radius) + 0.5 * std::max(double(from_thickness), double(to_thickness)));
  }

  SectionSolid solid() const {
    const Vec3d axis = Vec3d(to) - Vec3d(from);
    const Vec2d begin(from_radius, 0), end(to_radius, glm::length(axis)), along = end - begin;
    const double length = glm::length(along);
    const Vec2d across = length > 0 ? Vec2d(along.y, -along.x) / length : Vec2d(1, 0);
    ConvexPolygon wall;
    wall.push(begin + across * (0.5 * double(from_thickness))), wall.push(end + across * (0.5 * double(to_thickness)));
    wall.push(end - across * (0.5 * double(to_thickness))), wall.push(begin - across * (0.5 * double(from_thickness)));
    return SectionSolid::turned({Vec3d(from), axis}).with_polygon(wall.above(0), false);
  }
};

} // namespace kelpie
