#pragma once

#include "field/distances/distance_field.h"
#include "field/skeletons/cone_sphere.h"

namespace kelpie {

template <class Mode>
struct SdfCapsule : DistanceField<SdfCapsule<Mode>> {
  static constexpr std::string_view k_name = "sdf_capsule";
  static constexpr std::string_view k_doc = R"(A capsule, a cylinder with round ends, by its signed distance: exact, hard, for Booleans.

    f = weight T clamp(1 - d / radius, 0, 2),   d the signed distance, T the threshold of the shape

d is the distance to the segment, less `capsule_radius`. With another falloff it is a soft skeleton, as `cone_sphere` is.
Source: methods.md section 2.)";

  Value<Mode, Vec3> from{Vec3(0)};
  Value<Mode, Vec3> to{Vec3(0, 1, 0)};
  Value<Mode, float> capsule_radius{1.f};
  Value<Mode, float> radius{0.f};
  Value<Mode, float> weight{1.f};
  DistanceFalloff falloff = DistanceFalloff::distance;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("from", &SdfCapsule::from, "the centre of the first end").in(Unit::length).required(),
        parameter("to", &SdfCapsule::to, "the centre of the second end").in(Unit::length).required(),
        parameter("capsule_radius", &SdfCapsule::capsule_radius, "the radius of the capsule itself").in(Unit::length).above(0).required(),
        parameter("radius", &SdfCapsule::radius, k_reach_doc).in(Unit::length).at_least(0),
        parameter("weight", &SdfCapsule::weight, k_distance_weight_doc),
        parameter("falloff", &SdfCapsule::falloff, k_distance_falloff_doc),
    };
  }

  // Sampled:

  Box3d solid_box() const { return Box3d{glm::min(Vec3d(from), Vec3d(to)), glm::max(Vec3d(from), Vec3d(to))}.padded(capsule_radius); }
  double inner_radius() const { return capsule_radius; }

  /// How far the surface moves between two states, and any two states interpolated between them.
  double displacement_from(const SdfCapsule& other) const {
    return std::max(glm::distance(Vec3d(from), Vec3d(other.from)), glm::distance(Vec3d(to), Vec3d(other.to))) +
           std::abs(double(capsule_radius) - double(other.capsule_radius));
  }

  template <class Real>
  Real signed_distance(const Point3<Real>& p) const {
    const Vec3d axis = Vec3d(to) - Vec3d(from);
    const ConeSphereProfile profile{glm::length(axis), capsule_radius, capsule_radius};
    const Point3<Real> q = AxisFrame{Vec3d(from), axis}.local(p);
    return distance(profile, norm(q.x, q.y), q.z);
  }
};

} // namespace kelpie
