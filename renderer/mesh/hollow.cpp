#include "renderer/mesh/hollow.h"

#include "field/mesh/orient.h"
#include "renderer/mesh/shell_solid.h"

namespace kelpie {

namespace {

/// A closed surface that faces inward.
struct Cavity {
  double volume = 0; ///< below 0
  Vec3d lowest{0, std::numeric_limits<double>::infinity(), 0};
};

std::vector<Cavity> cavities_of(const Mesh& mesh) {
  std::vector<Triangle> triangles = mesh.triangles;
  const Components components = orient_consistently(triangles);
  std::vector<Cavity> all(components.count);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    Cavity& c = all[components.of_triangle[i]];
    const auto& [a, b, d] = mesh.triangles[i];
    c.volume += glm::dot(mesh.positions[a], glm::cross(mesh.positions[b], mesh.positions[d])) / 6;
    for (const uint32_t corner : mesh.triangles[i])
      if (mesh.positions[corner].y < c.lowest.y) c.lowest = mesh.positions[corner];
  }
  std::erase_if(all, [](const Cavity& c) { return c.volume >= 0; });
  return all;
}

} // namespace

HollowMesh hollowed(const Solid& solid, const Mesh& surface, double wall, double drain_radius, double tolerance) {
  const TriangleTree tree(surface);
  HollowMesh out{mesh_solid(ShellSolid(solid, tree, wall, {}), tolerance)};
  const std::vector<Cavity> cavities = cavities_of(out.mesh);
  std::vector<DrainHole> holes;
  const double r = drain_radius;
  for (const Cavity& c : cavities)
    if (r > 0 && -c.volume > 8 * r * r * r) holes.push_back({c.lowest + Vec3d(0, r, 0), c.lowest - Vec3d(0, wall + r, 0), r});
  out.cavities = cavities.size(), out.holes = holes.size();
  if (!holes.empty()) out.mesh = mesh_solid(ShellSolid(solid, tree, wall, std::move(holes)), tolerance);
  return out;
}

} // namespace kelpie
