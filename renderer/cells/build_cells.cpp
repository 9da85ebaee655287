// Space is halved from the top down: each box is bounded, and its program pruned, until what is left is a cell.
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <tbb/enumerable_thread_specific.h>

#include "base/parallel.h"
#include "renderer/cells/cells.h"
#include "renderer/cells/element_size.h"
#include "renderer/cells/make_cells.h"
#include "renderer/program/bound.h"

namespace kelpie {

namespace {

/// A cell is dropped as empty or full only by this margin of the threshold: rays are solved in float.
constexpr double k_margin = 1e-5;
/// Boxes with more elements than this are halved in parallel; each level of them copies the cells once.
constexpr size_t k_parallel_elements = 2000;

/// In boxes longer than k_calm_side radii of influence warps may differ from a linear map by k_most_turning, in boxes longer than
/// k_torn_side by as much as a tree allows; smaller ones become cells in any case. So a box with a tear is halved until few
/// cells hold both the tear and the surface.
constexpr double k_most_turning = 0.5, k_calm_side = 0.2, k_torn_side = 0.05;

using Cells = std::vector<Cell>;

class Builder {
public:
  Builder(const FieldProgram& program, const CellLimits& limits, uint32_t windows)
      : program_(program), threshold_(threshold_range(program)), limits_(limits), thin_(program), maker_(program, windows) {}

  /// All cells within a box.
  void run(const Box3d& box, ShapeCells& out) {
    out.depends_on_view = thin_.are_there();
    build(box, program_.code, 0, out.cells);
    for (CellMemory& of_thread : memory_) out.memory.join(std::move(of_thread));
  }

private:
  void build(const Box3d& box, const Code& parent, int depth, Cells& out) const {
    if (limits_.budget) limits_.budget->check_time();
    std::vector<Interval> ranges;
    Code code = bound(program_, parent, box, ranges);
    const Interval field = ranges.back();
    if (field.hi < threshold_.lo * (1 - k_margin) || field.lo > threshold_.hi * (1 + k_margin)) return;
    const bool keeps_programs = program_.identities != nullptr, is_lone = code.steps.size() == 1;
    const Code kept = !keeps_programs ? Code{} : is_lone ? code : prune(program_, code, ranges, Demand::value);
    if (!is_lone) code = prune(program_, code, ranges);
    const double radius = smallest_radius(program_, code);
    const size_t elements = element_count(code);
    const Vec3d extent = box.extent();
    const double side = std::max({extent.x, extent.y, extent.z});
    const double width = thin_.are_there() ? thin_.dividing_radius(code, box, limits_.pixels) : radius;
    const double side_by_lattices = limits_.side_in_radii * smallest_lattice(program_, code);
    const bool is_sparse = elements <= limits_.elements && side <= std::min(limits_.sparse_side * width, side_by_lattices);
    const bool is_leaf = (is_sparse || side <= limits_.side_in_radii * width) && is_calm(box, code, side, width);
    if (is_leaf || depth >= limits_.depth)
      add_cells(box, code, keeps_programs ? &kept : nullptr, radius, out);
    else
      subdivide(box, keeps_programs ? kept : code, elements, depth, out);
  }

  void add_cells(const Box3d& box, const Code& code, const Code* kept, double radius, Cells& out) const {
    CellMemory& memory = memory_.local();
    const size_t bytes = memory.bytes(), cells = out.size();
    maker_.add(box, code, kept, radius, memory, out);
    if (limits_.budget && out.size() > cells)
      limits_.budget->take(memory.bytes() - bytes + (out.size() - cells) * (sizeof(Cell) + k_tree_bytes_per_cell));
  }

  /// Whether rays are nearly lines in the spaces of a cell; below a part of a radius it matters less.
  bool is_calm(const Box3d& box, const Code& code, double side, double radius) const {
    // Of what moves nobody knows where it is torn.
    if (side <= (program_.motion ? k_calm_side : k_torn_side) * radius) return true;
    const double most = side <= k_calm_side * radius ? k_most_drift : k_most_turning;
    uint32_t last = 0;
    for (const Instruction& step : code.steps) {
      const uint32_t warped = nearest_warp(step.space);
      if (warped == last) continue;
      last = warped;
      if (!(turning(program_, warped, {Vec3(box.lower), Vec3(box.upper)}) <= most)) return false;
    }
    return true;
  }

  /// The space of the warp that a space lies below; 0 if there is none. Affine maps below it turn nothing.
  uint32_t nearest_warp(uint32_t space) const {
    while (space != 0 && program_.spaces[space].warp == Space::k_no_warp) space = program_.spaces[space].parent;
    return space;
  }

  /// Halves every axis that is not much shorter than the longest, so that cells become cubes.
  void subdivide(const Box3d& box, const Code& code, size_t elements, int depth, Cells& out) const {
    const Vec3d extent = box.extent();
    const double longest = std::max({extent.x, extent.y, extent.z});
    std::array<Box3d, 8> children;
    size_t count = 1;
    children[0] = box;
    for (int axis = 0; axis < 3; ++axis) {
      if (extent[axis] < 0.6 * longest) continue;
      const double middle = box.centre()[axis];
      for (size_t i = 0; i < count; ++i) {
        children[count + i] = children[i];
        children[i].upper[axis] = children[count + i].lower[axis] = middle;
      }
      count *= 2;
    }
    if (elements < k_parallel_elements) {
      for (size_t i = 0; i < count; ++i) build(children[i], code, depth + 1, out);
      return;
    }
    std::array<Cells, 8> parts;
    parallel_for(size_t(0), count, [&](size_t i) { build(children[i], code, depth + 1, parts[i]); });
    size_t cells = 0; // growing step by step would copy what is large
    for (const Cells& part : parts) cells += part.size();
    out.reserve(out.size() + cells);
    for (size_t i = 0; i < count; ++i) {              // in the order of the children, whatever thread was first
      const Cells part = std::exchange(parts[i], {}); // gone at once: not everything is there twice
      out.insert(out.end(), part.begin(), part.end());
    }
  }

  const FieldProgram& program_;
  Interval threshold_; ///< over the slab
  const CellLimits& limits_;
  ThinElements thin_;
  CellMaker maker_;
  mutable tbb::enumerable_thread_specific<CellMemory> memory_; ///< which of them holds a cell's parts makes no difference
};

/// Puts the cells in the order of their windows; within one it stays.
void sort_by_windows(ShapeCells& shape, uint32_t windows) {
  shape.window_ends.assign(windows, 0);
  for (const Cell& cell : shape.cells) ++shape.window_ends[cell.window];
  std::partial_sum(shape.window_ends.begin(), shape.window_ends.end(), shape.window_ends.begin());
  if (windows == 1) return;
  std::vector<Cell> sorted(shape.cells.size());
  std::vector<uint32_t> next(windows, 0);
  std::copy(shape.window_ends.begin(), shape.window_ends.end() - 1, next.begin() + 1);
  for (const Cell& cell : shape.cells) sorted[next[cell.window]++] = cell;
  shape.cells = std::move(sorted);
}

} // namespace

bool make_coarser(CellLimits& limits) {
  if (limits.side_in_radii >= limits.sparse_side) return false;
  limits.side_in_radii *= 2, limits.elements *= 2;
  return true;
}

ShapeCells build_cells(FieldProgram program, const CellLimits& limits, uint32_t windows) {
  ShapeCells out;
  if (limits.budget) limits.budget->take(program_bytes(program));
  if (!program.support.is_empty()) {
    // Off the round numbers that scenes are made of: a surface in the plane between two cells is legal but slow.
    const double pad = 1e-3 * program.support.diagonal() + 1e-6;
    Box3d box = program.support.padded(pad);
    box.upper += Vec3d(0.31, 0.17, 0.23) * pad;
    Builder(program, limits, windows).run(box, out);
  }
  sort_by_windows(out, windows);
  out.program = std::move(program);
  return out;
}

} // namespace kelpie
