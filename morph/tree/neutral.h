// Warps that do nothing.
#pragma once

#include "morph/tree/mix_kinds.h"

namespace kelpie {

/// The same kind of warp, about the same axis, with the numbers by which it changes nothing; none for what is no warp.
std::optional<AnimatedKind> neutral_warp(const AnimatedKind& warp);

} // namespace kelpie
