// Hollow solids.
#pragma once

#include "renderer/mesh/mesh_solid.h"

namespace kelpie {

/// What of a solid is no further than `wall` from its surface, as mesh_solid() makes it of the whole: `surface`. Each cavity of more than
/// eight cubed radii is drained by a hole of `drain_radius` (none: 0) from its lowest point straight down (-y), through the wall. Where the
/// solid is nowhere thicker than two walls there is no cavity.
struct HollowMesh {
  Mesh mesh;
  size_t cavities = 0, holes = 0;
};
HollowMesh hollowed(const Solid&, const Mesh& surface, double wall, double drain_radius, double tolerance);

} // namespace kelpie
