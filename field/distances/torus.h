#pragma once

#include "field/distances/distance_field.h"

namespace kelpie {

template <class Mode>
struct SdfTorus : DistanceField<SdfTorus<Mode>> {
  static constexpr std::string_view k_name = "sdf_torus";
  static constexpr std::string_view k_doc = R"(A torus by its signed distance: exact, hard, for Booleans.

    f = weight T clamp(1 - d / radius, 0, 2),   d the signed distance, T the threshold of the shape

With h the height above the ring's plane and r the distance from its axis, d = |(r - major_radius, h)| - minor_radius
(exact for `minor_radius` <= `major_radius`; beyond that inside the closed hole d is too small by what overlaps).
With another falloff it is a soft skeleton, as `torus` is. Source: methods.md section 2.)";

  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, Vec3> normal{Vec3(0, 1, 0)};
  Value<Mode, float> major_radius{1.f};
  Value<Mode, float> minor_radius{0.25f};
  Value<Mode, float> radius{0.f};
  Value<Mode, float> weight{1.f};
  DistanceFalloff falloff = DistanceFalloff::distance;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("centre", &SdfTorus::centre, "the ring's centre").in(Unit::length).required(),
        parameter("normal", &SdfTorus::normal, "the ring's axis; need not be a unit vector").nonzero(),
        parameter("major_radius", &SdfTorus::major_radius, "from the centre to the middle of the tube")
            .in(Unit::length)
            .at_least(0)
            .required(),
        parameter("minor_radius", &SdfTorus::minor_radius, "the radius of the tube").in(Unit::length).above(0).required(),
        parameter("radius", &SdfTorus::radius, k_reach_doc).in(Unit::length).at_least(0),
        parameter("weight", &SdfTorus::weight, k_distance_weight_doc),
        parameter("falloff", &SdfTorus::falloff, k_distance_falloff_doc),
    };
  }

  // Sampled:

  Box3d solid_box() const {
    const AxisFrame frame{Vec3d(centre), Vec3d(normal)};
    const Vec3d ring = double(major_radius) * glm::sqrt(glm::max(Vec3d(0), 1.0 - frame.e * frame.e));
    return Box3d{Vec3d(centre) - ring, Vec3d(centre) + ring}.padded(minor_radius);
  }
  double inner_radius() const { return minor_radius; }

  /// How far the surface moves between two states, and any two states interpolated between them.
  double displacement_from(const SdfTorus& other) const {
    return glm::distance(Vec3d(centre), Vec3d(other.centre)) + std::abs(double(major_radius) - double(other.major_radius)) +
           std::abs(double(minor_radius) - double(other.minor_radius)) +
           std::max(major_radius, other.major_radius) * tilt(Vec3d(normal), Vec3d(other.normal));
  }

  template <class Real>
  Real signed_distance(const Point3<Real>& p) const {
    const Point3<Real> q = AxisFrame{Vec3d(centre), Vec3d(normal)}.local(p);
    return norm(norm(q.x, q.y) - Real(double(major_radius)), q.z) - Real(double(minor_radius));
  }
};

} // namespace kelpie
