// Fewer triangles for the same surface.
#pragma once

#include <limits>

#include "renderer/mesh/self_intersections.h"

namespace kelpie {

struct SimplifyOptions {
  double tolerance = 0;                                       ///< how far a vertex may come to lie from the surface that is left
  size_t most_triangles = std::numeric_limits<size_t>::max(); ///< whatever the tolerance
};

/// Collapses edges (OpenMesh), those first that move the least of the surface by the quadric error metric (Garland and Heckbert 1997), as
/// long as every vertex that is gone stays within the tolerance of the triangles that took its place; then further, until there are no more
/// than `most_triangles`. Vertices that stay keep their places. A closed manifold without self-intersections stays one: no
/// collapse changes the topology or turns a triangle over, and where triangles come to meet, all around is left as it was.
/// There may be more triangles than wished where no edge is left that can go.
Mesh simplified(const Mesh&, const ExactLattice&, const SimplifyOptions&);

} // namespace kelpie
