#pragma once

#include <fmt/format.h>

#include "field/complex/detail.h"
#include "field/complex/sweep.h"
#include "field/skeletons/cone_sphere.h"
#include "field/skeletons/segment.h"

namespace kelpie {

template <class Mode>
struct GeneralizedCylinder {
  static constexpr std::string_view k_name = "generalized_cylinder";
  static constexpr std::string_view k_doc =
      R"(The potential around a generalized cylinder: a ball that changes its size on its way along a curve. Limbs, stalks, tentacles.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the solid, 0 inside it

The curve goes through its `points` (catmull_rom), or from the first to the last near the others (b_spline: cubic, its knots uniform and
clamped; bezier: one polynomial; cubic_beziers: points 1 to 4 make one piece, 4 to 7 the next, as drawing programs write paths).
`radii`, one for each point, follow the same rule, and are never below 0. Points and radii may move.

For each frame it becomes a union of `cone_sphere`s (of `segment`s where all radii are 0), with steps as long as its detail
allows: curve and radius are met within `detail`, in scene units, or else within `detail_pixels` pixels of the picture at the
nearest place of each stretch of the curve. Neighbours share a ball: no joint shows a bulge or a crack, and a `blend` above sees one
solid. Source: Barbier, Galin, Akkouche; methods.md section 2, complex primitives.)";

  std::vector<Value<Mode, Vec3>> points;
  std::vector<Value<Mode, float>> radii;
  SplineKind curve = SplineKind::catmull_rom;
  float detail = 0.f;
  float detail_pixels = 0.1f;
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};
  Expansion expansion;

  static constexpr auto parameters() {
    using G = GeneralizedCylinder;
    return std::tuple{
        parameter("points", &G::points, "the points of the curve; each may be animated").in(Unit::length).required(),
        parameter("radii", &G::radii, "of the solid at the points, each of which may be animated; a single one is for all, none is 0")
            .in(Unit::length)
            .at_least(0)
            .or_number_for_all(),
        parameter("curve", &G::curve, "how the points make a curve"),
        parameter("detail", &G::detail, "how far the pieces may be from the solid; 0: by `detail_pixels`")
            .in(Unit::length)
            .at_least(0)
            .alternative_to("detail_pixels"),
        parameter("detail_pixels", &G::detail_pixels, "the same in pixels, as the frame's camera sees it")
            .in(Unit::pixels)
            .above(0)
            .alternative_to("detail"),
        parameter("radius", &G::radius, "radius of influence, from the solid's surface: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &G::surface_radius, k_surface_radius_doc).in(Unit::length).above(0).alternative_to("radius").required(),
        parameter("weight", &G::weight, "the potential in the solid; negative carves"),
        parameter("falloff", &G::falloff, "how the potential decreases"),
    };
  }

  std::optional<ParameterProblem> problem() const {
    if (radii.size() > 1 && radii.size() != points.size())
      return ParameterProblem{
          "radii", fmt::format("radii: expected one, or as many as there are points ({}), found {}", points.size(), radii.size())};
    return problem_of_curve(curve, "points", points.size());
  }

  // Sampled:

  /// The steps of each span, then 2 if any radius is not 0.
  Divisions divisions() const {
    Divisions out;
    const Sweep curve_and_radius = sweep();
    for (int i = 0; i < curve_and_radius.spans(); ++i)
      out.push_back(divisions_for(curve_and_radius.bend(i), chord_error(detail, detail_pixels, expansion.pixels, curve_and_radius.box(i))));
    out.push_back(std::any_of(radii.begin(), radii.end(), [](float r) { return r > 0; }) ? 2 : 1);
    return out;
  }

  /// Calls emit(piece) for every piece.
  template <class Emit>
  void for_each_piece(const Divisions& divisions, Emit&& emit) const {
    const Sweep curve_and_radius = sweep();
    const bool is_thick = divisions.back() > 1;
    WidePoint from = wide_point(0);
    if (curve_and_radius.spans() == 0) emit_piece(from, from, is_thick, emit);
    for (int i = 0; i < curve_and_radius.spans(); ++i)
      for (uint32_t k = 1, n = divisions[size_t(i)]; k <= n; ++k) {
        const WidePoint to = curve_and_radius.at(i, k, n);
        emit_piece(from, to, is_thick, emit);
        from = to;
      }
  }

private:
  WidePoint wide_point(size_t i) const { return {Vec3d(points[i]), radii.empty() ? 0 : double(radii[std::min(i, radii.size() - 1)])}; }
  Sweep sweep() const {
    std::vector<WidePoint> wide;
    wide.reserve(points.size());
    for (size_t i = 0; i < points.size(); ++i) wide.push_back(wide_point(i));
    return {curve, std::move(wide)};
  }

  template <class Emit>
  void emit_piece(const WidePoint& a, const WidePoint& b, bool is_thick, Emit& emit) const {
    if (!is_thick) {
      Segment<SampledMode> s;
      s.from = Vec3(a), s.to = Vec3(b), s.radius = radius, s.weight = weight, s.falloff = falloff;
      return emit(s);
    }
    ConeSphere<SampledMode> s;
    s.from = Vec3(a), s.to = Vec3(b), s.radius = radius, s.weight = weight, s.falloff = falloff;
    s.from_radius = static_cast<float>(std::max(0.0, a.w)), s.to_radius = static_cast<float>(std::max(0.0, b.w));
    emit(s);
  }
};

} // namespace kelpie
