#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "renderer/cells/cells.h"
#include "renderer/cells/tighten.h"
#include "renderer/program/bound.h"

namespace kelpie {

size_t ShapeCells::bytes() const {
  return cells.size() * sizeof(Cell) + leaf_data.bytes() + steps.size() * sizeof(Instruction) + tree_steps.size() * sizeof(TreeStep) +
         tree_spaces.size() * sizeof(TreeSpace) + solids.size() * sizeof(SolidLeaf) + solid_parts.size() * sizeof(SolidPart) +
         solid_edges.size() * sizeof(SolidEdge) + lane_axes.size() * sizeof(LaneAxis) +
         (operands.size() + blob_indices.size()) * sizeof(uint32_t);
}

namespace {

/// A cell is dropped as empty or full only by this margin of the threshold: rays are solved in float.
constexpr double k_margin = 1e-5;
/// Subtrees with more elements than this are built in parallel; each level of them copies the cells once.
constexpr size_t k_parallel_elements = 2000;

/// How much the warps of a cell may differ from a linear map. Below k_calm_side radii they may as much as a tree allows; below
/// k_torn_side they may anyhow: so what is torn is divided until few cells have both the tear and the surface.
constexpr double k_most_turning = 0.5, k_calm_side = 0.2, k_torn_side = 0.05;

class Builder {
public:
  Builder(const FieldProgram& program, const CellLimits& limits, uint32_t windows)
      : program_(program), threshold_(threshold_range(program)), limits_(limits), windows_(windows) {}

  /// All cells within a box.
  void run(const Box3d& box, ShapeCells& out) {
    build(box, program_.code, 0, out);
    for (LeafData& of_thread : leaf_data_) out.leaf_data.join(std::move(of_thread));
  }

private:
  void build(const Box3d& box, const Code& parent, int depth, ShapeCells& out) const {
    std::vector<Interval> ranges;
    Code code = bound(program_, parent, box, ranges);
    const Interval field = ranges.back();
    if (field.hi < threshold_.lo * (1 - k_margin) || field.lo > threshold_.hi * (1 + k_margin)) return;
    if (code.steps.size() > 1) code = prune(program_, code, ranges);
    const double radius = smallest_radius(code);
    const size_t elements = element_count(code);
    const Vec3d extent = box.extent();
    const double side = std::max({extent.x, extent.y, extent.z});
    const bool is_sparse = elements <= limits_.elements && side <= std::min(limits_.sparse_side * radius, side_by_lattices(code));
    const bool is_leaf = (is_sparse || side <= limits_.side_in_radii * radius) && is_calm(box, code, side, radius);
    if (is_leaf || depth >= limits_.depth)
      add_cell(box, code, radius, out);
    else
      subdivide(box, code, elements, depth, out);
  }

  /// Below this side a cell holds few of the voxels of what is known by samples on a lattice: bounds over many are wide.
  double side_by_lattices(const Code& code) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Instruction& step : code.steps)
      if (step.kind == Instruction::Kind::skeleton)
        least = std::min(least, limits_.side_in_radii * smallest_scale(step.space) * visit_skeleton(step.node, [](const auto& kind) {
                                  if constexpr (requires { kind.feature_size(); }) return kind.feature_size();
                                  return std::numeric_limits<double>::infinity();
                                }));
    return least;
  }

  /// Whether rays are nearly lines in the spaces of a cell; below a part of a radius it matters less.
  bool is_calm(const Box3d& box, const Code& code, double side, double radius) const {
    // Of what moves nobody knows where it is torn.
    if (side <= (program_.motion ? k_calm_side : k_torn_side) * radius) return true;
    const double most = side <= k_calm_side * radius ? k_most_drift : k_most_turning;
    uint32_t last = 0;
    for (const Instruction& step : code.steps) {
      if (step.space == last || program_.spaces[step.space].is_affine_in_world()) continue;
      last = step.space;
      if (!(turning(program_, step.space, {Vec3(box.lower), Vec3(box.upper)}) <= most)) return false;
    }
    return true;
  }

  /// Halves every axis that is not much shorter than the longest, so that cells become cubes.
  void subdivide(const Box3d& box, const Code& code, size_t elements, int depth, ShapeCells& out) const {
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
    std::array<ShapeCells, 8> parts;
    tbb::parallel_for(size_t(0), count, [&](size_t i) { build(children[i], code, depth + 1, parts[i]); });
    size_t cells = 0; // growing step by step would copy what is large
    for (const ShapeCells& part : parts) cells += part.cells.size();
    out.cells.reserve(out.cells.size() + cells);
    for (size_t i = 0; i < count; ++i) append(std::exchange(parts[i], {}), out); // gone at once: not everything is there twice
  }

  /// In the order of the children, whatever thread was first.
  static void append(const ShapeCells& part, ShapeCells& out) {
    for (Cell cell : part.cells) {
      cell.first += cell.has_code() ? out.steps.size() : out.tree_steps.size();
      cell.spaces += static_cast<uint32_t>(out.tree_spaces.size());
      cell.solids += static_cast<uint32_t>(out.solids.size());
      cell.parts += static_cast<uint32_t>(out.solid_parts.size()), cell.edges += static_cast<uint32_t>(out.solid_edges.size());
      cell.axes += static_cast<uint32_t>(out.lane_axes.size());
      out.cells.push_back(cell);
    }
    const auto operands = static_cast<uint32_t>(out.operands.size()), blobs = static_cast<uint32_t>(out.blob_indices.size());
    for (Instruction step : part.steps) {
      step.first += step.kind == Instruction::Kind::blobs ? blobs : operands;
      out.steps.push_back(step);
    }
    const auto add = [&](auto ShapeCells::*list) { (out.*list).insert((out.*list).end(), (part.*list).begin(), (part.*list).end()); };
    add(&ShapeCells::operands), add(&ShapeCells::blob_indices);
    add(&ShapeCells::tree_steps), add(&ShapeCells::tree_spaces);
    add(&ShapeCells::solids), add(&ShapeCells::solid_parts), add(&ShapeCells::solid_edges);
    add(&ShapeCells::lane_axes);
  }

  void add_cell(const Box3d& box, const Code& code, double radius, ShapeCells& out) const {
    LeafData& leaf_data = leaf_data_.local();
    const auto bytes = [&] { return out.bytes() + leaf_data.bytes(); };
    const size_t before = bytes(), cells = out.cells.size();
    Cell cell;
    cell.box = {Vec3(box.lower), Vec3(box.upper)}, cell.centre = cell.box.centre();
    cell.epsilon = static_cast<float>(1e-3 * std::min(radius, smallest_influence(code)));
    const bool is_sum = code.steps.size() == 1 && code.steps[0].kind == Instruction::Kind::blobs && code.steps[0].space == 0;
    if (is_sum) {
      add_blobs(code.blobs, cell, leaf_data, out);
    } else {
      if (!add_tree(code, cell, leaf_data, out)) add_code(code, cell, out);
      if (!cell.box.is_empty()) add_to_windows(cell, out);
    }
    if (limits_.budget && out.cells.size() > cells)
      limits_.budget->take(bytes() - before + (out.cells.size() - cells) * k_tree_bytes_per_cell);
  }

  /// The same box in all windows.
  void add_to_windows(Cell cell, ShapeCells& out) const {
    for (uint32_t i = 0; i < windows_; ++i) {
      cell.window = static_cast<uint8_t>(i);
      out.cells.push_back(cell);
    }
  }

  void add_blobs(const std::vector<uint32_t>& list, Cell& cell, LeafData& leaf_data, ShapeCells& out) const {
    const BlobArrays &s = program_.blobs, &e = program_.motion ? program_.motion->end.blobs : s;
    const bool may_change = program_.motion && program_.motion->blobs_change;
    bool pure = true, moves = false, changes = false;
    for (const uint32_t i : list) {
      pure = pure && s.b[i] == 0 && s.a[i] > 0;
      moves = moves || s.x[i] != e.x[i] || s.y[i] != e.y[i] || s.z[i] != e.z[i];
      changes = changes || (may_change && (s.k[i] != e.k[i] || s.a[i] != e.a[i] || s.b[i] != e.b[i]));
    }
    pure = pure && !changes; // the root of a weight that changes is not linear in time
    const size_t n = (list.size() + k_leaf_group - 1) / k_leaf_group * k_leaf_group;
    cell.content = pure ? (moves ? Cell::Content::moving_pure_blobs : Cell::Content::pure_blobs)
                        : (moves || changes ? Cell::Content::moving_mixed_blobs : Cell::Content::mixed_blobs);
    const size_t arrays = Cell::arrays(cell.content);
    float* data = leaf_data.add(n * arrays);
    cell.count = static_cast<uint32_t>(n), cell.data = data;
    for (size_t i = 0; i < arrays; ++i) // padding: s < 0 is 0 everywhere
      std::fill(data + i * n + list.size(), data + (i + 1) * n, i == 3 ? -1.f : 0.f);
    for (size_t j = 0; j < list.size(); ++j) {
      const uint32_t i = list[j];
      const float root = pure ? std::sqrt(s.a[i]) : 1;
      data[j] = s.x[i], data[n + j] = s.y[i], data[2 * n + j] = s.z[i];
      data[3 * n + j] = root, data[4 * n + j] = root * s.k[i];
      if (!pure) data[5 * n + j] = s.a[i], data[6 * n + j] = s.b[i];
      if (!moves && !changes) continue;
      float* change = data + (pure ? 5 : 7) * n + j;
      change[0] = e.x[i] - s.x[i], change[n] = e.y[i] - s.y[i], change[2 * n] = e.z[i] - s.z[i];
      if (!pure) change[3 * n] = e.k[i] - s.k[i], change[4 * n] = e.a[i] - s.a[i], change[5 * n] = e.b[i] - s.b[i];
    }
    if (cell.content == Cell::Content::moving_mixed_blobs) return add_to_windows(cell, out);
    const Box3 whole = cell.box;
    bool is_empty = true;
    for (uint32_t i = 0; i < windows_; ++i) {
      const TimeSpan time{float(i) / float(windows_), float(i + 1) / float(windows_)};
      cell.box = tightened_to_blobs(whole, cell.content, data, n, threshold_.lo, time), cell.window = static_cast<uint8_t>(i);
      if (cell.box.is_empty()) continue;
      out.cells.push_back(cell);
      is_empty = false;
    }
    if (is_empty) leaf_data.drop(n * arrays);
  }

  /// Whether anything that a code needs is in motion.
  bool moves(const Code& code) const {
    if (!program_.motion) return false;
    const Motion& motion = *program_.motion;
    const BlobArrays &s = program_.blobs, &e = motion.end.blobs;
    const auto blob_moves = [&](uint32_t i) {
      return s.x[i] != e.x[i] || s.y[i] != e.y[i] || s.z[i] != e.z[i] || s.k[i] != e.k[i] || s.a[i] != e.a[i] || s.b[i] != e.b[i];
    };
    const auto step_moves = [&](const Instruction& step) {
      if (step.kind == Instruction::Kind::combine) return bool(motion.nodes[step.node]);
      return motion.spaces[step.space] || (step.kind == Instruction::Kind::skeleton && motion.nodes[step.node]);
    };
    return threshold_.lo != threshold_.hi || std::any_of(code.steps.begin(), code.steps.end(), step_moves) ||
           std::any_of(code.blobs.begin(), code.blobs.end(), blob_moves);
  }

  bool add_tree(const Code& code, Cell& cell, LeafData& leaf_data, ShapeCells& out) const {
    const std::optional<Tree> tree = make_tree(program_, code, cell.box);
    if (!tree) return false;
    if (moves(code)) { // the numbers of its leaves are not linear in time
      cell.content = Cell::Content::moving_tree;
      return false;
    }
    // Twice: a tenth fewer of the costly visits, for a tenth more of building.
    for (int pass = 0; pass < 2 && !cell.box.is_empty(); ++pass)
      cell.box = tightened_to_tree(cell.box, tree->view(), cell.centre, program_.threshold);
    if (cell.box.is_empty()) return true;
    const auto add = [](const auto& from, auto& to) {
      const size_t first = to.size();
      to.insert(to.end(), from.begin(), from.end());
      return first;
    };
    cell.content = Cell::Content::tree, cell.is_monotone = tree->is_monotone;
    cell.count = static_cast<uint32_t>(tree->steps.size()), cell.first = add(tree->steps, out.tree_steps);
    float* leaves = leaf_data.add(tree->leaves.size());
    std::copy(tree->leaves.begin(), tree->leaves.end(), leaves);
    cell.leaf_count = tree->leaf_count, cell.data = leaves;
    cell.space_count = static_cast<uint32_t>(tree->spaces.size());
    cell.spaces = static_cast<uint32_t>(add(tree->spaces, out.tree_spaces));
    cell.solid_count = static_cast<uint32_t>(tree->solids.size());
    cell.solids = static_cast<uint32_t>(add(tree->solids, out.solids));
    cell.parts = static_cast<uint32_t>(add(tree->parts, out.solid_parts)),
    cell.edges = static_cast<uint32_t>(add(tree->edges, out.solid_edges));
    cell.axes = static_cast<uint32_t>(add(tree->axes, out.lane_axes));
    return true;
  }

  static void add_code(const Code& code, Cell& cell, ShapeCells& out) {
    cell.count = static_cast<uint32_t>(code.steps.size()), cell.first = out.steps.size();
    const auto operands = static_cast<uint32_t>(out.operands.size()), blobs = static_cast<uint32_t>(out.blob_indices.size());
    for (Instruction step : code.steps) {
      step.first += step.kind == Instruction::Kind::blobs ? blobs : operands;
      out.steps.push_back(step);
    }
    out.operands.insert(out.operands.end(), code.operands.begin(), code.operands.end());
    out.blob_indices.insert(out.blob_indices.end(), code.blobs.begin(), code.blobs.end());
  }

  static size_t element_count(const Code& code) {
    size_t n = code.blobs.size();
    for (const Instruction& s : code.steps) n += s.kind == Instruction::Kind::skeleton;
    return n;
  }

  /// The smallest radius of influence (half the smallest side of a skeleton's support) in world units.
  double smallest_radius(const Code& code) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Instruction& step : code.steps) {
      const double scale = smallest_scale(step.space);
      if (step.kind == Instruction::Kind::blobs)
        for (uint32_t j = 0; j < step.count; ++j) least = std::min(least, scale * program_.blobs.radius[code.blobs[step.first + j]]);
      else if (step.kind == Instruction::Kind::skeleton)
        least = std::min(least, scale * skeleton_radius(step.node));
    }
    return std::isfinite(least) ? least : program_.support.diagonal();
  }

  double skeleton_radius(uint32_t node) const {
    return visit_skeleton(node, [](const auto& kind) -> double {
      if constexpr (requires { kind.feature_size(); }) return kind.feature_size();
      const Vec3 e = kind.support().extent();
      return 0.5 * double(std::min({e.x, e.y, e.z}));
    });
  }

  /// The smallest radius of influence of the skeletons, without their own size, in world units.
  double smallest_influence(const Code& code) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Instruction& step : code.steps)
      if (step.kind == Instruction::Kind::skeleton)
        least = std::min(least, smallest_scale(step.space) * visit_skeleton(step.node, [](const auto& kind) { return reach_of(kind); }));
    return least;
  }

  template <class Visit>
  double visit_skeleton(uint32_t node, Visit&& visit) const {
    return std::visit(
        [&](const auto& kind) -> double {
          if constexpr (Skeleton<std::decay_t<decltype(kind)>>) return visit(kind);
          return 0;
        },
        program_.field.nodes[node]);
  }

  /// A lower bound of what the affine maps from a space to the world do to lengths (the Frobenius norm of
  /// the inverse bounds its largest singular value). Warps that are not affine count as if they kept lengths:
  /// this only chooses the size of cells and the offset of secondary rays.
  double smallest_scale(uint32_t space) const {
    double scale = 1;
    for (uint32_t i = space; i != 0; i = program_.spaces[i].parent) {
      const Mat3d& m = program_.spaces[i].local_from_parent.linear;
      if (m != Mat3d(1.0)) scale /= std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
    }
    return scale;
  }

  const FieldProgram& program_;
  Interval threshold_; ///< over the slab
  const CellLimits& limits_;
  uint32_t windows_;
  mutable tbb::enumerable_thread_specific<LeafData> leaf_data_; ///< which of them holds a cell's numbers makes no difference
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
