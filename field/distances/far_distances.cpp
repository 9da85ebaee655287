#include "field/distances/far_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nanoflann.hpp>

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

class NearestPlace {
public:
  explicit NearestPlace(std::vector<Vec3d> places) : places_(std::move(places)), tree_(3, places_) { tree_.buildIndex(); }

  double distance(const Vec3d& p) const {
    if (places_.list.empty()) return std::numeric_limits<double>::infinity();
    size_t index = 0;
    double squared = 0;
    tree_.knnSearch(&p.x, 1, &index, &squared);
    return std::sqrt(squared);
  }

private:
  struct Places {
    std::vector<Vec3d> list;
    Places(std::vector<Vec3d> l) : list(std::move(l)) {} // NOLINT: a list of places is places
    size_t kdtree_get_point_count() const { return list.size(); }
    double kdtree_get_pt(size_t i, size_t axis) const { return list[i][int(axis)]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  Places places_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Places>, Places, 3, size_t> tree_;
};

DistanceGrid coarse_grid(const DistanceGrid& near) {
  const auto surface = std::make_shared<const NearestPlace>(surface_places(near));
  const Vec3d extent = near.box().extent();
  const double band = k_coarse_reach * std::max({extent.x, extent.y, extent.z});
  return {near.box().padded(band), k_coarseness * near.voxel(), band, [&near, surface](const Vec3d& p, double) {
            return std::copysign(surface->distance(p), near.at(Point3<double>{p.x, p.y, p.z}).value);
          }};
}

} // namespace

FarDistances::FarDistances(const DistanceGrid& near) : band_(near.band()), coarse_(coarse_grid(near)) {}

} // namespace kelpie
