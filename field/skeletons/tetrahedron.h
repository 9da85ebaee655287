#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/convex_hull.h"

namespace kelpie {

template <class Mode>
struct Tetrahedron {
  static constexpr std::string_view k_name = "tetrahedron";
  static constexpr std::string_view k_doc = R"(The potential around a solid tetrahedron.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the tetrahedron, 0 inside it

The distance is exact. Flat, it is a `triangle` or a quadrilateral; then a `segment`, and a `point`.
Source: methods.md section 2, skeletons.)";

  Value<Mode, Vec3> a{Vec3(0)};
  Value<Mode, Vec3> b{Vec3(1, 0, 0)};
  Value<Mode, Vec3> c{Vec3(0, 1, 0)};
  Value<Mode, Vec3> d{Vec3(0, 0, 1)};
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("a", &Tetrahedron::a, "a corner").in(Unit::length).required(),
        parameter("b", &Tetrahedron::b, "a corner").in(Unit::length).required(),
        parameter("c", &Tetrahedron::c, "a corner").in(Unit::length).required(),
        parameter("d", &Tetrahedron::d, "a corner").in(Unit::length).required(),
        parameter("radius", &Tetrahedron::radius, "radius of influence, from the tetrahedron: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Tetrahedron::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Tetrahedron::weight, "the potential in the tetrahedron; negative carves"),
        parameter("falloff", &Tetrahedron::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  Box3 support() const { return support_of_hull(std::array{a, b, c, d}, radius); }

  /// How far the solid moves between two states, and any two states interpolated between them.
  double displacement_from(const Tetrahedron& other) const {
    return std::max({glm::distance(Vec3d(a), Vec3d(other.a)), glm::distance(Vec3d(b), Vec3d(other.b)),
                     glm::distance(Vec3d(c), Vec3d(other.c)), glm::distance(Vec3d(d), Vec3d(other.d))});
  }

  HullSolid<std::array<Vec3, 4>> solid() const { return {{a, b, c, d}}; }
};

} // namespace kelpie
