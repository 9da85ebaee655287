// Points spread evenly over a mesh.
#pragma once

#include <vector>

#include "field/mesh/mesh.h"

namespace kelpie {

/// A point of the surface and the outward unit normal of its triangle, in the mesh's units.
struct SurfaceSample {
  Vec3d position{0};
  Vec3d normal{0};
  Vec3d smooth{0}; ///< the mean of the normals of its corners, which are those of the triangles around them by area
};
inline const Vec3d& place_of(const SurfaceSample& sample) { return sample.position; }

/// Whether points on either side of a thin sheet keep apart from each other as well.
enum class Sides { together, apart };

/// About `count` points no two of which are much closer than the others (Poisson-disc: neighbours keep a
/// distance of 0.7 of the densest packing's). Deterministic; another `seed` gives other points. Triangles
/// without area are passed over; a mesh without any yields no points.
std::vector<SurfaceSample> spread_samples(const Mesh&, size_t count, uint64_t seed, Sides sides = Sides::together);

/// Exactly `count` points, uniform and independent: for measuring.
std::vector<SurfaceSample> random_samples(const Mesh&, size_t count, uint64_t seed);

} // namespace kelpie
