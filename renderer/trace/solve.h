// Finds where a ray first meets the surface inside one cell.
#pragma once

#include "renderer/cells/cells.h"

namespace kelpie {

/// The part of a ray that lies in a cell: origin + t * direction (a unit vector), t in [t0, t1].
struct RaySegment {
  Vec3 origin, direction;
  float t0, t1;
  bool from_inside; ///< the ray comes from inside the shape: the first crossing outward is sought
};

/// What the solvers did, for statistics; one per thread.
struct SolveCounters {
  uint64_t cells = 0;       ///< cells solved
  uint64_t evaluations = 0; ///< of the field: samples along rays
};

/// The first t at which field - threshold changes sign, or t0 if the ray is on the other side already
/// (it has come through a wall between two cells). False if there is none.
bool solve(const ShapeCells&, const Cell&, const RaySegment&, SolveCounters&, float& t);

/// The gradient of the field at a point of a cell.
Vec3 cell_gradient(const ShapeCells&, const Cell&, const Vec3& p);

// The solvers behind `solve`:

/// Sums of point blobs; SIMD, dispatched at run time.
bool solve_blobs(const ShapeCells&, const Cell&, const RaySegment&, SolveCounters&, float& t);
Vec3 blobs_gradient(const ShapeCells&, const Cell&, const Vec3& p);
/// Any code.
bool solve_code(const ShapeCells&, const Cell&, const RaySegment&, SolveCounters&, float& t);

} // namespace kelpie
