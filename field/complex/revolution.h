#pragma once

#include <fmt/format.h>

#include "field/complex/detail.h"
#include "field/complex/sweep.h"
#include "field/skeletons/hollow_cone.h"
#include "field/skeletons/torus.h"
#include "field/warps/affine.h"

namespace kelpie {

template <class Mode>
struct Revolution {
  static constexpr std::string_view k_name = "revolution";
  static constexpr std::string_view k_doc =
      R"(The potential around a surface of revolution with varying thickness: vases, bowls, bells, wheels.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the solid, 0 inside it

A disc that changes its size runs along a curve in the half plane beside the axis, and the whole is turned about it. Each point of
`profile` is [distance from the axis, height along it, thickness]; `curve` is as for a `generalized_cylinder`, and thickness follows
the same rule, never below 0. What would reach past the axis ends there. The points may move.

For each frame it becomes a union of `hollow_cone`s joined by `torus`es (hollow cones alone where the thickness is 0), with steps as
long as its detail allows: profile and thickness are met within `detail`, in scene units, or else within `detail_pixels` pixels
of the picture at the nearest place of each stretch of the profile. Cones touch the tori that they join: no joint shows a bulge or
a crack. Source: Barbier, Galin, Akkouche; methods.md section 2, complex primitives.)";

  std::vector<Value<Mode, Vec3>> profile;
  SplineKind curve = SplineKind::catmull_rom;
  Value<Mode, Vec3> centre{Vec3(0)};
  Value<Mode, Vec3> axis{Vec3(0, 1, 0)};
  float detail = 0.f;
  float detail_pixels = 0.1f;
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};
  Expansion expansion;

  static constexpr auto parameters() {
    using R = Revolution;
    return std::tuple{
        parameter("profile", &R::profile, "[distance from the axis, height, thickness] of each point; each may be animated")
            .in(Unit::length)
            .required(),
        parameter("curve", &R::curve, "how the points make a curve"),
        parameter("centre", &R::centre, "the place on the axis at height 0").in(Unit::length),
        parameter("axis", &R::axis, "the direction of height; need not be a unit vector").nonzero(),
        parameter("detail", &R::detail, "how far the pieces may be from the solid; 0: by `detail_pixels`")
            .in(Unit::length)
            .at_least(0)
            .alternative_to("detail_pixels"),
        parameter("detail_pixels", &R::detail_pixels, "the same in pixels, as the frame's camera sees it")
            .in(Unit::pixels)
            .above(0)
            .alternative_to("detail"),
        parameter("radius", &R::radius, "radius of influence, from the solid's surface: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &R::surface_radius, k_surface_radius_doc).in(Unit::length).above(0).alternative_to("radius").required(),
        parameter("weight", &R::weight, "the potential in the solid; negative carves"),
        parameter("falloff", &R::falloff, "how the potential decreases"),
    };
  }

  std::optional<ParameterProblem> problem() const {
    for (size_t i = 0; i < profile.size(); ++i) {
      std::vector<Vec3> values;
      if constexpr (std::is_same_v<Mode, AnimatedMode>) {
        values.push_back(profile[i].at(0));
        for (const double frame : profile[i].frames()) values.push_back(profile[i].at(frame));
      }
      for (const Vec3& p : values)
        if (p.x < 0 || p.z < 0)
          return ParameterProblem{"profile", fmt::format("profile: the {} of point {} must be >= 0, found {}",
                                                         p.x < 0 ? "distance from the axis" : "thickness", i + 1, p.x < 0 ? p.x : p.z)};
    }
    return problem_of_curve(curve, "profile", profile.size());
  }

  // Sampled:

  /// The steps of each span, then 2 if any thickness is not 0.
  Divisions divisions() const {
    Divisions out;
    const AxisFrame frame{Vec3d(centre), Vec3d(axis)};
    const Sweep section = sweep();
    for (int i = 0; i < section.spans(); ++i) {
      const Box3d half_plane = section.box(i);
      const Vec3d across = glm::sqrt(glm::max(Vec3d(0), 1.0 - frame.e * frame.e)) * half_plane.upper.x;
      Box3d box;
      for (const double height : {half_plane.lower.y, half_plane.upper.y}) {
        const Vec3d at = frame.origin + frame.e * height;
        box.extend(Box3d{at - across, at + across});
      }
      out.push_back(divisions_for(section.bend(i), chord_error(detail, detail_pixels, expansion.pixels, box)));
    }
    out.push_back(std::any_of(profile.begin(), profile.end(), [](const Vec3& p) { return p.z > 0; }) ? 2 : 1);
    return out;
  }

  /// Pieces stand around the y axis: there is one frame for all, and rings that are level have their axis.
  Affine parent_from_pieces() const {
    const AxisFrame frame{Vec3d(centre), Vec3d(axis)};
    return {{frame.v, frame.e, frame.u}, frame.origin};
  }

  /// Calls emit(piece) for every piece.
  template <class Emit>
  void for_each_piece(const Divisions& divisions, Emit&& emit) const {
    const Sweep section = sweep();
    const bool is_thick = divisions.back() > 1;
    WidePoint from = wide_point(0);
    if (is_thick || section.spans() == 0) emit(ring(from));
    for (int i = 0; i < section.spans(); ++i)
      for (uint32_t k = 1, n = divisions[size_t(i)]; k <= n; ++k) {
        const WidePoint to = above_axis(section.at(i, k, n));
        emit(wall(from, to));
        if (is_thick) emit(ring(to));
        from = to;
      }
  }

private:
  /// x: the distance from the axis, y: the height, w: half the thickness.
  WidePoint wide_point(size_t i) const { return above_axis({profile[i].x, profile[i].y, 0, 0.5 * double(profile[i].z)}); }
  static WidePoint above_axis(const WidePoint& p) { return {std::max(0.0, p.x), p.y, 0, std::max(0.0, p.w)}; }
  Sweep sweep() const {
    std::vector<WidePoint> wide;
    wide.reserve(profile.size());
    for (size_t i = 0; i < profile.size(); ++i) wide.push_back(wide_point(i));
    return {curve, std::move(wide)};
  }

  template <class Piece>
  Piece with_potential(Piece piece) const {
    piece.radius = radius, piece.weight = weight, piece.falloff = falloff;
    return piece;
  }
  Torus<SampledMode> ring(const WidePoint& p) const {
    Torus<SampledMode> t;
    t.centre = Vec3(0, p.y, 0), t.major_radius = static_cast<float>(p.x), t.minor_radius = static_cast<float>(p.w);
    return with_potential(t);
  }
  /// What lies between the places where two discs touch their common tangents: so the wall touches both rings. If one disc
  /// contains the other that is all there is, and the wall a circle in it.
  HollowCone<SampledMode> wall(const WidePoint& a, const WidePoint& b) const {
    const double length = glm::distance(Vec2d(a), Vec2d(b)), difference = a.w - b.w;
    const bool is_apart = length > std::abs(difference);
    const double sine = is_apart ? difference / length : 0, cosine = is_apart ? std::sqrt((1 - sine) * (1 + sine)) : 0;
    const Vec2d along = is_apart ? Vec2d(b - a) * (sine / length) : Vec2d(0);
    const Vec2d from = Vec2d(a) + along * a.w, to = is_apart ? Vec2d(b) + along * b.w : from;
    HollowCone<SampledMode> w;
    w.from = Vec3(0, from.y, 0), w.to = Vec3(0, to.y, 0);
    w.from_radius = static_cast<float>(from.x), w.to_radius = static_cast<float>(to.x);
    w.from_thickness = static_cast<float>(2 * a.w * cosine), w.to_thickness = static_cast<float>(2 * b.w * cosine);
    return with_potential(w);
  }
};

} // namespace kelpie
