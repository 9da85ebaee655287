#pragma once

#include "field/potential/falloff.h"
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
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

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
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &HollowCone::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &HollowCone::weight, "the potential in the wall; negative carves"),
        parameter("falloff", &HollowCone::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  Box3 support() const {
    return frustum_support(from, std::max(0.f, from_radius), to, std::max(0.f, to_radius),
                           double(radius) + 0.5 * std::max(double(from_thickness), double(to_thickness)));
  }

  /// How far the wall moves between two states, and any two states interpolated between them.
  double displacement_from(const HollowCone& other) const {
    const Section a = section(), b = other.section();
    const double ends = std::max(glm::distance(Vec3d(from), Vec3d(other.from)) + std::abs(double(from_radius) - double(other.from_radius)),
                                 glm::distance(Vec3d(to), Vec3d(other.to)) + std::abs(double(to_radius) - double(other.to_radius)));
    const double thicker = 0.5 * std::max(std::abs(double(from_thickness) - double(other.from_thickness)),
                                          std::abs(double(to_thickness) - double(other.to_thickness)));
    const double half = 0.5 * std::max({from_thickness, to_thickness, other.from_thickness, other.to_thickness});
    const double reach =
        half + std::max({std::abs(from_radius), std::abs(to_radius), std::abs(other.from_radius), std::abs(other.to_radius)});
    const double tilted = tilt(Vec3d(to) - Vec3d(from), Vec3d(other.to) - Vec3d(other.from));
    const double moved = ends + thicker + half * turn(a, b, tilted) + reach * tilted;
    // Where the axis cuts off a part, the cut may run along the wall faster than that moves.
    return is_cut() || other.is_cut() ? moved + glm::length(a.along) + glm::length(b.along) + 2 * half : moved;
  }

  SectionSolid solid() const {
    const Section s = section();
    ConvexPolygon wall;
    wall.push(s.begin + s.across * (0.5 * double(from_thickness))), wall.push(s.end + s.across * (0.5 * double(to_thickness)));
    wall.push(s.end - s.across * (0.5 * double(to_thickness))), wall.push(s.begin - s.across * (0.5 * double(from_thickness)));
    return SectionSolid::turned({Vec3d(from), Vec3d(to) - Vec3d(from)}).with_polygon(wall.above(0), false);
  }

private:
  /// The middle of the wall in the half plane: x from the axis, y along it.
  struct Section {
    Vec2d begin, end, along, across;
  };
  Section section() const {
    Section s{{from_radius, 0}, {to_radius, glm::distance(Vec3d(from), Vec3d(to))}, {}, {1, 0}};
    s.along = s.end - s.begin;
    if (const double length = glm::length(s.along); length > 0) s.across = Vec2d(s.along.y, -s.along.x) / length;
    return s;
  }
  bool is_cut() const {
    const Section s = section();
    return s.begin.x < std::abs(s.across.x) * 0.5 * double(from_thickness) || s.end.x < std::abs(s.across.x) * 0.5 * double(to_thickness);
  }
  /// How much `across` changes. Where the axis tilts by e, the length that is interpolated differs from an interpolated length by no
  /// more than e^2 times the longer.
  static double turn(const Section& a, const Section& b, double tilted) {
    const double a_length = glm::length(a.along), b_length = glm::length(b.along);
    if (a_length == 0 || b_length == 0) return glm::distance(a.across, b.across);
    if (glm::dot(a.across, b.across) < 0) return 2;
    const double bent = square(tilted) * std::max(a.end.y, b.end.y) / std::min(a_length, b_length);
    return std::min(2.0, glm::distance(a.across, b.across) + 3 * bent);
  }
};

} // namespace kelpie
