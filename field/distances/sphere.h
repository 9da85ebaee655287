#pragma once

#include "field/distances/distance_field.h"

namespace kelpie {

template <class Mode>
struct SdfSphere : DistanceField<SdfSphere<Mode>> {
  static constexpr std::string_view k_name = "sdf_sphere";
  static constexpr std::string_view k_doc = R"(A ball by its signed distance: exact, hard, for Booleans.

    f = weight T clamp(1 - d / radius, 0, 2),   d the signed distance, T the threshold of the shape

d = |p - centre| - sphere_radius. With another falloff it is a soft skeleton, as `cone_sphere` is.
Source: methods.md section 2.)";

  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, float> sphere_radius{1.f};
  Value<Mode, float> radius{0.f};
  Value<Mode, float> weight{1.f};
  DistanceFalloff falloff = DistanceFalloff::distance;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("centre", &SdfSphere::centre, "the ball's centre").in(Unit::length).required(),
        parameter("sphere_radius", &SdfSphere::sphere_radius, "the radius of the ball itself").in(Unit::length).above(0).required(),
        parameter("radius", &SdfSphere::radius, k_reach_doc).in(Unit::length).at_least(0),
        parameter("weight", &SdfSphere::weight, k_distance_weight_doc),
        parameter("falloff", &SdfSphere::falloff, k_distance_falloff_doc),
    };
  }

  // Sampled:

  Box3d solid_box() const { return {Vec3d(centre) - double(sphere_radius), Vec3d(centre) + double(sphere_radius)}; }
  double inner_radius() const { return sphere_radius; }

  /// How far the surface moves between two states, and any two states interpolated between them.
  double displacement_from(const SdfSphere& other) const {
    return glm::distance(Vec3d(centre), Vec3d(other.centre)) + std::abs(double(sphere_radius) - double(other.sphere_radius));
  }

  template <class Real>
  Real signed_distance(const Point3<Real>& p) const {
    return norm(norm(p.x - Real(double(centre.x)), p.y - Real(double(centre.y))), p.z - Real(double(centre.z))) -
           Real(double(sphere_radius));
  }
};

} // namespace kelpie
