#pragma once

#include <fmt/format.h>

#include "field/complex/bezier_patch.h"
#include "field/complex/detail.h"

namespace kelpie {

template <class Mode>
struct Patch {
  static constexpr std::string_view k_name = "patch";
  static constexpr std::string_view k_doc =
      R"(The potential around curved surface patches with varying thickness: leaves, fins, wings, sails.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the solid, 0 inside it

A patch is a bicubic Bezier surface of 4 rows of 4 control points; several patches follow one another. `thickness`, one for each control
point, follows the same rule, is never below 0, and lies half on either side. Borders are round. Patches that share a border have
the same four points there. Points and thickness may move.

For each frame it becomes a union of `polyhedron`s between places of the surface moved along their normals, and of `cone_sphere`s
along borders and creases (of `triangle`s where the thickness is 0), as many as its detail asks for: the middle surface and the thickness
are met within `detail`, in scene units, or else within `detail_pixels` pixels of the picture at the patches' nearest place.
Neighbours have their corners in common: no joint shows a bulge or a crack. Source: Barbier, Galin, Akkouche; methods.md section 2,
complex primitives.)";

  std::vector<Value<Mode, Vec3>> points;
  std::vector<Value<Mode, float>> thickness;
  float detail = 0.f;
  float detail_pixels = 0.5f;
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};
  Expansion expansion;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("points", &Patch::points, "16 control points for each patch, row after row; each may be animated")
            .in(Unit::length)
            .required()
            .such_as("[[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [0, 0, 1], [1, 0, 1], [2, 0, 1], [3, 0, 1], "
                     "[0, 0, 2], [1, 0, 2], [2, 0, 2], [3, 0, 2], [0, 0, 3], [1, 0, 3], [2, 0, 3], [3, 0, 3]]"),
        parameter("thickness", &Patch::thickness,
                  "at the control points, each of which may be animated; a single one is for all, none is 0")
            .in(Unit::length)
            .at_least(0)
            .or_number_for_all(),
        parameter("detail", &Patch::detail, "how far the pieces may be from the surface; 0: by `detail_pixels`")
            .in(Unit::length)
            .at_least(0)
            .alternative_to("detail_pixels"),
        parameter("detail_pixels", &Patch::detail_pixels, "the same in pixels, as the frame's camera sees it")
            .in(Unit::pixels)
            .above(0)
            .alternative_to("detail"),
        parameter("radius", &Patch::radius, "radius of influence, from the solid's surface: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &Patch::surface_radius, k_surface_radius_doc)
            .in(Unit::length)
            .above(0)
            .alternative_to("radius")
            .required(),
        parameter("weight", &Patch::weight, "the potential in the solid; negative carves"),
        parameter("falloff", &Patch::falloff, "how the potential decreases"),
    };
  }

  std::optional<ParameterProblem> problem() const {
    if (points.size() % BezierPatch::k_points != 0)
      return ParameterProblem{"points", fmt::format("points: a patch has 16 control points, found {}{}", points.size(),
                                                    points.size() > 16 ? ", which are not 16 for each of several" : "")};
    if (thickness.size() > 1 && thickness.size() != points.size())
      return ParameterProblem{"thickness", fmt::format("thickness: expected one, or as many as there are points ({}), found {}",
                                                       points.size(), thickness.size())};
    return {};
  }

  // Sampled:

  /// The steps by u and by v of all patches, so that neighbours meet; then 2 if any thickness is not 0; then 2 for every side that is
  /// round.
  Divisions divisions() const {
    const std::vector<BezierPatch> all = patches();
    Divisions out{1, 1, std::any_of(thickness.begin(), thickness.end(), [](float t) { return t > 0; }) ? 2u : 1u};
    for (const BezierPatch& p : all) {
      // Apart by at most (uu / n^2 + 2 uv / (n m) + vv / m^2) / 8, and 2 / (n m) <= 1 / n^2 + 1 / m^2.
      const BezierPatch::Bends bends = p.bends();
      const double error = 0.5 * chord_error(detail, detail_pixels, expansion.pixels, p.box());
      out[0] = std::max(out[0], divisions_for(bends.uu + bends.uv, error));
      out[1] = std::max(out[1], divisions_for(bends.vv + bends.uv, error));
    }
    if (all.size() > 1) out[0] = out[1] = std::max(out[0], out[1]); // u of one may be v of its neighbour
    for (size_t i = 0; i < all.size(); ++i)
      for (int side = 0; side < BezierPatch::k_sides; ++side) out.push_back(is_round(all, i, BezierPatch::Side(side)) ? 2 : 1);
    return out;
  }

  /// Calls emit(piece) for every piece.
  template <class Emit>
  void for_each_piece(const Divisions& divisions, Emit&& emit) const {
    const uint32_t columns = divisions[0], rows = divisions[1];
    SurfaceEmitter<Emit> surface{radius, weight, falloff, divisions[2] > 1, emit};
    std::vector<SurfacePoint> grid;
    const auto corner = [&](uint32_t i, uint32_t j) -> const SurfacePoint& { return grid[j * (columns + 1) + i]; };
    size_t side = 3;
    for (const BezierPatch& patch : patches()) {
      grid.clear();
      for (uint32_t j = 0; j <= rows; ++j)
        for (uint32_t i = 0; i <= columns; ++i) grid.push_back(patch.at(double(i) / columns, double(j) / rows));
      for (uint32_t j = 0; j < rows; ++j)
        for (uint32_t i = 0; i < columns; ++i)
          surface.face(std::array{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)});
      for (const uint32_t j : {0u, rows})
        for (uint32_t i = 0; i < columns && divisions[side + (j > 0)] > 1; ++i) surface.border(corner(i, j), corner(i + 1, j));
      for (const uint32_t i : {0u, columns})
        for (uint32_t j = 0; j < rows && divisions[side + 2 + (i > 0)] > 1; ++j) surface.border(corner(i, j), corner(i, j + 1));
      side += BezierPatch::k_sides;
    }
  }

private:
  std::vector<BezierPatch> patches() const {
    std::vector<BezierPatch> all;
    std::array<glm::dvec4, BezierPatch::k_points> control;
    for (size_t first = 0; first + control.size() <= points.size(); first += control.size()) {
      for (size_t i = 0; i < control.size(); ++i) {
        const double t = thickness.empty() ? 0 : double(thickness[std::min(first + i, thickness.size() - 1)]);
        control[i] = glm::dvec4(Vec3d(points[first + i]), 0.5 * t);
      }
      all.emplace_back(control);
    }
    return all;
  }
  static bool is_round(const std::vector<BezierPatch>& all, size_t patch, BezierPatch::Side side) {
    for (size_t i = 0; i < all.size(); ++i)
      for (int other = 0; other < BezierPatch::k_sides; ++other)
        if ((i != patch || other != side) && is_smooth(all[patch], side, all[i], BezierPatch::Side(other))) return false;
    return true;
  }
};

} // namespace kelpie
