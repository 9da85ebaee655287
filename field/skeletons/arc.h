#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/section_solid.h"

namespace kelpie {

template <class Mode>
struct Arc {
  static constexpr std::string_view k_name = "arc";
  static constexpr std::string_view k_doc = R"(The potential around an arc of a circle.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the arc

The arc reaches `angle` / 2 to either side of its middle, which lies in the direction of `towards` from the centre. Over
the arc d is the distance to the circle, elsewhere that to the nearer end: both are exact. An `angle` of 360 makes it a
`circle`; 0, or `arc_radius` 0, a `point`. Not convex. Source: methods.md section 2, skeletons.)";

  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, Vec3> normal{Vec3(0, 1, 0)};
  Value<Mode, Vec3> towards{Vec3(1, 0, 0)};
  Value<Mode, float> arc_radius{1.f};
  Value<Mode, float> angle{180.f};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("centre", &Arc::centre, "the circle's centre").in(Unit::length).required(),
        parameter("normal", &Arc::normal, "perpendicular to the circle; need not be a unit vector").nonzero(),
        parameter("towards", &Arc::towards, "from the centre towards the arc's middle; only what is perpendicular to `normal` counts")
            .nonzero(),
        parameter("arc_radius", &Arc::arc_radius, "the circle's radius").in(Unit::length).at_least(0).required(),
        parameter("angle", &Arc::angle, "from one end of the arc to the other").in(Unit::degrees).at_least(0).at_most(360).required(),
        parameter("radius", &Arc::radius, "radius of influence, from the arc: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Arc::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Arc::weight, "the potential on the arc; negative carves"),
        parameter("falloff", &Arc::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  /// That of the whole circle.
  Box3 support() const { return frustum_support(centre, arc_radius, centre, arc_radius, radius, normal); }

  /// How far the solid moves between two states, and any two states interpolated between them.
  double displacement_from(const Arc& other) const {
    const FrameTurn turn = turn_of(Vec3d(normal), Vec3d(towards), Vec3d(other.normal), Vec3d(other.towards));
    const double opened = 0.5 * glm::radians(std::abs(double(angle) - double(other.angle)));
    return glm::distance(Vec3d(centre), Vec3d(other.centre)) + std::abs(double(arc_radius) - double(other.arc_radius)) +
           std::max(arc_radius, other.arc_radius) * std::min(2.0, turn.axis + turn.about + opened);
  }

  ArcSolid solid() const {
    return {AxisFrame{Vec3d(centre), Vec3d(normal), Vec3d(towards)}, arc_radius, 0.5 * glm::radians(double(angle))};
  }
};

} // namespace kelpie
