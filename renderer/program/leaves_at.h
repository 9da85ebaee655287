// Which leaves make a field at a point.
#pragma once

#include "renderer/program/evaluate.h"

namespace kelpie {

struct LeafAt {
  LeafIdentity whose;
  double potential; ///< not 0
  double influence; ///< not 0: the derivative of the field by the potential. 1 in a blend and of what a union or an intersection takes
};

/// The leaves on which the field at a point of the world depends. `code` is all of the program, which has identities and does not move
/// (see at()), or what was pruned for values around the point: the answer is the same.
void leaves_at(const FieldProgram& program, const CodeView& code, const Vec3d& p, std::vector<LeafAt>& out);

} // namespace kelpie
