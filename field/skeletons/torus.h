#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/section_solid.h"

namespace kelpie {

template <class Mode>
struct Torus {
  static constexpr std::string_view k_name = "torus";
  static constexpr std::string_view k_doc = R"(The potential around a solid torus: a soft ring.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the torus, 0 inside it

With h the height above the ring's plane and r the distance from its axis,
d = max(0, |(r - major_radius, h)| - minor_radius). The distance is exact, also where the tube is thicker than the
ring (`minor_radius` > `major_radius`: the hole closes). `major_radius` 0 makes it a solid ball, `minor_radius` 0 a
circle. Not convex. On the axis of a ring the potential has a crease, as the nearest point is not one.
Source: methods.md section 2, skeletons.)";

  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, Vec3> normal{Vec3(0, 1, 0)};
  Value<Mode, float> major_radius{1.f};
  Value<Mode, float> minor_radius{0.f};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("centre", &Torus::centre, "the ring's centre").in(Unit::length).required(),
        parameter("normal", &Torus::normal, "the ring's axis; need not be a unit vector").nonzero(),
        parameter("major_radius", &Torus::major_radius, "from the centre to the middle of the tube")
            .in(Unit::length)
            .at_least(0)
            .required(),
        parameter("minor_radius", &Torus::minor_radius, "the radius of the solid tube").in(Unit::length).at_least(0),
        parameter("radius", &Torus::radius, "radius of influence, from the tube's surface: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Torus::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Torus::weight, "the potential in the tube; negative carves"),
        parameter("falloff", &Torus::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  Box3 support() const {
    const AxisFrame frame{Vec3d(centre), Vec3d(normal)};
    const Vec3d ring = double(major_radius) * glm::sqrt(glm::max(Vec3d(0), 1.0 - frame.e * frame.e));
    const Vec3d reach = ring + (double(minor_radius) + double(radius));
    return rounded_outward({Vec3d(centre) - reach, Vec3d(centre) + reach});
  }

  /// How far the tube moves between two states, and any two states interpolated between them.
  double displacement_from(const Torus& other) const {
    return glm::distance(Vec3d(centre), Vec3d(other.centre)) + std::abs(double(major_radius) - double(other.major_radius)) +
           std::abs(double(minor_radius) - double(other.minor_radius)) +
           std::max(major_radius, other.major_radius) * tilt(Vec3d(normal), Vec3d(other.normal));
  }

  SectionSolid solid() const {
    return SectionSolid::turned({Vec3d(centre), Vec3d(normal)}).with_rectangle(major_radius, major_radius, 0).grown_by(minor_radius);
  }
};

} // namespace kelpie
