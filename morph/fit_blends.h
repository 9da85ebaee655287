// What fits the objects of a metamorphosis that flow into one another.
#pragma once

#include "morph/field_node.h"

namespace kelpie {

/// Finds for each two objects of the metamorphosis at `node`, and for each of its features, the unit of length of their space-time blend
/// and, unless the scene says it, the displacement with which the section halfway has the mean of their volumes (methods.md section 3),
/// in and about the element; of the background about everything. After open_distances().
void fit_blends(SampledField& field, size_t node);

} // namespace kelpie
