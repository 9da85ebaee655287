// The medial axis of a shape from points of its surface.
#pragma once

#include <span>
#include <vector>

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

/// For each sample the Voronoi vertices of its cell that lie farthest from it, below and above the surface
/// (its poles: Amenta, Choi, Kolluri 2001, "The power crust"). Samples denser than the local feature size
/// put them near the medial axis. The diagram is Qhull's; no voxels. `area` is that of the whole surface; a pole that
/// turns out to lie on the other side is dropped. Fewer than five samples, or samples in one plane, have no poles.
std::vector<Poles> find_poles(std::span<const SurfaceSample>, double area);

/// How often the surface winds around `p`: 1 inside, 0 outside, blurred within the samples' distance from the
/// surface. `area` is the surface's: each sample stands for an equal share of it. (A sign by the nearest sample's normal
/// is wrong beyond sharp edges.)
double winding_number(std::span<const SurfaceSample>, double area, const Vec3d& p);

} // namespace kelpie
