// The distances that a metamorphosis mixes.
#pragma once

#include "morph/field_node.h"

namespace kelpie {

/// Gives all distances below the metamorphosis at `node` one reach, in its own units, which is larger than everything there: as far as
/// anybody looks, each is then T (1 - d / reach). Booleans among them become maxima and minima. Nothing else may refer to those nodes.
void open_distances(SampledField& field, size_t node);

/// Around an object of a metamorphosis as it stands, and its elements.
Box3d object_box(const SampledField& field, const MorphObject<SampledMode>& object);

} // namespace kelpie
