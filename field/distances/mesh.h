#pragma once

#include <compare>
#include <limits>
#include <memory>

#include "field/distances/distance_field.h"
#include "field/distances/far_distances.h"
#include "field/mesh/mesh.h"

namespace kelpie {

/// How a mesh is sampled.
struct MeshSampling {
  double voxel = 0;  ///< the size of voxels; 0: a 128th of the mesh's longest side
  double reach = 0;  ///< how far the field is asked to reach at least; 0: as it comes
  double weld = 0;   ///< as in MeshOptions
  double crease = 0; ///< facets that meet at less are smooth (curved_mesh); 0: all stay
  auto operator<=>(const MeshSampling&) const = default;
};

/// The distances of a mesh file, in the file's own coordinates. What is inside is decided by the mesh as it was read: holes stay open.
/// Kept in the cache, if that is to be used. Throws Error: as load_mesh, and bad_data where the voxels would be too many.
std::shared_ptr<const DistanceGrid> load_distance_grid(const std::string& path, MeshSampling, bool use_cache, Diagnostics&);

/// The same for a mesh at hand.
DistanceGrid make_distance_grid(const Mesh&, double voxel, double band);

template <class Mode>
struct SdfMesh : DistanceField<SdfMesh<Mode>> {
  static constexpr std::string_view k_name = "sdf_mesh";
  static constexpr std::string_view k_doc = R"(A triangle mesh as a solid, by its signed distance: hard, for Booleans and blends.

    f = weight T clamp(1 - d / radius, 0, 2),   d the signed distance, T the threshold of the shape

OBJ, PLY, OFF or STL, in its own units; `scale`, `rotate` and `translate` place it. Inside is where the mesh winds around a place by
more than a half (the generalised winding number), so it need not be closed: over holes the surface is what would close them best.
Seams whose vertices differ by rounding are welded. A closed part that faces inward is turned, with what lies in it; open ones are not.
The distance is sampled on a lattice and is smooth between its places (a cubic B-spline): no voxels show in mirrors, details smaller than
two of them are lost, and edges are rounded by about one. Facets show as they are, unless `crease` says up to which angle they are
meant to be smooth. The first time takes seconds. With another falloff it is a soft skeleton. Source: methods.md section 2; Jacobson, Kavan and
Sorkine-Hornung 2013, Barill et al. 2018 (winding numbers).)";

  typename Mode::File file;
  double voxel = 0;
  double weld = 0;
  double crease = 0;
  Value<Mode, float> radius{0.f};
  Value<Mode, float> weight{1.f};
  DistanceFalloff falloff = DistanceFalloff::distance;

  std::shared_ptr<const DistanceGrid> grid; ///< filled by the reader
  std::shared_ptr<const FarDistances> far;  ///< of a field that is to reach farther than the grid (morph/open_distances.h)

  static constexpr auto parameters() {
    return std::tuple{
        parameter("file", &SdfMesh::file, "the mesh").such_as("mesh.obj").required(),
        parameter("voxel", &SdfMesh::voxel, "the size of the lattice's voxels; 0: a 128th of the mesh's longest side")
            .in(Unit::length)
            .at_least(0),
        parameter("weld", &SdfMesh::weld, k_weld_doc).in(Unit::length).at_least(0),
        parameter("crease", &SdfMesh::crease,
                  "triangles that meet at less than this are one smooth surface, which bulges as their mean normals say; 0: facets stay")
            .in(Unit::degrees)
            .at_least(0)
            .at_most(180),
        parameter("radius", &SdfMesh::radius, "how far from the surface the field reaches; 0: four voxels").in(Unit::length).at_least(0),
        parameter("weight", &SdfMesh::weight, k_distance_weight_doc),
        parameter("falloff", &SdfMesh::falloff, k_distance_falloff_doc),
    };
  }
  static constexpr auto assets() { return std::tuple{&SdfMesh::grid}; }

  // Sampled:

  Box3 support() const { return rounded_outward(far ? grid->box().padded(reach()) : grid->box()); }
  Box3d solid_box() const { return grid->box(); }
  double reach() const { return radius > 0 ? std::min(double(radius), most_reach()) : grid->band(); }
  double most_reach() const { return far ? std::numeric_limits<double>::infinity() : grid->band(); }
  /// Cells need not be much smaller.
  double feature_size() const { return 4 * grid->voxel(); }

  /// The surface stands: it is warps that move it.
  double displacement_from(const SdfMesh&) const { return 0; }

  template <class Real>
  Real signed_distance(const Point3<Real>& p) const {
    const Real near = distance_in(*grid, p);
    return far ? far->extend(near, p) : near;
  }
};

} // namespace kelpie
