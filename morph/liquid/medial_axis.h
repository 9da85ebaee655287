// The medial axis of a shape from points of its surface.
#pragma once

#include <span>
#include <vector>

#include "field/mesh/triangle_tree.h"
#include "morph/liquid/surface_samples.h"

namespace kelpie {

/// A ball, in the mesh's units.
struct MedialSphere {
  Vec3d centre{0};
  double radius = 0;
};

/// The largest balls that touch the surface in a sample from inside and from outside; radius 0: none found.
struct Poles {
  MedialSphere inner, outer;
};

/// For each sample the Voronoi vertices of its cell that lie farthest from it, below and above the surface (its poles: Amenta, Choi,
/// Kolluri 2001, "The power crust"), if they are inside and outside `mesh`, by its winding number. Samples denser than the local feature
/// size put them near the medial axis. Where most cells reach through a wall, as it is thinner than samples are apart, the
/// farthest vertex inside counts. The diagram is Qhull's; no voxels. Fewer than five samples have no poles.
std::vector<Poles> find_poles(std::span<const SurfaceSample>, const TriangleTree& mesh);

} // namespace kelpie
