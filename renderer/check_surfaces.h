// Shapes that nobody will see, because their fields never exceed their thresholds.
#pragma once

#include <span>

#include "scene/scene.h"

namespace kelpie {

/// Warns of every implicit shape that provably has no surface while the shutter is open in any of `frames`, and of shapes with a
/// skeleton whose field only reaches the threshold (in the first, the middle and the last of them). In a few tenths of a second:
/// of what would take longer nothing is said.
void warn_of_missing_surfaces(const Scene&, std::span<const int> frames, Diagnostics&);

} // namespace kelpie
