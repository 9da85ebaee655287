// The medial-axis sphere tree: a shape as balls, in levels of detail.
#pragma once

#include <span>
#include <vector>

#include "morph/liquid/medial_axis.h"

namespace kelpie {

/// Spheres whose centres lie near the medial axis and which together cover the surface samples (Bradshaw
/// and O'Sullivan 2004, "Adaptive medial-axis approximation for sphere-tree construction").
struct SphereTree {
  struct Node {
    MedialSphere sphere;
    unsigned parent = 0; ///< index in the level above; 0 in the first level
  };
  /// From coarse to fine; the first level is one sphere that holds everything.
  std::vector<std::vector<Node>> levels;

  const std::vector<Node>& finest() const { return levels.back(); }
};

/// A tree whose finest level has about `spheres` spheres (fewer, where it may and they cover everything closely), each
/// level about eight times fewer. `dense` is the set P of the paper, spread evenly: some ten times more
/// points than spheres, of the surface of `mesh`, in units
/// of the shape's diagonal. Empty finest level: the samples enclose nothing.
SphereTree build_sphere_tree(std::span<const SurfaceSample> dense, const TriangleTree& mesh, size_t spheres, bool may_use_fewer);

} // namespace kelpie
