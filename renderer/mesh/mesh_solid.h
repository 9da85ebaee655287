// A solid's surface as a triangle mesh.
#pragma once

#include "field/mesh/mesh.h"
#include "renderer/mesh/solid.h"

namespace kelpie {

/// Marching tetrahedra on those of an octree (cell_tetrahedra.h): closed, oriented outward, manifold and free of self-intersections by
/// construction, as each tetrahedron holds a piece of a plane or two triangles, and neighbours share their borders. Vertices lie on the
/// surface, where it crosses edges of tetrahedra, but for those that would lie nearer to an edge's end than a tenth of the tolerance.
/// Triangles part from the surface by less than `tolerance` where the octree's samples show it; an edge of the solid is cut off by less.
/// Empty where the solid shows no inside. Runs in the current TBB arena; does not depend on the number of threads. Throws Error as Octree
/// does.
Mesh mesh_solid(const Solid&, double tolerance);

} // namespace kelpie
