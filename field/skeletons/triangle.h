#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/section_solid.h"
#include "field/skeletons/triangle_plane.h"

namespace kelpie {

/// (`Triangle` is that of meshes.)
template <class Mode>
struct FlatTriangle {
  static constexpr std::string_view k_name = "triangle";
  static constexpr std::string_view k_doc = R"(The potential around a flat triangle.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the triangle

The distance is exact. Corners on a line make it a `segment`, equal corners a `point`. With thickness it is a `prism`.
Source: methods.md section 2, skeletons.)";

  Value<Mode, Vec3> a{Vec3(0)};
  Value<Mode, Vec3> b{Vec3(1, 0, 0)};
  Value<Mode, Vec3> c{Vec3(0, 1, 0)};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("a", &FlatTriangle::a, "a corner").in(Unit::length).required(),
        parameter("b", &FlatTriangle::b, "a corner").in(Unit::length).required(),
        parameter("c", &FlatTriangle::c, "a corner").in(Unit::length).required(),
        parameter("radius", &FlatTriangle::radius, "radius of influence, from the triangle: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &FlatTriangle::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &FlatTriangle::weight, "the potential on the triangle; negative carves"),
        parameter("falloff", &FlatTriangle::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  Box3 support() const { return TrianglePlane(a, b, c).support(0, radius); }

  /// How far the solid moves between two states, and any two states interpolated between them.
  double displacement_from(const FlatTriangle& other) const {
    return std::max(
        {glm::distance(Vec3d(a), Vec3d(other.a)), glm::distance(Vec3d(b), Vec3d(other.b)), glm::distance(Vec3d(c), Vec3d(other.c))});
  }

  SectionSolid solid() const {
    const TrianglePlane plane(a, b, c);
    return SectionSolid::extruded(plane.frame, 0).with_polygon(plane.triangle);
  }
};

} // namespace kelpie
