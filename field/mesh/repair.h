// Makes of what is in a file a mesh whose inside is known.
#pragma once

#include "field/mesh/mesh.h"

namespace kelpie {

/// In this order, each with a warning where anything had to be done or could not be:
/// drops faces with vertices that are no usable numbers; merges vertices of equal position (a file without
/// a single shared vertex is a soup and says nothing); drops triangles that repeat a vertex or
/// another triangle; leaves out vertices that no triangle uses; turns triangles to one orientation within
/// each component (connected over edges with two triangles); closes simple holes by triangulating
/// their outline; turns components outward, and those inside an odd number of others inward (cavities); reports
/// open edges, edges of more than two triangles and a volume of zero.
/// Throws Error, bad_data, where no triangle is left.
Mesh repair_mesh(std::vector<Vec3d> positions, std::vector<Triangle> triangles, const std::string& file, Diagnostics&);

// Steps of it that are of use alone:

/// Drops triangles with coordinates that are no usable numbers, with a warning, and sets those to 0.
void drop_unusable_triangles(std::vector<Vec3d>& positions, std::vector<Triangle>& triangles, const std::string& file, Diagnostics&);

/// For each position the index of the first that is equal.
std::vector<uint32_t> first_at_same_place(const std::vector<Vec3d>& positions);

} // namespace kelpie
