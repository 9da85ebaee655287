#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/cone_sphere_solid.h"

namespace kelpie {

template <class Mode>
struct ConeSphere {
  static constexpr std::string_view k_name = "cone_sphere";
  static constexpr std::string_view k_doc =
      R"(The potential around a solid cone-sphere: two balls and the cone that touches both. A capsule if they are equal.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the solid, 0 inside it

The distance is exact: that to the nearest of the balls around the points between the two centres, whose radii
change linearly from `from_radius` to `to_radius`. Simpler shapes are reached without a jump: equal radii make a
line-swept sphere, radii of 0 a `segment`, equal centres or a ball inside the other the larger ball. Limbs are
chains of cone-spheres. Source: methods.md section 2, skeletons.)";

  Value<Mode, Vec3> from{Vec3(0)};
  Value<Mode, Vec3> to{Vec3(0, 1, 0)};
  Value<Mode, float> from_radius{0.f};
  Value<Mode, float> to_radius{0.f};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("from", &ConeSphere::from, "the centre of the first ball").in(Unit::length).required(),
        parameter("to", &ConeSphere::to, "the centre of the second ball").in(Unit::length).required(),
        parameter("from_radius", &ConeSphere::from_radius, "the radius of the first ball").in(Unit::length).at_least(0).required(),
        parameter("to_radius", &ConeSphere::to_radius, "the radius of the second ball").in(Unit::length).at_least(0).required(),
        parameter("radius", &ConeSphere::radius, "radius of influence, from the solid's surface: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &ConeSphere::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &ConeSphere::weight, "the potential in the solid; negative carves"),
        parameter("falloff", &ConeSphere::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  ConeSphereSolid solid() const { return {Vec3d(from), Vec3d(to), from_radius, to_radius}; }

  Box3 support() const {
    const double a = double(from_radius) + double(radius), b = double(to_radius) + double(radius);
    Box3d box{Vec3d(from) - a, Vec3d(from) + a};
    box.extend(Box3d{Vec3d(to) - b, Vec3d(to) + b});
    return rounded_outward(box);
  }

  /// How far the solid moves between two states, and any two states interpolated between them.
  double displacement_from(const ConeSphere& other) const {
    return std::max(glm::distance(Vec3d(from), Vec3d(other.from)) + std::abs(double(from_radius) - double(other.from_radius)),
                    glm::distance(Vec3d(to), Vec3d(other.to)) + std::abs(double(to_radius) - double(other.to_radius)));
  }
};

} // namespace kelpie
