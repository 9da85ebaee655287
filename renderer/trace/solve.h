// Finds where a ray first meets the surface inside one cell.
#pragma once

#include <array>
#include <string_view>

#include "field/warps/axis_work.h"
#include "renderer/cells/cells.h"
#include "renderer/lanes/packet.h"
#include "renderer/trace/shape_set.h"

namespace kelpie {

struct Ray {
  Vec3 origin, direction; ///< direction: a unit vector
  float t_near = 0, t_far = std::numeric_limits<float>::infinity();
  ShapeSet inside; ///< the shapes that the ray starts in: their surfaces are met from within
  float time = 0;  ///< while the shutter is open, 0 to 1
};

/// The part of a ray that lies in a cell: origin + t * direction (a unit vector), t in [t0, t1].
struct RaySegment {
  Vec3 origin, direction;
  float t0, t1;
  float entry;      ///< where the ray enters the box; t0 is padded, and an answer before `entry` counts as `entry`
  bool from_inside; ///< the ray comes from inside the shape: the first crossing outward is sought
  float time = 0;   ///< that of the ray
};

/// The rays of a packet, a lane each, as Embree lays them out: `count` values side by side.
struct RayLanes {
  size_t count;     ///< 4, 8 or 16
  const int* valid; ///< not 0: the lane takes part. All start outside the shape
  const float *origin_x, *origin_y, *origin_z, *direction_x, *direction_y, *direction_z, *t_near, *t_far, *time;
  bool any; ///< any hit will do (before t_far), not only the first
  Ray ray(size_t lane) const;
};

/// What a solver did.
struct SolverWork {
  uint64_t cells = 0;       ///< cells solved, each for one ray
  uint64_t evaluations = 0; ///< of the field: samples along rays

  SolverWork& operator+=(const SolverWork& w) {
    cells += w.cells, evaluations += w.evaluations;
    return *this;
  }
};

/// What the solvers did, for statistics; one per thread.
struct SolveCounters {
  SolverWork blobs, blob_packets, trees, tree_packets, code;
  AxisWork axis; ///< of axial deformations: by rays, and in hits

  struct Solver {
    std::string_view name; ///< in statistics
    SolverWork SolveCounters::*work;
  };
  static const std::array<Solver, 5> k_solvers;

  SolverWork total() const {
    SolverWork sum;
    for (const Solver& s : k_solvers) sum += this->*s.work;
    return sum;
  }
  SolveCounters& operator+=(const SolveCounters& c) {
    for (const Solver& s : k_solvers) this->*s.work += c.*s.work;
    axis += c.axis;
    return *this;
  }
};

inline constexpr std::array<SolveCounters::Solver, 5> SolveCounters::k_solvers{{
    {"blobs", &SolveCounters::blobs},
    {"blob_packets", &SolveCounters::blob_packets},
    {"trees", &SolveCounters::trees},
    {"tree_packets", &SolveCounters::tree_packets},
    {"code", &SolveCounters::code},
}};

/// The part of the ray in the cell, padded so that no wall between two cells is a gap; false if there is none.
/// The pad is small enough that the cell's list of elements is still whole (the builder keeps the same margin).
///
/// Of t_far the segment knows nothing, so that it is the same whatever was met before; and without their pads
/// the segments of neighbours join exactly. Thus the nearest answer of all cells (of equals, that of the first
/// cell) does not depend on the order of the visits, which in a packet depends on the other rays.
bool clip(const Cell&, const Ray&, bool from_inside, RaySegment&);

/// The first t at which field - threshold changes sign, or t0 if the ray is on the other side already
/// (it has come through a wall between two cells). False if there is none.
bool solve(const ShapeCells&, const Cell&, const RaySegment&, SolveCounters&, float& t);

/// The same for each lane of a packet, clipped to the cell: returns the lanes (bits) that hit, and where. What a
/// lane gets depends on its own ray alone, to the last bit. Lanes whose cell lies past t_far may be left out; of
/// lanes that do not hit, t is anything.
uint32_t solve_lanes(const ShapeCells&, const Cell&, const RayLanes&, SolveCounters&, float* t);

/// The gradient of the field at a point of a cell, at a ray's time.
Vec3 cell_gradient(const ShapeCells&, const Cell&, const Vec3& p, float time);

/// How fast field - threshold changes at a point of a cell, at a ray's time: by the time within the slab.
double cell_rate(const ShapeCells&, const Cell&, const Vec3& p, float time);

// The solvers behind `solve`:

/// Sums of point blobs; SIMD, dispatched at run time.
bool solve_blobs(const ShapeCells&, const Cell&, const RaySegment&, SolverWork&, float& t);
uint32_t solve_blobs_lanes(const ShapeCells&, const Cell&, const RayLanes&, SolveCounters&, float* t);
Vec3 blobs_gradient(const ShapeCells&, const Cell&, const Vec3& p, float time);
/// Any cell, by `solve`.
uint32_t solve_one_by_one(const ShapeCells&, const Cell&, const RayLanes&, SolveCounters&, float* t);
/// Trees of skeletons; SIMD, dispatched at run time.
bool solve_tree(const ShapeCells&, const Cell&, const RaySegment&, SolverWork&, float& t);
/// The same for a tree that the cell does not keep, and its program.
bool solve_given_tree(const FieldProgram&, const TreeView&, const Cell&, const RaySegment&, SolverWork&, float& t);
/// One that moves: as it is at the ray's time, or as code, where it is then no tree.
bool solve_moving_tree(const ShapeCells&, const Cell&, const RaySegment&, SolverWork&, float& t);
uint32_t solve_tree_lanes(const ShapeCells&, const Cell&, const RayLanes&, SolveCounters&, float* t);
Vec3 tree_gradient(const ShapeCells&, const Cell&, const Vec3& p);
/// Any code.
bool solve_code(const ShapeCells&, const Cell&, const RaySegment&, SolverWork&, float& t);

} // namespace kelpie
