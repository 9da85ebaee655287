// What two leaves have in common.
#pragma once

#include "morph/field_node.h"
#include "morph/tree/skeleton_graph.h"

namespace kelpie {

/// How two leaves of a plain tree become one another: as one kind if they are, else through the graph of skeletons; none where there is
/// no way.
std::optional<SkeletonPath> common_path(const AnimatedKind& a, const AnimatedKind& b);

/// A leaf, or a blend of leaves, that is `a` at s = 0 and `b` at s = 1, made of `material`; null where there is no way. Where the two
/// only have a thinner skeleton in common their volume is kept on the way, measured as they are at `frame`.
FieldPtr leaf_between(const FieldNode& a, const FieldNode& b, const Animated<float>& s, const AnimatedMode::Material& material,
                      double frame);

} // namespace kelpie
