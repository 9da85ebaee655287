// What the solvers of trees read: a tree of operators over skeletons, under any warps, as flat lists of numbers. Leaves that are
// cone-spheres (points and segments are the thinnest) are in structure-of-arrays form; other solids, of which a cell
// has few, are one by one. renderer/cells/tree.h makes it.
#pragma once

#include <cstdint>
#include <span>

#include "base/box.h"
#include "renderer/lanes/lane_warp.h"

namespace kelpie {

/// Lists of leaves are padded to whole groups of this many, so that any vector width reads them whole.
inline constexpr uint32_t k_leaf_group = 16;

/// What an operator makes of its operands. The R-functions are those below a sum, in their localised form
/// (field/operators/r_functions.h).
enum class Join : uint8_t {
  sum,
  maximum,
  minimum,
  difference,
  r_union,
  r_intersection,
  r_difference,
  hyper_blend,
  local_blend, ///< the last operand is the region
};
/// Whether it falls with all operands but the first.
constexpr bool subtracts(Join j) { return j == Join::difference || j == Join::r_difference; }
constexpr bool is_r_function(Join j) { return j == Join::r_union || j == Join::r_intersection || j == Join::r_difference; }
/// Whether it makes nothing below 0.
constexpr bool is_clamped(Join j) { return subtracts(j) || is_r_function(j) || j == Join::hyper_blend; }
/// Whether it rises with each operand, or falls with each that it subtracts.
constexpr bool is_monotone(Join j) { return j != Join::r_union && j != Join::local_blend; }
/// Whether its slope may change sharply, but not at once, where operands are equal.
constexpr bool bends(Join j) { return is_r_function(j) || j == Join::hyper_blend || j == Join::local_blend; }

/// One step of a tree in post-order: pushes the sum of some leaves or a solid, or joins what was pushed last.
struct TreeStep {
  enum class Kind : uint8_t {
    leaves, ///< cone-spheres
    solid,
    join,
  };
  Kind kind = Kind::leaves;
  /// The field falls where this rises: it stands below an odd number of subtractions.
  bool is_subtracted = false;
  Join join = Join::sum;         ///< of a join, as what follows…
  Demand demand = Demand::value; ///< …what the whole tree asks of its operator…
  float exponent = 1;            ///< …and the exponent of `hyper_blend`
  uint32_t first = 0;            ///< of `leaves`: the first one; of `solid`: which; of a join: its operator in the program
  uint32_t count = 0;            ///< leaves, or operands: 2, any number of `local_blend`
};

/// A space of the program that is warped in the world: there a ray is a curve.
struct TreeSpace {
  uint32_t space; ///< into FieldProgram::spaces
  Vec3 centre;    ///< the image of the cell's centre, rounded
  uint32_t base;  ///< from where it is warped: 0: the world; i + 1: TreeView::spaces[i], which is before this one
  LaneWarp warp;
};

/// The numbers of a leaf. Its potential at a point p, relative to the centre of the cell in the leaf's space, is q^2 (a + b q) with
/// q = max(0, 1 - k d^2) and d the distance to the cone-sphere:
///   (x, y, z) = (x_row, y_row, z_row) p + (x_0, y_0, z_0),   z along the axis,
///   s = clamp(z - slope |(x, y)|, s_low, s_high),   d = max(0, |(x, y, z - s)| - (r - sine s)).
/// The axis is measured from its point nearest to the cell, so that nothing here is much larger than the cell
/// or a radius: float suffices.
enum LeafRow : uint32_t {
  leaf_xx,
  leaf_xy,
  leaf_xz,
  leaf_x0, //
  leaf_yx,
  leaf_yy,
  leaf_yz,
  leaf_y0, //
  leaf_zx,
  leaf_zy,
  leaf_zz,
  leaf_z0, //
  leaf_s_low,
  leaf_s_high,
  leaf_r,
  leaf_sine,
  leaf_slope,
  leaf_k,
  leaf_a,
  leaf_b,
  leaf_crest,   ///< the q, up to 1, where the potential bends down most (tree_leaf-inl.h)
  leaf_space,   ///< 0: the world; i + 1: TreeView::spaces[i]
  leaf_drift,   ///< within the cell, from its tangent at a place h away a ray parts by no more than this times h…
  leaf_bending, ///< …and this times the square of h
  k_leaf_rows
};

/// An edge of a convex polygon, which lies to its left: from (x, y) to (x + along_x, y + along_y).
struct SolidEdge {
  float x, y, along_x, along_y, inverse_square; ///< of its length
};

/// A convex polygon or a rectangle in a plane, and how far it is extruded.
struct SolidPart {
  float frame[12];                    ///< rows, as leaf_xx … leaf_z0: where a point is, from the centre of the cell in the leaf's space
  float x_low, x_high, y_low, y_high; ///< a rectangle, unless there are edges
  float z_low, z_high;                ///< not of what is turned
  uint32_t first_edge = 0, edge_count = 0; ///< into Solids::edges
};

/// What a solid's potential is at a distance d from it.
struct SolidPotential {
  enum class Form : uint32_t {
    bump, ///< q^2 (a + b q) with q = max(0, 1 - k d^2), as that of cone-spheres
    ramp, ///< a - b d, but at least `low` and at most `high`, which may be infinite: of signed distances
  };
  Form form = Form::bump;
  float a = 0, b = 0;
  float k = 0, crest = 1;                                                     ///< of a bump; crest: as leaf_crest
  float low = 0, high = 0;                                                    ///< of a ramp
  bool is_positive() const { return form == Form::bump ? a + b > 0 : b > 0; } ///< whether it rises with nearness
};

/// A skeleton that is no cone-sphere.
struct SolidLeaf {
  enum class Form : uint32_t {
    extruded,   ///< the part as it is
    turned,     ///< the part, where x is the distance from the axis of its frame and y the height along it
    arc,        ///< the same of a point, that is a circle, between two ends
    hull,       ///< the parts are its faces, those that the cell can see: z is outward
    half_space, ///< all below z = 0 in the part's frame, by its signed distance
  };
  Form form;
  bool is_convex;
  bool is_signed;                  ///< inside a rectangle, extruded or turned, the distance is below 0, not 0
  uint32_t first_part, part_count; ///< into Solids::parts
  float growth;                    ///< the solid is all that is nearer than this
  SolidPotential potential;
  float drift, bending;                     ///< as leaf_drift, leaf_bending
  uint32_t slot;                            ///< as leaf_space
  float end_x, end_y;                       ///< of an arc: its end, on the side y >= 0 of the frame
  float past_end_x, past_end_y, past_end_0; ///< of an arc: a place is past its end where past_end_x x + past_end_y |y| + past_end_0 > 0
  uint32_t node, space;                     ///< of the program, for its gradient
};

/// The solids of a tree.
struct Solids {
  std::span<const SolidLeaf> leaves;
  const SolidPart* parts;
  const SolidEdge* edges;
};

/// What holds for the joins of a tree.
struct TreeTraits {
  bool is_monotone = true; ///< each rises with each operand, or falls with each that it subtracts
  bool has_subtraction = false;
  bool bends_sharply = false; ///< some may bend on the surface, so that a secant misses its root
  /// Whether bounds from above depend on bounds of operands from below.
  bool wants_low() const { return !is_monotone || has_subtraction; }
};

/// A tree in a cell: row r of leaf i is leaves[r * leaf_count + i].
struct TreeView {
  std::span<const TreeStep> steps;
  std::span<const TreeSpace> spaces;
  const float* leaves;
  size_t leaf_count; ///< with padding: leaves that are 0 everywhere
  TreeTraits traits;
  Solids solids;
  const LaneAxis* axes; ///< of its warps

  float row(LeafRow r, size_t i) const { return leaves[r * leaf_count + i]; }
  /// Whether the potential is positive where it is not 0.
  bool is_positive(size_t i) const { return row(leaf_a, i) + row(leaf_b, i) > 0; }
};

/// No deeper stack of sums is solved so, and not more warped spaces in a cell.
inline constexpr size_t k_tree_depth = 16, k_tree_spaces = 8;

} // namespace kelpie
