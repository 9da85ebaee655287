#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/section_solid.h"

namespace kelpie {

template <class Mode>
struct Circle {
  static constexpr std::string_view k_name = "circle";
  static constexpr std::string_view k_doc = R"(The potential around a circle: a thin, soft ring.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the circle

With h the height above the circle's plane and r the distance from its axis, d^2 = h^2 + (r - circle_radius)^2. The
distance is exact. `circle_radius` 0 makes it a `point`; a ring that is solid is a `torus`, a part of it an `arc`. Not
convex. On the axis the potential has a crease, as the nearest point is not one. Source: methods.md section 2, skeletons.)";

  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, Vec3> normal{Vec3(0, 1, 0)};
  Value<Mode, float> circle_radius{1.f};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("centre", &Circle::centre, "the circle's centre").in(Unit::length).required(),
        parameter("normal", &Circle::normal, "perpendicular to the circle; need not be a unit vector").nonzero(),
        parameter("circle_radius", &Circle::circle_radius, "the radius of the circle itself").in(Unit::length).at_least(0).required(),
        parameter("radius", &Circle::radius, "radius of influence, from the circle: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Circle::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Circle::weight, "the potential on the circle; negative carves"),
        parameter("falloff", &Circle::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  Box3 support() const { return frustum_support(centre, circle_radius, centre, circle_radius, radius, normal); }

  /// How far the solid moves between two states, and any two states interpolated between them.
  double displacement_from(const Circle& other) const {
    return glm::distance(Vec3d(centre), Vec3d(other.centre)) + std::abs(double(circle_radius) - double(other.circle_radius)) +
           std::max(circle_radius, other.circle_radius) * tilt(Vec3d(normal), Vec3d(other.normal));
  }

  SectionSolid solid() const {
    return SectionSolid::turned({Vec3d(centre), Vec3d(normal)}).with_rectangle(circle_radius, circle_radius, 0);
  }
};

} // namespace kelpie
