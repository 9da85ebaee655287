// What there is to know of a mesh before it is printed.
#pragma once

#include "field/mesh/mesh.h"

namespace kelpie {

/// A connected surface.
struct Piece {
  double volume = 0;
  Box3d box;
};

/// Of a closed mesh, in its own units.
struct Survey {
  double volume = 0, area = 0;
  Box3d box;
  std::vector<Piece> pieces;   ///< closed surfaces that enclose something, the largest first
  std::vector<Piece> cavities; ///< closed surfaces that face inward, of negative volume; the largest first
  /// The thickness that all but a thousandth of the surface has at least: by rays from 20,000 places, spread evenly over the surface,
  /// straight inward to where they come out. Ways out through what is turned away from the place by more than 60 degrees are no wall: the
  /// tip of a wedge has none. `thinnest_at` is the middle of a wall as thin as this.
  double thinnest = 0;
  Vec3d thinnest_at{0};
};

/// Runs in the current TBB arena; does not depend on the number of threads.
Survey survey(const Mesh&);

/// Whether the triangles around each vertex are one ring: with is_closed(), whether the mesh is a manifold.
bool has_single_rings(const Mesh&);

} // namespace kelpie
