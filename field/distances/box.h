#pragma once

#include "field/distances/distance_field.h"
#include "field/skeletons/section_solid.h"

namespace kelpie {

template <class Mode>
struct SdfBox : DistanceField<SdfBox<Mode>> {
  static constexpr std::string_view k_name = "sdf_box";
  static constexpr std::string_view k_doc = R"(A box by its signed distance, its edges sharp or rounded: exact, hard, for Booleans.

    f = weight T clamp(1 - d / radius, 0, 2),   d the signed distance, T the threshold of the shape

The distance is exact inside and outside. `rounding` takes the edges off within the box's size; half of its
smallest size is the most. With another falloff it is a soft skeleton, as `box` is. Source: methods.md section 2.)";

  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, Vec3> size{Vec3(1)};
  Value<Mode, float> rounding{0.f};
  Value<Mode, Vec3> axis{Vec3(0, 1, 0)};
  Value<Mode, Vec3> across{Vec3(1, 0, 0)};
  Value<Mode, float> radius{0.f};
  Value<Mode, float> weight{1.f};
  DistanceFalloff falloff = DistanceFalloff::distance;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("centre", &SdfBox::centre, "the box's centre").in(Unit::length).required(),
        parameter("size", &SdfBox::size, "its edges: across, along its axis, and perpendicular to both; or one number for all")
            .in(Unit::length)
            .above(0)
            .or_number_for_all()
            .required(),
        parameter("rounding", &SdfBox::rounding, "the radius of its edges").in(Unit::length).at_least(0),
        parameter("axis", &SdfBox::axis, "direction of its second edges; need not be a unit vector").nonzero(),
        parameter("across", &SdfBox::across, "direction of its first edges; only what is perpendicular to `axis` counts").nonzero(),
        parameter("radius", &SdfBox::radius, k_reach_doc).in(Unit::length).at_least(0),
        parameter("weight", &SdfBox::weight, k_distance_weight_doc),
        parameter("falloff", &SdfBox::falloff, k_distance_falloff_doc),
    };
  }

  // Sampled:

  Box3d solid_box() const {
    const AxisFrame frame = local_frame();
    const Vec3d half = 0.5 * Vec3d(size);
    const Vec3d extent = glm::abs(frame.u) * half.x + glm::abs(frame.e) * half.y + glm::abs(frame.v) * half.z;
    return {Vec3d(centre) - extent, Vec3d(centre) + extent};
  }
  double inner_radius() const { return 0.5 * double(std::min({size.x, size.y, size.z})); }

  /// How far the surface moves between two states, and any two states interpolated between them: the block that its edges are
  /// rounded off from, and what rounding takes off its corners.
  double displacement_from(const SdfBox& other) const {
    const auto half = [](const SdfBox& box) { return 0.5 * Vec3d(box.size.x, box.size.z, box.size.y); };
    const Vec3d thinner = glm::abs(half(*this) - half(other));
    const double round = std::max({std::abs(double(rounding) - double(other.rounding)), thinner.x, thinner.y, thinner.z});
    const bool is_round = rounding > 0 || other.rounding > 0;
    return displacement_of_block(Vec3d(centre), half(*this), Vec3d(other.centre), half(other),
                                 turn_of(Vec3d(axis), Vec3d(across), Vec3d(other.axis), Vec3d(other.across))) +
           (is_round ? (std::sqrt(3.0) - 1) * round : 0);
  }

  template <class Real>
  Real signed_distance(const Point3<Real>& p) const {
    const double round = std::min(double(rounding), inner_radius());
    return distance_to_block(local_frame().local(p), 0.5 * Vec3d(size.x, size.z, size.y) - round) - Real(round);
  }

private:
  AxisFrame local_frame() const { return {Vec3d(centre), Vec3d(axis), Vec3d(across)}; }
};

} // namespace kelpie
