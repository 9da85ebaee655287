// Polygons to triangles.
#pragma once

#include "field/mesh/mesh.h"

namespace kelpie {

/// Cuts a polygon, which may be concave and need not be quite flat, by clipping ears in the plane of its
/// mean normal (Newell). Where no ear is left (the outline crosses itself, or all lie on a line) the
/// rest becomes a fan. Appends corners.size() - 2 triangles that keep the polygon's orientation.
void triangulate(const std::vector<Vec3d>& positions, const std::vector<uint32_t>& corners, std::vector<Triangle>& out);

} // namespace kelpie
