#pragma once

#include "field/distances/distance_field.h"
#include "field/skeletons/section_solid.h"

namespace kelpie {

template <class Mode>
struct SdfCylinder : DistanceField<SdfCylinder<Mode>> {
  static constexpr std::string_view k_name = "sdf_cylinder";
  static constexpr std::string_view k_doc = R"(A cylinder with flat ends by its signed distance: exact, hard, for Booleans.

    f = weight T clamp(1 - d / radius, 0, 2),   d the signed distance, T the threshold of the shape

With another falloff it is a soft skeleton, as `cylinder` is. Source: methods.md section 2.)";

  Value<Mode, Vec3> from{Vec3(0)};
  Value<Mode, Vec3> to{Vec3(0, 1, 0)};
  Value<Mode, float> cylinder_radius{1.f};
  Value<Mode, float> radius{0.f};
  Value<Mode, float> weight{1.f};
  DistanceFalloff falloff = DistanceFalloff::distance;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("from", &SdfCylinder::from, "the centre of the first end").in(Unit::length).required(),
        parameter("to", &SdfCylinder::to, "the centre of the second end").in(Unit::length).required(),
        parameter("cylinder_radius", &SdfCylinder::cylinder_radius, "the radius of the cylinder itself")
            .in(Unit::length)
            .above(0)
            .required(),
        parameter("radius", &SdfCylinder::radius, k_reach_doc).in(Unit::length).at_least(0),
        parameter("weight", &SdfCylinder::weight, k_distance_weight_doc),
        parameter("falloff", &SdfCylinder::falloff, k_distance_falloff_doc),
    };
  }

  // Sampled:

  Box3d solid_box() const {
    const AxisFrame frame = local_frame();
    const Vec3d across = glm::sqrt(glm::max(Vec3d(0), 1.0 - frame.e * frame.e)) * double(cylinder_radius);
    return {glm::min(Vec3d(from), Vec3d(to)) - across, glm::max(Vec3d(from), Vec3d(to)) + across};
  }
  double inner_radius() const { return std::min(double(cylinder_radius), 0.5 * glm::distance(Vec3d(from), Vec3d(to))); }

  /// How far the surface moves between two states, and any two states interpolated between them.
  double displacement_from(const SdfCylinder& other) const {
    return displacement_of_frustum(Vec3d(from), cylinder_radius, Vec3d(to), cylinder_radius, //
                                   Vec3d(other.from), other.cylinder_radius, Vec3d(other.to), other.cylinder_radius);
  }

  template <class Real>
  Real signed_distance(const Point3<Real>& p) const {
    const double half = 0.5 * glm::distance(Vec3d(from), Vec3d(to));
    const Point3<Real> q = local_frame().local(p);
    const Real zero(0.0), height = q.z - Real(half);
    const Real out = norm(q.x, q.y) - Real(double(cylinder_radius)), above = max(height, -height) - Real(half);
    return norm(max(zero, out), max(zero, above)) + min(zero, max(out, above));
  }

private:
  AxisFrame local_frame() const { return {Vec3d(from), Vec3d(to) - Vec3d(from)}; }
};

} // namespace kelpie
