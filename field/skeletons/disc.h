#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/section_solid.h"

namespace kelpie {

template <class Mode>
struct Disc {
  static constexpr std::string_view k_name = "disc";
  static constexpr std::string_view k_doc = R"(The potential around a flat, round disc: a cushion with a soft rim.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the disc

With h the height above the disc's plane and r the distance from its axis, d^2 = h^2 + max(0, r - disc_radius)^2.
The distance is exact. `disc_radius` 0 makes it a `point`. Source: methods.md section 2, skeletons.)";

  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, Vec3> normal{Vec3(0, 1, 0)};
  Value<Mode, float> disc_radius{1.f};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("centre", &Disc::centre, "the disc's centre").in(Unit::length).required(),
        parameter("normal", &Disc::normal, "perpendicular to the disc; need not be a unit vector").nonzero(),
        parameter("disc_radius", &Disc::disc_radius, "the radius of the disc itself").in(Unit::length).at_least(0).required(),
        parameter("radius", &Disc::radius, "radius of influence: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Disc::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Disc::weight, "the potential on the disc; negative carves"),
        parameter("falloff", &Disc::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  Box3 support() const {
    const AxisFrame frame{Vec3d(centre), Vec3d(normal)};
    const Vec3d reach = double(disc_radius) * glm::sqrt(glm::max(Vec3d(0), 1.0 - frame.e * frame.e)) + double(radius);
    return rounded_outward({Vec3d(centre) - reach, Vec3d(centre) + reach});
  }

  /// How far the disc moves between two states, and any two states interpolated between them.
  double displacement_from(const Disc& other) const {
    return glm::distance(Vec3d(centre), Vec3d(other.centre)) + std::abs(double(disc_radius) - double(other.disc_radius)) +
           std::max(disc_radius, other.disc_radius) * tilt(Vec3d(normal), Vec3d(other.normal));
  }

  SectionSolid solid() const {
    return SectionSolid::turned({Vec3d(centre), Vec3d(normal)}).with_rectangle(-double(disc_radius), double(disc_radius), 0);
  }
};

} // namespace kelpie
