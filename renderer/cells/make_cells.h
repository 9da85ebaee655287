// Cells of a box, of what is left of a program there.
#pragma once

#include "renderer/cells/cells.h"

namespace kelpie {

class CellMaker {
public:
  /// Cells for so many windows of the program's slab of time.
  CellMaker(const FieldProgram& program, uint32_t windows) : program_(program), threshold_(threshold_range(program)), windows_(windows) {}

  /// Appends the cells of a box: one for each window in which it holds surface. `code` is the program, pruned to the box; what the
  /// cells consist of goes to `memory`. `kept`: the program that they keep, if the shape asks for it. `radius`: the smallest radius of
  /// influence of `code`.
  void add(const Box3d& box, const Code& code, const Code* kept, double radius, CellMemory& memory, std::vector<Cell>& out) const;

private:
  void add_blobs(const std::vector<uint32_t>& list, Cell& cell, CellMemory& memory, std::vector<Cell>& out) const;
  BlobForm form_of(const std::vector<uint32_t>& list) const;
  void write_blobs(const std::vector<uint32_t>& list, const BlobList& to, float* numbers) const;
  bool changes_of(uint32_t i) const;
  bool blob_moves(uint32_t blob) const;
  bool moves(const Code& code) const;
  bool make_tree(const Code& code, Cell& cell, CellMemory& memory) const;
  void add_to_windows(Cell cell, std::vector<Cell>& out) const;

  const FieldProgram& program_;
  Interval threshold_; ///< over the slab
  uint32_t windows_;
};

} // namespace kelpie
