#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/section_solid.h"

namespace kelpie {

template <class Mode>
struct Box {
  static constexpr std::string_view k_name = "box";
  static constexpr std::string_view k_doc = R"(The potential around a solid box: a block with soft edges.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the box, 0 inside it

The distance is exact. Sizes of 0 make it a `rectangle`, a `segment` or a `point`.
Source: methods.md section 2, skeletons.)";

  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, Vec3> size{Vec3(1)};
  Value<Mode, Vec3> axis{Vec3(0, 1, 0)};
  Value<Mode, Vec3> across{Vec3(1, 0, 0)};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("centre", &Box::centre, "the box's centre").in(Unit::length).required(),
        parameter("size", &Box::size, "its edges: across, along its axis, and perpendicular to both; or one number for all")
            .in(Unit::length)
            .at_least(0)
            .or_number_for_all()
            .required(),
        parameter("axis", &Box::axis, "direction of its second edges; need not be a unit vector").nonzero(),
        parameter("across", &Box::across, "direction of its first edges; only what is perpendicular to `axis` counts").nonzero(),
        parameter("radius", &Box::radius, "radius of influence, from the box: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Box::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Box::weight, "the potential in the box; negative carves"),
        parameter("falloff", &Box::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  Box3 support() const {
    const AxisFrame frame{Vec3d(centre), Vec3d(axis), Vec3d(across)};
    const Vec3d half = 0.5 * Vec3d(size);
    const Vec3d reach = glm::abs(frame.u) * half.x + glm::abs(frame.e) * half.y + glm::abs(frame.v) * half.z + double(radius);
    return rounded_outward({Vec3d(centre) - reach, Vec3d(centre) + reach});
  }

  /// How far the solid moves between two states, and any two states interpolated between them.
  double displacement_from(const Box& other) const {
    const auto half = [](const Box& box) { return 0.5 * Vec3d(box.size.x, box.size.z, box.size.y); };
    return displacement_of_block(Vec3d(centre), half(*this), Vec3d(other.centre), half(other),
                                 turn_of(Vec3d(axis), Vec3d(across), Vec3d(other.axis), Vec3d(other.across)));
  }

  SectionSolid solid() const {
    const Vec3d half = 0.5 * Vec3d(size);
    return SectionSolid::extruded({Vec3d(centre), Vec3d(axis), Vec3d(across)}, half.y).with_rectangle(-half.x, half.x, half.z);
  }
};

} // namespace kelpie
