#include "renderer/mesh/mesh_frame.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "base/error.h"
#include "field/mesh/orient.h"
#include "renderer/mesh/hollow.h"
#include "renderer/mesh/mesh_solid.h"
#include "renderer/mesh/simplify.h"
#include "renderer/mesh/vertex_colours.h"

namespace kelpie {

namespace {

constexpr double k_mm_per_metre = 1000;
constexpr double k_default_tolerance = 1e-3; ///< of the longest side
constexpr double k_least_tolerance = 5e-5;   ///< the same; octrees permit a third of it
/// The box of the surface is known only so well before there is a mesh.
constexpr double k_box_error = 0.97;

/// A shape on its way to an object.
struct ShapeSolid {
  std::unique_ptr<FieldProgram> program; ///< with identities
  std::unique_ptr<FieldSolid> solid;
};

ShapeSolid solid_of(const SampledShape& shape) {
  ShapeSolid out;
  out.program = std::make_unique<FieldProgram>(compile(shape.field, shape.threshold, {.with_identities = true}));
  try {
    out.solid = std::make_unique<FieldSolid>(*out.program);
  } catch (const Error& e) {
    throw Error(e.status, fmt::format("shape \"{}\": {}", shape.name, e.what()));
  }
  return out;
}

double longest_side(const Box3d& box) {
  const Vec3d extent = box.extent();
  return std::max({extent.x, extent.y, extent.z});
}

/// Leaves out connected surfaces of less volume than a cube of this side: flakes of chance where two surfaces touch.
Mesh without_specks(const Mesh& mesh, double smallest) {
  std::vector<Triangle> triangles = mesh.triangles;
  const Components components = orient_consistently(triangles);
  std::vector<double> volumes(components.count);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    volumes[components.of_triangle[i]] += glm::dot(mesh.positions[a], glm::cross(mesh.positions[b], mesh.positions[c])) / 6;
  }
  Mesh out;
  std::vector<uint32_t> places(mesh.positions.size(), ~0u);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (std::abs(volumes[components.of_triangle[i]]) < smallest * smallest * smallest) continue;
    for (const uint32_t corner : mesh.triangles[i])
      if (places[corner] == ~0u)
        places[corner] = static_cast<uint32_t>(out.positions.size()), out.positions.push_back(mesh.positions[corner]);
    const auto& [a, b, c] = mesh.triangles[i];
    out.triangles.push_back({places[a], places[b], places[c]});
  }
  return out;
}

/// From places of the scene to those of the file.
struct Placement {
  double scale;
  UpAxis up;
  Vec3d offset{0};

  Vec3d operator()(const Vec3d& p) const { return offset + scale * (up == UpAxis::z ? Vec3d(p.x, -p.z, p.y) : p); }
  Vec3d scene_place(const Vec3d& of_file) const {
    const Vec3d p = (of_file - offset) / scale;
    return up == UpAxis::z ? Vec3d(p.x, p.z, -p.y) : p;
  }
};

Box3d box_of(const std::vector<Mesh>& meshes) {
  Box3d box;
  for (const Mesh& mesh : meshes) box.extend(bounding_box(mesh));
  return box;
}

Placement placement_of(const std::vector<Mesh>& meshes, const MeshFrameOptions& options) {
  const Box3d box = box_of(meshes);
  Placement out{options.size ? *options.size / longest_side(box) : options.units * k_mm_per_metre, options.up};
  if (options.up == UpAxis::z) {
    Box3d placed;
    placed.extend(out(box.lower)), placed.extend(out(box.upper));
    out.offset = -placed.lower;
  }
  return out;
}

class FrameMesher {
public:
  FrameMesher(const FrameScene& frame, std::span<const size_t> shapes, const MeshFrameOptions& options)
      : frame_(frame), shapes_(shapes), options_(options) {}

  MeshedFrame run() {
    Box3d bounds;
    for (const size_t shape : shapes_) {
      out_.objects.push_back({frame_.shapes[shape].name, {}, {}});
      solids_.push_back(solid_of(frame_.shapes[shape]));
      bounds.extend(solids_.back().solid->bounds());
    }
    if (bounds.is_empty()) return std::move(out_);
    const double longest = longest_side(bounds), mm = options_.size ? *options_.size / longest : options_.units * k_mm_per_metre;
    out_.tolerance = options_.tolerance.value_or(k_default_tolerance * longest * mm);
    if (out_.tolerance < k_least_tolerance * longest * mm)
      throw Error(ExitStatus::bad_data, fmt::format("a tolerance of {:.2g} mm is too fine for a size of {:.4g} mm: at least {:.2g} mm",
                                                    out_.tolerance, longest * mm, k_least_tolerance * longest * mm));
    mesh_solids(mm);
    if (triangles_ > 0) finish();
    return std::move(out_);
  }

private:
  /// Of the tolerance, for each step that takes some of it: meshing, hollowing, simplifying.
  double share() const { return options_.shell ? 1.0 / 3 : 0.5; }

  void advance() { options_.progress(double(++done_) / double(2 * shapes_.size())); }

  void mesh_solids(double mm) {
    const double tolerance = k_box_error * share() * out_.tolerance / mm;
    for (size_t i = 0; i < solids_.size(); ++i) {
      Mesh mesh = without_specks(mesh_solid(*solids_[i].solid, tolerance), out_.tolerance / mm);
      if (options_.shell && !mesh.triangles.empty()) {
        HollowMesh hollow = hollowed(*solids_[i].solid, mesh, *options_.shell / mm, options_.drain / 2 / mm, tolerance);
        if (hollow.cavities == 0)
          out_.too_thin_to_hollow.push_back(out_.objects[i].name);
        else
          mesh = without_specks(hollow.mesh, out_.tolerance / mm);
      }
      triangles_ += mesh.triangles.size();
      meshes_.push_back(std::move(mesh));
      advance();
    }
  }

  void finish() {
    const Placement placement = placement_of(meshes_, options_);
    Box3d placed;
    for (Mesh& mesh : meshes_)
      for (Vec3d& p : mesh.positions) p = placement(p), placed.extend(p);
    out_.lattice = ExactLattice(placed);
    for (size_t i = 0; i < meshes_.size(); ++i) {
      if (!meshes_[i].triangles.empty()) finish(i, placement);
      meshes_[i] = {};
      advance();
    }
  }

  void finish(size_t i, const Placement& placement) {
    Mesh& mesh = meshes_[i];
    for (Vec3d& p : mesh.positions) p = out_.lattice.snapped(p);
    SimplifyOptions how{share() * out_.tolerance};
    if (options_.most_triangles < triangles_)
      how.most_triangles = size_t(double(options_.most_triangles) / double(triangles_) * double(mesh.triangles.size()));
    MeshObject& object = out_.objects[i];
    object.mesh = simplified(mesh, out_.lattice, how);
    std::vector<Vec3d> places;
    for (const Vec3d& p : object.mesh.positions) places.push_back(placement.scene_place(p));
    object.colours = colours_at(frame_, frame_.shapes[shapes_[i]], *solids_[i].program, places);
  }

  const FrameScene& frame_;
  std::span<const size_t> shapes_;
  const MeshFrameOptions& options_;
  std::vector<ShapeSolid> solids_;
  std::vector<Mesh> meshes_;
  size_t triangles_ = 0, done_ = 0;
  MeshedFrame out_;
};

} // namespace

MeshedFrame mesh_frame(const FrameScene& frame, std::span<const size_t> shapes, const MeshFrameOptions& options) {
  return FrameMesher(frame, shapes, options).run();
}

} // namespace kelpie
