// A program all over space: what of it matters where.
#pragma once

#include "renderer/program/evaluate.h"

namespace kelpie {

/// Boxes that fill the support of a program, each with what yields the program's values there. So a thousand regions cost at a point
/// what the few there cost.
class ValueCells {
public:
  /// For points within `bounds`; elsewhere the whole program counts. Takes 128 MB beside the program at most.
  ValueCells(FieldProgram program, const Box3d& bounds);

  const FieldProgram& program() const { return program_; }
  /// What yields the program's values at a point and around it; no steps where the field is 0.
  CodeView code_at(const Vec3d& p) const;

private:
  /// A box is halved across an axis, or has code.
  struct Node {
    int axis = -1; ///< -1: it has code
    double middle = 0;
    uint32_t lower = 0, upper = 0; ///< nodes; or `lower` is the place of its code
  };

  void build();

  FieldProgram program_;
  Box3d box_;
  std::vector<Node> nodes_;
  std::vector<Code> codes_;
};

} // namespace kelpie
