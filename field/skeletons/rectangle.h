#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/section_solid.h"

namespace kelpie {

template <class Mode>
struct Rectangle {
  static constexpr std::string_view k_name = "rectangle";
  static constexpr std::string_view k_doc = R"(The potential around a flat rectangle: a soft plate.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the rectangle

The distance is exact. A `width` or `height` of 0 makes it a `segment`, both a `point`.
Source: methods.md section 2, skeletons.)";

  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, Vec3> normal{Vec3(0, 1, 0)};
  Value<Mode, Vec3> across{Vec3(1, 0, 0)};
  Value<Mode, float> width{1.f};
  Value<Mode, float> height{1.f};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("centre", &Rectangle::centre, "the rectangle's centre").in(Unit::length).required(),
        parameter("normal", &Rectangle::normal, "perpendicular to the rectangle; need not be a unit vector").nonzero(),
        parameter("across", &Rectangle::across, "direction of its width; only what is perpendicular to `normal` counts").nonzero(),
        parameter("width", &Rectangle::width, "its edge along `across`").in(Unit::length).at_least(0).required(),
        parameter("height", &Rectangle::height, "its other edge").in(Unit::length).at_least(0).required(),
        parameter("radius", &Rectangle::radius, "radius of influence, from the rectangle: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Rectangle::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Rectangle::weight, "the potential on the rectangle; negative carves"),
        parameter("falloff", &Rectangle::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  Box3 support() const {
    const AxisFrame frame{Vec3d(centre), Vec3d(normal), Vec3d(across)};
    const Vec3d reach = glm::abs(frame.u) * (0.5 * double(width)) + glm::abs(frame.v) * (0.5 * double(height)) + double(radius);
    return rounded_outward({Vec3d(centre) - reach, Vec3d(centre) + reach});
  }

  /// How far the solid moves between two states, and any two states interpolated between them.
  double displacement_from(const Rectangle& other) const {
    const auto half = [](const Rectangle& r) { return 0.5 * Vec3d(r.width, r.height, 0); };
    return displacement_of_block(Vec3d(centre), half(*this), Vec3d(other.centre), half(other),
                                 turn_of(Vec3d(normal), Vec3d(across), Vec3d(other.normal), Vec3d(other.across)));
  }

  SectionSolid solid() const {
    const double x = 0.5 * double(width), y = 0.5 * double(height);
    return SectionSolid::extruded({Vec3d(centre), Vec3d(normal), Vec3d(across)}, 0).with_rectangle(-x, x, y);
  }
};

} // namespace kelpie
