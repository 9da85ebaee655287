// Cells: disjoint boxes that hold all of a shape's surface, each with the part of its program that
// matters there. They are what Embree sees.
#pragma once

#include <functional>
#include <memory>

#include "base/box.h"
#include "renderer/cells/leaf_data.h"
#include "renderer/cells/memory_budget.h"
#include "renderer/cells/tree.h"
#include "renderer/program/motion.h"

namespace kelpie {

struct Cell {
  enum class Content : uint32_t {
    pure_blobs,         ///< a sum of quartic blobs of positive weight: arrays x y z s k with f = sum max(0, s - k d^2)^2
    mixed_blobs,        ///< a sum of any blobs: arrays x y z s=1 k a b with f = sum q^2 (a + b q), q = max(0, s - k d^2)
    moving_pure_blobs,  ///< as pure_blobs, and their centres move: after that x y z of the way they go in the slab
    moving_mixed_blobs, ///< as mixed_blobs, and anything of them moves: after that the changes of x y z k a b
    tree,               ///< operators and skeletons that stand: see tree.h
    moving_tree,        ///< the same in motion: kept as code, of which each ray makes its own tree
    code,               ///< anything else
  };
  bool has_code() const { return content == Content::moving_tree || content == Content::code; }
  static constexpr size_t arrays(Content c) {
    return c == Content::pure_blobs ? 5 : c == Content::mixed_blobs ? 7 : c == Content::moving_pure_blobs ? 8 : 13;
  }
  Box3 box;
  Vec3 centre; ///< from here count the places of a tree
  Content content = Content::code;
  uint32_t count = 0;                   ///< blobs, padding included; or steps
  uint64_t first = 0;                   ///< into ShapeCells::tree_steps or ::steps
  const float* data = nullptr;          ///< in ShapeCells::leaf_data: blobs, or the leaves of a tree
  float epsilon = 0;                    ///< offset of secondary rays along the normal: 1e-3 of the smallest radius of influence
  uint32_t leaf_count = 0;              ///< of a tree, padding included
  bool is_monotone = true;              ///< of a tree: TreeView::is_monotone
  uint8_t window = 0;                   ///< the part of the slab in which the box holds the surface
  uint32_t space_count = 0, spaces = 0; ///< of a tree: how many and where in ShapeCells::tree_spaces
  uint32_t solid_count = 0, solids = 0; ///< of a tree: how many and where in ShapeCells::solids
  uint32_t parts = 0, edges = 0;        ///< where those of its solids begin
  uint32_t axes = 0;                    ///< of a tree: where those of its warps begin
};

/// All cells of one shape in a slab of time: where nothing moves, the whole time. The code of a cell refers to `operands`
/// and `blob_indices` from their starts. A slab may have several windows, equal parts of its time: they share the numbers of
/// blobs, but each has boxes of its own, cut back to where the surface is in that time.
struct ShapeCells {
  FieldProgram program;
  std::vector<Cell> cells;           ///< by windows
  std::vector<uint32_t> window_ends{0}; ///< where the cells of each window end
  LeafData leaf_data;                ///< blobs, and the leaves of trees
  std::vector<TreeStep> tree_steps;
  std::vector<TreeSpace> tree_spaces;
  std::vector<SolidLeaf> solids;
  std::vector<SolidPart> solid_parts;
  std::vector<SolidEdge> solid_edges;
  std::vector<LaneAxis> lane_axes;
  std::vector<Instruction> steps;
  std::vector<uint32_t> operands, blob_indices;
  float slab_start = 0, slabs = 1; ///< the slab is [start, start + 1 / slabs] of the open shutter

  /// The time within the slab, 0 to 1, of a ray.
  float slab_time(float ray_time) const { return std::min(std::max((ray_time - slab_start) * slabs, 0.f), 1.f); }
  CodeView code(const Cell& c) const {
    CodeView view;
    view.steps = std::span(steps).subspan(c.first, c.count), view.operands = operands, view.blobs = blob_indices;
    return view;
  }
  TreeView tree(const Cell& c) const {
    return {std::span(tree_steps).subspan(c.first, c.count),
            std::span(tree_spaces).subspan(c.spaces, c.space_count),
            c.data,
            c.leaf_count,
            c.is_monotone,
            {std::span(solids).subspan(c.solids, c.solid_count), solid_parts.data() + c.parts, solid_edges.data() + c.edges},
            lane_axes.data() + c.axes};
  }
  size_t windows() const { return window_ends.size(); }
  std::span<const Cell> cells_in(size_t window) const {
    const size_t begin = window == 0 ? 0 : window_ends[window - 1];
    return std::span(cells).subspan(begin, window_ends[window] - begin);
  }
  size_t bytes() const;
};

/// A shape in each slab of time, a power of two of them; frames may share them.
using Slabs = std::vector<std::shared_ptr<const ShapeCells>>;

/// What Embree's tree takes for each cell, about.
inline constexpr size_t k_tree_bytes_per_cell = 100;

/// How far space is subdivided.
struct CellLimits {
  uint32_t elements = 16;  ///< few enough elements make a cell a leaf, if its side is at most…
  float sparse_side = 16;  ///< …this many radii of influence of the smallest (a tiny blob in a huge cell: imprecise and slow)
  float side_in_radii = 2; ///< …and so does a side below this many radii of influence of its smallest element (finer: slower, and eight
                           ///< times the memory a halving)
  int depth = 24;
  uint32_t slabs = 32;            ///< the most slabs of time in which a shape moves
  MemoryBudget* budget = nullptr; ///< what cells take is taken from it, if there is one
};

/// Makes cells twice as long, and with them memory smaller and rays slower; false where they would be so long that float
/// numbers lose small elements in them.
bool make_coarser(CellLimits&);

/// Subdivides the support of a program from the top down: every cell is bounded and pruned; those proved
/// empty or full are dropped. Parallel within the current TBB arena; the result does not depend on the
/// number of threads. Windows: of a sum of blobs of which the centres move, else they are all the same. Throws
/// MemoryBudget::Exceeded.
ShapeCells build_cells(FieldProgram program, const CellLimits& limits = {}, uint32_t windows = 1);

/// The program of a shape at several times of the open shutter, in [0, 1] and ascending, compiled together.
using CompileAt = std::function<std::vector<FieldProgram>(std::span<const double> times)>;

/// The cells of a shape that may move, for each slab of time: as many slabs, a power of two, as it takes for linear
/// interpolation to follow the motion and for cells not to swell by it. `breaks`: times where the motion is not smooth.
/// A shape that stands still has one slab.
Slabs build_slabs(const CompileAt& compile_at, std::span<const double> breaks, const CellLimits& limits = {});

} // namespace kelpie
