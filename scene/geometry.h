// Ordinary geometry: set dressing that is not a field.
#pragma once

#include "base/kind.h"
#include "base/vec.h"
#include "field/mesh/surface.h"
#include "field/warps/affine.h"

namespace kelpie {

template <class Mode>
struct Plane {
  static constexpr std::string_view k_name = "plane";
  static constexpr std::string_view k_doc = "An infinite plane, to stand things on.";

  Value<Mode, Vec3> position{Vec3(0)};
  Value<Mode, Vec3> normal{Vec3(0, 1, 0)};

  static constexpr auto parameters() {
    return std::tuple{
        parameter("position", &Plane::position, "a point of the plane").in(Unit::length),
        parameter("normal", &Plane::normal, "its upper side; need not be a unit vector").nonzero(),
    };
  }
};

template <class Mode>
struct TriangleMesh {
  static constexpr std::string_view k_name = "mesh";
  static constexpr std::string_view k_doc =
      R"(A triangle mesh from an OBJ, PLY, OFF or STL file, to stand among the shapes. Both sides are seen.

A point p of the file is at position + rotation(scale * p). The mesh need not be closed, and is shown as it is; edges
sharper than `crease` stay edges, all others are smooth.)";

  typename Mode::File file;
  Value<Mode, Vec3> position{Vec3(0)};
  Value<Mode, Vec3> axis{Vec3(0, 1, 0)};
  Value<Mode, float> angle{0.f};
  Value<Mode, Vec3> scale{Vec3(1)};
  float crease = 30;
  double weld = 0;
  /// What `file` holds; filled when the scene is built.
  std::shared_ptr<const SurfaceMesh> mesh;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("file", &TriangleMesh::file, "an OBJ, PLY, OFF or STL file").required().such_as("mesh.obj"),
        parameter("position", &TriangleMesh::position, "where the file's origin goes").in(Unit::length),
        parameter("axis", &TriangleMesh::axis, "direction of the axis that it is turned about; need not be a unit vector").nonzero(),
        parameter("angle", &TriangleMesh::angle, "how far it is turned, right-handed").in(Unit::degrees),
        parameter("scale", &TriangleMesh::scale, "a factor for each axis of the file, or one for all; a negative one mirrors")
            .other_than_zero()
            .or_number_for_all(),
        parameter("crease", &TriangleMesh::crease, "triangles that meet at a larger angle keep an edge between them; 0: flat facets")
            .in(Unit::degrees)
            .at_least(0)
            .at_most(180),
        parameter("weld", &TriangleMesh::weld, k_weld_doc).in(Unit::length).at_least(0),
    };
  }
  static constexpr auto assets() { return std::tuple{&TriangleMesh::mesh}; }

  // Sampled:
  Affine world_from_file() const { return placement(position, axis, angle, scale); }
};

using GeometryKinds = KindList<Plane, TriangleMesh>;

} // namespace kelpie
