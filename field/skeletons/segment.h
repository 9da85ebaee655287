#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/cone_sphere_solid.h"

namespace kelpie {

template <class Mode>
struct Segment {
  static constexpr std::string_view k_name = "segment";
  static constexpr std::string_view k_doc = R"(The potential around a line segment: a capsule of soft matter.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the segment

Equal ends make it a `point`. Source: methods.md section 2.)";

  Value<Mode, Vec3> from{Vec3(0)};
  Value<Mode, Vec3> to{Vec3(0, 1, 0)};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("from", &Segment::from, "one end of the skeleton").in(Unit::length).required(),
        parameter("to", &Segment::to, "the other end").in(Unit::length).required(),
        parameter("radius", &Segment::radius, "radius of influence: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Segment::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Segment::weight, "the potential on the segment; negative carves"),
        parameter("falloff", &Segment::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  ConeSphereSolid solid() const { return {Vec3d(from), Vec3d(to), 0, 0}; }

  Box3 support() const {
    Box3 box;
    box.extend(from), box.extend(to);
    return box.padded(radius);
  }

  /// How far the segment moves between two states, and any two states interpolated between them.
  double displacement_from(const Segment& other) const {
    return std::max(glm::distance(Vec3d(from), Vec3d(other.from)), glm::distance(Vec3d(to), Vec3d(other.to)));
  }
};

} // namespace kelpie
