// Cells: disjoint boxes that hold all of a shape's surface, each with the part of its program that
// matters there. They are what Embree sees.
#pragma once

#include <functional>
#include <memory>

#include "base/box.h"
#include "field/complex/detail.h"
#include "renderer/cells/blob_list.h"
#include "renderer/cells/build_budget.h"
#include "renderer/cells/cell_memory.h"
#include "renderer/cells/tree.h"
#include "renderer/program/motion.h"

namespace kelpie {

/// A box that may hold surface, and what the field is there.
struct Cell {
  enum class Content : uint8_t {
    blobs,       ///< a sum of blobs, standing or moving
    tree,        ///< operators and skeletons that stand: see tree.h
    moving_tree, ///< the same in motion: kept as a program, of which each ray makes its own tree
    code,        ///< anything else: a program
  };
  Box3 box;
  Vec3 centre;       ///< from here count the places of a tree
  float epsilon = 0; ///< offset of secondary rays along the normal: 1e-3 of the smallest radius of influence
  Content content = Content::code;
  uint8_t window = 0;             ///< the part of the slab in which the box holds the surface
  BlobList blobs;                 ///< of `blobs`
  const TreeView* tree = nullptr; ///< of `tree`
  /// Of `moving_tree` and `code`; and of any cell whose program has identities: then pruned for values, not only for the sign.
  const CodeView* code = nullptr;
};

/// All cells of one shape in a slab of time: where nothing moves, the whole time. A slab may have several windows, equal parts of
/// its time: their cells share blobs, trees and programs, but each window has boxes of its own, cut back to where the surface is in
/// that time.
struct ShapeCells {
  FieldProgram program;
  std::vector<Cell> cells;              ///< by windows
  std::vector<uint32_t> window_ends{0}; ///< where the cells of each window end
  CellMemory memory;                    ///< what cells point to
  bool depends_on_view = false;         ///< other pixels would have made other cells
  float slab_start = 0, slabs = 1;      ///< the slab is [start, start + 1 / slabs] of the open shutter

  /// The time within the slab, 0 to 1, of a ray.
  float slab_time(float ray_time) const { return std::min(std::max((ray_time - slab_start) * slabs, 0.f), 1.f); }
  const CodeView& code(const Cell& cell) const { return *cell.code; }
  const TreeView& tree(const Cell& cell) const { return *cell.tree; }
  size_t windows() const { return window_ends.size(); }
  std::span<const Cell> cells_in(size_t window) const {
    const size_t begin = window == 0 ? 0 : window_ends[window - 1];
    return std::span(cells).subspan(begin, window_ends[window] - begin);
  }
  /// Of the cells and the program.
  size_t bytes() const { return cells.size() * sizeof(Cell) + memory.bytes() + program_bytes(program); }
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
  PixelScale pixels{};           ///< of the picture: thin elements are divided no finer than by these
  uint32_t slabs = 32;           ///< the most slabs of time in which a shape moves
  bool with_identities = false;  ///< programs are compiled with identities, so that cells keep them
  BuildBudget* budget = nullptr; ///< what programs and cells take is taken from it, and it ends what takes too long, if there is one
};

/// Makes cells twice as long, and with them memory smaller and rays slower; false where they would be so long that float
/// numbers lose small elements in them.
bool make_coarser(CellLimits&);

/// Subdivides the support of a program from the top down: every cell is bounded and pruned; those proved
/// empty or full are dropped. Parallel within the current TBB arena; the result does not depend on the
/// number of threads. Windows: of a sum of blobs of which the centres move, else they are all the same. Throws
/// BuildBudget::OutOfMemory and OutOfTime.
ShapeCells build_cells(FieldProgram program, const CellLimits& limits = {}, uint32_t windows = 1);

/// The program of a shape at several times of the open shutter, in [0, 1] and ascending, compiled together.
using CompileAt = std::function<std::vector<FieldProgram>(std::span<const double> times)>;

/// The cells of a shape that may move, for each slab of time: as many slabs, a power of two, as it takes for linear
/// interpolation to follow the motion and for cells not to swell by it. `breaks`: times where the motion is not smooth.
/// A shape that stands still has one slab.
Slabs build_slabs(const CompileAt& compile_at, std::span<const double> breaks, const CellLimits& limits = {});

} // namespace kelpie
