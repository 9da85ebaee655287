#pragma once

#include "base/kind.h"
#include "field/complex/detail.h"
#include "field/complex/subdivision_mesh.h"
#include "field/complex/thick_surface.h"

namespace kelpie {

template <class Mode>
struct Subdivision {
  static constexpr std::string_view k_name = "subdivision";
  static constexpr std::string_view k_doc =
      R"(The potential around a subdivision surface with varying thickness: a mesh file is the cage of a smooth surface.

    f(p) = weight * falloff(d(p)^2 / radius^2),   d the Euclidean distance to the solid, 0 inside it

The polygons of an OBJ, PLY, OFF or STL file are refined by the rule of Catmull and Clark. The surface need not be closed: borders are
round, and run through the corners of the cage. `thickness` lies half on either side; a PLY's vertices may have a property `thickness`,
by which it is multiplied, smoothed as the surface is.

For each frame it becomes a union of `polyhedron`s between places of the surface moved along their normals, and of `cone_sphere`s
along borders (of `triangle`s where the thickness is 0), of the first level that is within `detail` of the surface, in scene units,
or else within `detail_pixels` pixels of the picture at its nearest place. Neighbours have their corners in common: no joint shows
a bulge or a crack. Source: Barbier, Galin, Akkouche; methods.md section 2, complex primitives.)";

  typename Mode::File file;
  int levels = 4;
  Value<Mode, float> thickness{0.f};
  float detail = 0.f;
  float detail_pixels = 0.5f;
  Value<Mode, float> radius{1.f};
  Value<Mode, float> weight{k_default_weight};
  Falloff falloff = k_default_falloff;
  std::optional<Value<Mode, float>> surface_radius{};
  Expansion expansion;
  /// What `file` holds, refined; filled when the scene is built.
  std::shared_ptr<const SubdivisionMesh> mesh;

  static constexpr auto parameters() {
    using S = Subdivision;
    return std::tuple{
        parameter("file", &S::file, "the cage: an OBJ, PLY, OFF or STL file").required().such_as("mesh.obj"),
        parameter("levels", &S::levels, "it is refined so many times at most").at_least(1).at_most(8),
        parameter("thickness", &S::thickness, "of the surface, or a factor of the file's thickness").in(Unit::length).at_least(0),
        parameter("detail", &S::detail, "how far the pieces may be from the surface; 0: by `detail_pixels`")
            .in(Unit::length)
            .at_least(0)
            .alternative_to("detail_pixels"),
        parameter("detail_pixels", &S::detail_pixels, "the same in pixels, as the frame's camera sees it")
            .in(Unit::pixels)
            .above(0)
            .alternative_to("detail"),
        parameter("radius", &S::radius, "radius of influence, from the solid's surface: the potential is 0 beyond it")
            .in(Unit::length)
            .above(0)
            .alternative_to("surface_radius")
            .required(),
        parameter("surface_radius", &S::surface_radius, k_surface_radius_doc).in(Unit::length).above(0).alternative_to("radius").required(),
        parameter("weight", &S::weight, "the potential in the solid; negative carves"),
        parameter("falloff", &S::falloff, "how the potential decreases"),
    };
  }
  static constexpr auto assets() { return std::tuple{&Subdivision::mesh}; }

  // Sampled:

  /// The level, from 1 on, then 2 if there is a thickness.
  Divisions divisions() const {
    const double error = chord_error(detail, detail_pixels, expansion.pixels, mesh->box);
    uint32_t level = 1;
    while (level < mesh->levels.size() && mesh->levels[level - 1].error > error) ++level;
    return {level, thickness > 0 ? 2u : 1u};
  }

  /// Calls emit(piece) for every piece.
  template <class Emit>
  void for_each_piece(const Divisions& divisions, Emit&& emit) const {
    const SubdivisionMesh::Level& level = mesh->levels[divisions[0] - 1];
    SurfaceEmitter<Emit> surface{radius, weight, falloff, divisions[1] > 1, emit};
    const auto at = [&](uint32_t i) {
      return SurfacePoint{Vec3d(level.positions[i]), Vec3d(level.normals[i]), 0.5 * double(thickness) * double(level.thickness[i])};
    };
    for (const auto& f : level.faces) surface.face(std::array{at(f[0]), at(f[1]), at(f[2]), at(f[3])});
    for (const auto& b : level.borders) surface.border(at(b[0]), at(b[1]));
  }
};

} // namespace kelpie
