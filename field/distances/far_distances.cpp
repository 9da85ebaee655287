#include "field/distances/far_distances.h"

#include <algorithm>
#include <cmath>

#include "base/point_index.h"

namespace kelpie {

namespace {

/// Coarse voxels, in voxels of the grid near the surface; and how far the coarse lattice reaches, in longest sides of its box.
constexpr double k_coarseness = 4, k_coarse_reach = 0.5;

/// Places of the surface of a grid, about a voxel apart.
std::vector<Vec3d> surface_places(const DistanceGrid& grid) {
  std::vector<Vec3d> places;
  const std::array<int, 3> count = grid.sample_count();
  for (int z = 0; z < count[2]; ++z)
    for (int y = 0; y < count[1]; ++y)
      for (int x = 0; x < count[0]; ++x) {
        if (!(std::abs(grid.sample({x, y, z})) < grid.voxel())) continue;
        const Vec3d p = grid.box().lower + grid.voxel() * Vec3d(x, y, z);
        const GridValue<double> at = grid.at(Point3<double>{p.x, p.y, p.z});
        const Vec3d slope(at.slopes[0], at.slopes[1], at.slopes[2]);
        if (const double steepness = glm::dot(slope, slope); steepness > 0.1) places.push_back(p - slope * (at.value / steepness));
      }
  return places;
}

DistanceGrid coarse_grid(const DistanceGrid& near) {
  const std::vector<Vec3d> surface = surface_places(near);
  const PointIndex<Vec3d> index(surface);
  const Vec3d extent = near.box().extent();
  const double band = k_coarse_reach * std::max({extent.x, extent.y, extent.z});
  return {near.box().padded(band), k_coarseness * near.voxel(), band, [&](const Vec3d& p, double most) {
            const double distance = surface.empty() ? most : glm::distance(p, surface[index.nearest(p)]);
            return std::copysign(distance, near.at(Point3<double>{p.x, p.y, p.z}).value);
          }};
}

} // namespace

FarDistances::FarDistances(const DistanceGrid& near) : band_(near.band()), coarse_(coarse_grid(near)) {}

} // namespace kelpie
