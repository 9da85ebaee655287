#include "renderer/cells/make_cells.h"

#include <cmath>

#include "renderer/cells/element_size.h"
#include "renderer/cells/tighten.h"

namespace kelpie {

namespace {

TreeView copy(const Tree& tree, CellMemory& memory) {
  return {memory.copy(tree.steps),
          memory.copy(tree.spaces),
          memory.copy(tree.leaves).data(),
          tree.leaf_count,
          tree.traits,
          {memory.copy(tree.solids), memory.copy(tree.parts).data(), memory.copy(tree.edges).data()},
          memory.copy(tree.axes).data()};
}

CodeView copy(const Code& code, CellMemory& memory) {
  CodeView view;
  view.steps = memory.copy(code.steps), view.operands = memory.copy(code.operands), view.blobs = memory.copy(code.blobs);
  return view;
}

} // namespace

void CellMaker::add(const Box3d& box, const Code& code, const Code* kept, double radius, CellMemory& memory, std::vector<Cell>& out) const {
  const size_t before = out.size();
  Cell cell;
  cell.box = {Vec3(box.lower), Vec3(box.upper)}, cell.centre = cell.box.centre();
  cell.epsilon = static_cast<float>(1e-3 * std::min(radius, smallest_influence(program_, code)));
  const bool is_sum = code.steps.size() == 1 && code.steps[0].kind == Instruction::Kind::blobs && code.steps[0].space == 0;
  if (is_sum) {
    add_blobs(code.blobs, cell, memory, out);
  } else {
    const bool wants_code = !make_tree(code, cell, memory) && !kept;
    if (cell.box.is_empty()) return;
    if (wants_code) cell.code = memory.keep(copy(code, memory));
    add_to_windows(cell, out);
  }
  if (!kept || out.size() == before) return;
  const CodeView* const program = memory.keep(copy(*kept, memory));
  for (Cell& made : std::span(out).subspan(before)) made.code = program;
}

/// The same box in all windows.
void CellMaker::add_to_windows(Cell cell, std::vector<Cell>& out) const {
  for (uint32_t i = 0; i < windows_; ++i) {
    cell.window = static_cast<uint8_t>(i);
    out.push_back(cell);
  }
}

void CellMaker::add_blobs(const std::vector<uint32_t>& list, Cell& cell, CellMemory& memory, std::vector<Cell>& out) const {
  BlobList blobs{nullptr, static_cast<uint32_t>((list.size() + k_leaf_group - 1) / k_leaf_group * k_leaf_group), form_of(list)};
  const size_t numbers = size_t(blobs.count) * blobs.form.rows();
  float* const at = memory.add_numbers(numbers);
  blobs.numbers = at;
  write_blobs(list, blobs, at);
  cell.content = Cell::Content::blobs, cell.blobs = blobs;
  const bool may_change = blobs.form.moves && !blobs.form.is_pure;
  if (may_change) return add_to_windows(cell, out);
  const Box3 whole = cell.box;
  const size_t before = out.size();
  for (uint32_t i = 0; i < windows_; ++i) {
    const TimeSpan time{float(i) / float(windows_), float(i + 1) / float(windows_)};
    cell.box = tightened_to_blobs(whole, blobs, threshold_.lo, time), cell.window = static_cast<uint8_t>(i);
    if (!cell.box.is_empty()) out.push_back(cell);
  }
  if (out.size() == before) memory.drop_numbers(numbers);
}

BlobForm CellMaker::form_of(const std::vector<uint32_t>& list) const {
  const BlobArrays &s = program_.blobs, &e = program_.motion ? program_.motion->end.blobs : s;
  const bool may_change = program_.motion && program_.motion->blobs_change;
  bool is_pure = true, moves = false, changes = false, is_round = true;
  for (const uint32_t i : list) {
    is_pure = is_pure && s.b[i] == 0 && s.a[i] > 0;
    moves = moves || s.x[i] != e.x[i] || s.y[i] != e.y[i] || s.z[i] != e.z[i];
    changes = changes || (may_change && changes_of(i));
    is_round = is_round && s.least_radius(i) == s.radius[i] && e.least_radius(i) == e.radius[i];
  }
  // The root of a weight that changes is not linear in time. What changes does so by its matrix if it has one.
  return {is_pure && !changes, moves || changes, is_round && (!changes || s.are_round())};
}

void CellMaker::write_blobs(const std::vector<uint32_t>& list, const BlobList& to, float* numbers) const {
  const BlobArrays &s = program_.blobs, &e = program_.motion ? program_.motion->end.blobs : s;
  const BlobForm form = to.form;
  const auto row = [&](uint32_t r) { return numbers + size_t(r) * to.count; };
  for (uint32_t r = 0; r < form.rows(); ++r) std::fill(row(r) + list.size(), row(r) + to.count, r == blob_s ? -1.f : 0.f);
  for (size_t j = 0; j < list.size(); ++j) {
    const uint32_t i = list[j];
    const float root = form.is_pure ? std::sqrt(s.a[i]) : 1;
    row(blob_x)[j] = s.x[i], row(blob_y)[j] = s.y[i], row(blob_z)[j] = s.z[i];
    row(blob_s)[j] = root, row(blob_k)[j] = root * s.k[i];
    if (!form.is_pure) row(blob_a)[j] = s.a[i], row(blob_b)[j] = s.b[i];
    const auto shape_row = [](uint32_t r) { return static_cast<BlobShapeRow>(r); };
    for (uint32_t r = 0; !form.is_round && r < k_shape_rows; ++r)
      row(form.row_of(shape_row(r)))[j] = std::sqrt(root) * (s.shapes.*BlobShapes::k_members[r])[i];
    if (!form.moves) continue;
    const auto change = [&](BlobRow r, const std::vector<float> BlobArrays::*m) { row(form.change_of(r))[j] = (e.*m)[i] - (s.*m)[i]; };
    change(blob_x, &BlobArrays::x), change(blob_y, &BlobArrays::y), change(blob_z, &BlobArrays::z);
    if (form.is_pure) continue;
    change(blob_k, &BlobArrays::k), change(blob_a, &BlobArrays::a), change(blob_b, &BlobArrays::b);
    for (uint32_t r = 0; !form.is_round && r < k_shape_rows; ++r) {
      const auto member = BlobShapes::k_members[r];
      row(form.change_of(shape_row(r)))[j] = (e.shapes.*member)[i] - (s.shapes.*member)[i];
    }
  }
}

/// Whether more of a blob than its centre moves.
bool CellMaker::changes_of(uint32_t i) const {
  const BlobArrays &s = program_.blobs, &e = program_.motion->end.blobs;
  return s.k[i] != e.k[i] || s.a[i] != e.a[i] || s.b[i] != e.b[i] || (!s.are_round() && s.shapes[i] != e.shapes[i]);
}

bool CellMaker::blob_moves(uint32_t i) const {
  const BlobArrays &s = program_.blobs, &e = program_.motion->end.blobs;
  return s.x[i] != e.x[i] || s.y[i] != e.y[i] || s.z[i] != e.z[i] || changes_of(i);
}

/// Whether anything that a code needs is in motion.
bool CellMaker::moves(const Code& code) const {
  if (!program_.motion) return false;
  const Motion& motion = *program_.motion;
  const auto step_moves = [&](const Instruction& step) {
    if (step.kind == Instruction::Kind::combine) return bool(motion.nodes[step.node]);
    return motion.spaces[step.space] || (step.kind == Instruction::Kind::skeleton && motion.nodes[step.node]);
  };
  return threshold_.lo != threshold_.hi || std::any_of(code.steps.begin(), code.steps.end(), step_moves) ||
         std::any_of(code.blobs.begin(), code.blobs.end(), [&](uint32_t i) { return blob_moves(i); });
}

/// Makes the cell one of a tree, or of one that moves, and cuts back its box; false if it must be kept as a program.
bool CellMaker::make_tree(const Code& code, Cell& cell, CellMemory& memory) const {
  const bool is_moving = moves(code);
  const std::optional<Tree> tree =
      is_moving ? make_wide_tree(program_, code, cell.box, cell.centre) : kelpie::make_tree(program_, code, cell.box, cell.centre);
  if (tree) {
    cell.content = is_moving ? Cell::Content::moving_tree : Cell::Content::tree;
    // Twice: a tenth fewer of the costly visits, for a tenth more of building.
    for (int pass = 0; pass < 2 && !cell.box.is_empty(); ++pass)
      cell.box = tightened_to_tree(cell.box, tree->view(), cell.centre, program_.threshold);
    if (!cell.box.is_empty() && !is_moving) cell.tree = memory.keep(copy(*tree, memory));
  } else if (is_moving && kelpie::make_tree(program_, code, cell.box, cell.centre)) {
    cell.content = Cell::Content::moving_tree;
  }
  return cell.content == Cell::Content::tree;
}

} // namespace kelpie
