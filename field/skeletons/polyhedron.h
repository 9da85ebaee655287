#pragma once

#include "field/potential/falloff.h"
#include "field/skeletons/convex_hull.h"

namespace kelpie {

template <class Mode>
struct Polyhedron {
  static constexpr std::string_view k_name = "polyhedron";
  static constexpr std::string_view k_doc = R"(The potential around a solid convex polyhedron: the convex hull of points.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the hull, 0 inside it

The points may come in any order, and move; those inside the hull of the others do not matter. The distance is exact.
Points in a plane make a flat polygon, points on a line a `segment`. Time grows with the number of points.
Source: methods.md section 2, skeletons.)";

  std::vector<Value<Mode, Vec3>> points;
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("points", &Polyhedron::points, "the corners; each may be animated").in(Unit::length).required(),
        parameter("radius", &Polyhedron::radius, "radius of influence, from the hull: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Polyhedron::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Polyhedron::weight, "the potential in the hull; negative carves"),
        parameter("falloff", &Polyhedron::falloff, "how the potential decreases"),
    };
  }

  // Sampled:

  Box3 support() const { return support_of_hull(points, radius); }

  HullSolid<std::span<const Vec3>> solid() const { return {points}; }

  /// How far the hull moves between two states with as many points, and any two states interpolated between them.
  double displacement_from(const Polyhedron& other) const {
    double most = 0;
    for (size_t i = 0; i < std::min(points.size(), other.points.size()); ++i)
      most = std::max(most, glm::distance(Vec3d(points[i]), Vec3d(other.points[i])));
    return most;
  }
};

} // namespace kelpie
