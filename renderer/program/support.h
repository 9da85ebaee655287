// Where the field of a program is at most 0, standing or moving.
#pragma once

#include "renderer/program/motion.h"

namespace kelpie {

/// A box outside of which the field is at most 0, at all times of the motion (null: it stands). False if spaces turn or shrink so much
/// in the motion that not all interpolated maps can be inverted.
bool find_support(const FieldProgram&, const Motion*, Box3d& out);

} // namespace kelpie
