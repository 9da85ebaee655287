// Complex primitives become unions of skeletons.
#pragma once

#include <span>

#include "scene/field_node.h"

namespace kelpie {

/// Expands the complex primitives of several moments of one field, all as finely as the moment that asks for most: behind the
/// root stand the pieces, the same kinds in every moment, and each primitive's `expansion` says which are its own. The last node of
/// all is the union that stands above the pieces of each. What is expanded already stays.
void expand(std::span<SampledField> moments);

} // namespace kelpie
