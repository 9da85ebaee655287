// Complex primitives become unions of skeletons.
#pragma once

#include <span>

#include "morph/field_node.h"

namespace kelpie {

/// Expands the complex primitives of several moments of one field, all as finely as the moment that asks for most: behind the
/// root stand the pieces, the same kinds in every moment, and each primitive's `expansion` says which are its own; the union that
/// stands above those of each is `union_of_pieces`. What is expanded already stays.
void expand(std::span<SampledField> moments);

} // namespace kelpie
