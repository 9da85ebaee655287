#include "field/distances/mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <xxhash.h>

#include "base/cache.h"
#include "base/file_bytes.h"
#include "field/mesh/curved.h"
#include "field/mesh/triangle_tree.h"

namespace kelpie {

namespace {

/// The size of the facets that stand for a smooth surface.
constexpr double k_facet_voxels = 1.5;

constexpr double k_default_voxels = 128, k_most_voxels = 1024, k_band_voxels = 4;

/// Raise it whenever the same mesh yields other distances.
constexpr int k_revision = 3;

std::string cache_key(const std::string& bytes, const MeshSampling& how, double band) {
  const XXH128_hash_t content = XXH3_128bits(bytes.data(), bytes.size());
  const std::string all = fmt::format("{:016x}{:016x} {} {} {} {} {} {}", content.high64, content.low64, how.voxel, band, how.weld,
                                      how.crease, k_revision, KELPIE_VERSION);
  const XXH128_hash_t key = XXH3_128bits(all.data(), all.size());
  return fmt::format("distance-{:016x}{:016x}", key.high64, key.low64);
}

/// The signed distance of a mesh, from place to neighbouring place.
class MeshDistance {
public:
  MeshDistance(const TriangleTree& tree, const Mesh& mesh) : tree_(&tree), origin_(mesh.origin), is_closed_(is_closed(mesh)) {}

  double operator()(const Vec3d& place, double most) {
    const Vec3d p = place - origin_;
    const double way = glm::distance(p, last_);
    // The nearest triangle is no farther than the last place's by more than the way from there.
    const double distance = tree_->distance(p, std::min(most, last_distance_ + way));
    // A closed mesh winds equally often around all places of a ball that it does not enter.
    if (!(is_closed_ && way < last_distance_ && std::isfinite(last_distance_))) side_ = side(p);
    last_ = p, last_distance_ = distance;
    return distance * side_;
  }

private:
  /// From 1 outside to -1 inside; near a triangle it jumps, across a hole it passes through 0 where the mesh winds by a half.
  double side(const Vec3d& p) const { return std::clamp(2 * (1 - 2 * tree_->winding(p)), -1.0, 1.0); }

  const TriangleTree* tree_;
  Vec3d origin_;
  bool is_closed_;
  Vec3d last_{0};
  double last_distance_ = std::numeric_limits<double>::infinity(), side_ = 1;
};

} // namespace

DistanceGrid make_distance_grid(const Mesh& mesh, double voxel, double band) {
  const TriangleTree tree(mesh);
  const Box3d box = bounding_box(mesh);
  return {Box3d{box.lower + mesh.origin, box.upper + mesh.origin}.padded(band), voxel, band, MeshDistance(tree, mesh)};
}

std::shared_ptr<const DistanceGrid> load_distance_grid(const std::string& path, MeshSampling how, bool use_cache,
                                                       Diagnostics& diagnostics) {
  const std::string bytes = read_file_bytes(path);
  const Mesh mesh = parse_mesh(bytes, path, diagnostics, {how.weld, false}); // its warnings are due every time
  const Vec3d extent = bounding_box(mesh).extent();
  const double longest = std::max({extent.x, extent.y, extent.z});
  if (!(how.voxel > 0)) how.voxel = longest / k_default_voxels;
  const double band = std::max(how.reach, k_band_voxels * how.voxel), along = (longest + 2 * band) / how.voxel;
  if (!(along <= k_most_voxels))
    throw Error(ExitStatus::bad_data, fmt::format("{}: {:.0f} voxels along the mesh are too many (at most {:.0f}): "
                                                  "take a larger voxel or a smaller radius",
                                                  path, along, k_most_voxels));
  const std::string key = cache_key(bytes, how, band);
  if (const auto cached = use_cache ? read_cached(key) : std::nullopt)
    if (auto grid = DistanceGrid::from_bytes(*cached)) return std::make_shared<const DistanceGrid>(std::move(*grid));
  const Mesh smooth = how.crease > 0 ? curved_mesh(mesh, how.crease, k_facet_voxels * how.voxel, path) : mesh;
  auto grid = std::make_shared<const DistanceGrid>(make_distance_grid(smooth, how.voxel, band));
  if (use_cache) write_cached(key, grid->to_bytes(), fmt::format("the distances of {} are", path), diagnostics);
  return grid;
}

} // namespace kelpie
