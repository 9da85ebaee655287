// Trees that are solved in SIMD lanes: sums, unions, intersections and differences over leaves that are
// cone-spheres in some affine space (points and segments are the thinnest). A cell holds its pruned tree with
// the leaves in structure-of-arrays form.
#pragma once

#include <cstdint>
#include <span>

#include "base/box.h"
#include "renderer/program/program.h"

namespace kelpie {

/// Lists of leaves are padded to whole groups of this many, so that any vector width reads them whole.
inline constexpr uint32_t k_leaf_group = 16;

/// One step of a tree in post-order: pushes the sum of some leaves, or joins what was pushed last.
struct TreeStep {
  enum class Kind : uint32_t { leaves, sum, maximum, minimum, difference };
  Kind kind = Kind::leaves;
  uint32_t first = 0; ///< of `leaves`: the first one
  uint32_t count = 0; ///< leaves, or operands
  /// The field falls where this rises: it stands below an odd number of subtractions.
  bool is_subtracted = false;
};

/// The numbers of a leaf. Its potential at a point p, relative to the centre of the cell, is q^2 (a + b q) with
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
  leaf_sign, ///< 1 where the field rises with nearness to the leaf, -1 where it falls
  k_leaf_rows
};

/// A tree in a cell: row r of leaf i is leaves[r * leaf_count + i].
struct TreeView {
  std::span<const TreeStep> steps;
  const float* leaves;
  size_t leaf_count; ///< with padding: leaves that are 0 everywhere
};

/// No deeper stack of sums is solved so.
inline constexpr size_t k_tree_depth = 16;

/// Appends the tree of a cell with this centre to `steps` and `leaves`, and returns the number of leaves, with
/// padding; 0, and nothing appended, if `code` has a step that no tree has.
uint32_t make_tree(const FieldProgram& program, const Code& code, const Vec3d& centre, std::vector<TreeStep>& steps,
                   std::vector<float>& leaves);

} // namespace kelpie
