// What an entry of the cache may lead to, once its checksums are right: distances that can be asked for anywhere, blobs, or nothing.
#include <cmath>
#include <cstdlib>
#include <cstring>

#include <xxhash.h>

#include "base/error.h"
#include "field/clouds/cloud_file.h"
#include "field/distances/distance_grid.h"

namespace kelpie {
namespace {

/// Where a grid's header ends with the hash of all that follows.
constexpr size_t k_hash_at = 88, k_header = k_hash_at + sizeof(uint64_t);

void try_grid(std::string bytes) {
  if (bytes.size() < k_header) return;
  const uint64_t hash = XXH3_64bits(bytes.data() + k_header, bytes.size() - k_header);
  std::memcpy(bytes.data() + k_hash_at, &hash, sizeof hash);
  const std::optional<DistanceGrid> grid = DistanceGrid::from_bytes(bytes);
  if (!grid) return;
  const Box3d box = grid->box();
  for (const double t : {-0.5, 0.0, 0.3, 0.999, 1.0, 2.0}) {
    const Vec3d p = glm::mix(box.lower, box.upper, t), q = p + 2.5 * grid->voxel();
    grid->at(Point3<double>{p.x, p.y, p.z});
    grid->at(Point3<Interval>{{p.x, q.x}, {p.y, q.y}, {p.z, q.z}});
  }
}

} // namespace
} // namespace kelpie

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  kelpie::try_grid(bytes);
  try {
    for (const kelpie::Blob& blob : kelpie::parse_blob_cloud(bytes, "fuzz.ply"))
      if (!(blob.radius > 0)) std::abort();
  } catch (const kelpie::Error& e) {
    if (e.status != kelpie::ExitStatus::bad_data) std::abort();
  }
  return 0;
}
