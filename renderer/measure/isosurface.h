// The surface of a field as a mesh: not to be seen (rays meet the field itself) but to be measured.
#pragma once

#include "field/mesh/mesh.h"
#include "renderer/measure/lattice.h"
#include "renderer/program/program.h"

namespace kelpie {

/// A field at a moment, and shortly before and after it. The programs need not have one structure.
struct FieldMoment {
  FieldProgram now, before, after;
  double span = 1; ///< from `before` to `after`, frames
};

/// A closed mesh, its triangles counter-clockwise from outside, its vertices on the surface of the field where that meets the edges of
/// the tetrahedra into which the cells of a lattice are cut (marching tetrahedra; six to a cell, around its diagonal). Its topology is
/// that of the field's signs at the nodes: what is thinner than a cell may be missing.
struct Isosurface {
  Mesh mesh;
  std::vector<uint32_t> inner; ///< of each vertex the node that is inside, at one end of its edge
  std::vector<float> speed;    ///< of each vertex how fast the surface moves along its normal, scene units a frame
  std::vector<uint8_t> inside; ///< of each node whether the field exceeds the threshold there
};

/// Runs in the current TBB arena; the result does not depend on the number of threads. The nodes on the hull of the lattice must be
/// outside, as those of Lattice::around(surface_bounds(...)) (surface_search.h) are.
Isosurface extract_surface(const FieldMoment&, const Lattice&);

} // namespace kelpie
