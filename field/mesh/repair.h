// Makes of what is in a file a mesh whose inside is known.
#pragma once

#include "field/mesh/mesh.h"

namespace kelpie {

/// In this order, each with a warning where anything had to be done or could not be:
/// merges vertices of equal position (a file without a single shared vertex is a soup and says nothing); welds borders (weld.h); drops
/// triangles that repeat a vertex or another triangle; leaves out vertices that no triangle uses; turns triangles to one orientation
/// within each component (connected over edges with two triangles); turns components that face the wrong way (orient_outward);
/// closes simple holes by triangulating their outline, where the mesh winds around what closes them by about a half: an outline that
/// runs through the inside, or far outside, is a seam between parts and no hole; reports open edges, edges of more than two triangles
/// and a volume of zero.
/// Throws Error, bad_data, where no triangle is left.
Mesh repair_mesh(std::vector<Vec3d> positions, std::vector<Triangle> triangles, const MeshOptions&, const std::string& file, Diagnostics&);

} // namespace kelpie
