#pragma once

#include "field/potential/blob.h"
#include "field/skeletons/frame.h"

namespace kelpie {

template <class Mode>
struct Ellipsoid {
  static constexpr std::string_view k_name = "ellipsoid";
  static constexpr std::string_view k_doc = R"(An ellipsoidal blob: the potential around one point, in three half axes.

    f(p) = weight * falloff(|u|^2),   u the coordinates of p - centre along its half axes, each divided by its radius

It is a `point` that was scaled along three directions, and as fast: plates and rods that blend softly. The surface of a lone one at
threshold T is an ellipsoid of radii * s, where falloff(s^2) = T / weight: of weight 2 s is 0.454. A radius counts as at least a
thousandth of the largest. Source: methods.md section 1, clouds of blobs; the potential of a point below an affine warp.)";

  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, Vec3> radii{Vec3(1)};
  Value<Mode, Vec3> axis{Vec3(0, 1, 0)};
  Value<Mode, Vec3> across{Vec3(1, 0, 0)};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("centre", &Ellipsoid::centre, "the skeleton").in(Unit::length).required(),
        parameter(
            "radii", &Ellipsoid::radii,
            "radii of influence: across, along its axis, and perpendicular to both; or one number for all: beyond them the potential is 0")
            .in(Unit::length)
            .above(0)
            .or_number_for_all()
            .required(),
        parameter("axis", &Ellipsoid::axis, "direction of its second radius; need not be a unit vector").nonzero(),
        parameter("across", &Ellipsoid::across, "direction of its first radius; only what is perpendicular to `axis` counts").nonzero(),
        parameter("weight", &Ellipsoid::weight, "the potential at the centre; negative carves"),
        parameter("falloff", &Ellipsoid::falloff, "how the potential decreases"),
    };
  }

  // Sampled: a cloud of one, as a point is.
  void append_blobs(BlobCloud& out) const {
    const AxisFrame frame{Vec3d(0), Vec3d(axis), Vec3d(across)};
    const Vec3d r = glm::max(Vec3d(radii), double(std::max({radii.x, radii.y, radii.z})) / k_longest_blob);
    Blob blob{centre, 1, weight, falloff};
    if (set_ellipsoid(blob, glm::transpose(Mat3d(frame.u / r.x, frame.e / r.y, frame.v / r.z)))) out.push_back(blob);
  }
};

} // namespace kelpie
