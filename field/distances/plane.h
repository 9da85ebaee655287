#pragma once

#include "field/distances/distance_field.h"

namespace kelpie {

template <class Mode>
struct SdfPlane : DistanceField<SdfPlane<Mode>> {
  static constexpr std::string_view k_name = "sdf_plane";
  static constexpr std::string_view k_doc = R"(All that lies below a plane, by its signed distance: to cut things with.

    f = weight T clamp(1 - d / radius, 0, 2),   d the signed distance, T the threshold of the shape

d is the height above the plane. It has no end, so alone it is no shape: intersect it with something that has one, or
take it away from that. Without a radius the field reaches 1 unit. Source: methods.md section 2.)";

  Value<Mode, Vec3> point{Vec3(0)};
  Value<Mode, Vec3> normal{Vec3(0, 1, 0)};
  Value<Mode, float> radius{0.f};
  Value<Mode, float> weight{1.f};
  DistanceFalloff falloff = DistanceFalloff::distance;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("point", &SdfPlane::point, "a point of the plane").in(Unit::length).required(),
        parameter("normal", &SdfPlane::normal, "the direction out of what is below; need not be a unit vector").nonzero(),
        parameter("radius", &SdfPlane::radius, k_reach_doc).in(Unit::length).at_least(0),
        parameter("weight", &SdfPlane::weight, k_distance_weight_doc),
        parameter("falloff", &SdfPlane::falloff, k_distance_falloff_doc),
    };
  }

  // Sampled:

  /// Operators find where it ends.
  static constexpr bool k_is_unbounded = true;

  /// All that there may ever be: large enough, and finite so that it can be moved and turned.
  Box3d solid_box() const { return {Vec3d(-1e9), Vec3d(1e9)}; }
  double inner_radius() const { return 1; }

  /// How far apart two states, and any two states interpolated between them, are where they meet a box.
  double displacement_from(const SdfPlane& other, const Box3d& box) const {
    const Vec3d a(point), b(other.point), e = AxisFrame{a, Vec3d(normal)}.e, f = AxisFrame{b, Vec3d(other.normal)}.e;
    const auto reach = [&](const Vec3d& from) { return glm::length(glm::max(glm::abs(box.lower - from), glm::abs(box.upper - from))); };
    // The opposite normal is another plane: what it turns past a right angle it turns entirely.
    const double turn = normal == other.normal ? 0 : glm::dot(e, f) > 0 ? glm::distance(e, f) : 2;
    return std::abs(glm::dot(b - a, e)) + turn * (glm::distance(a, b) + std::max(reach(a), reach(b)));
  }

  template <class Real>
  Real signed_distance(const Point3<Real>& p) const {
    const AxisFrame frame{Vec3d(point), Vec3d(normal)};
    return AxisFrame::along(frame.e, frame.relative(p));
  }
};

} // namespace kelpie
