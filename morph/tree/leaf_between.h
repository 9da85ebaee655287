// What two leaves have in common.
#pragma once

#include "morph/field_node.h"
#include "morph/tree/mix_kinds.h"

namespace kelpie {

/// Of two leaves of a plain tree one or two skeletons that go from the one to the other (two where they meet in a special case of both: the
/// one has weight before that, the other after); none where there is no way. Their falloff is that of `a`.
std::vector<AnimatedKind> common_solids(const AnimatedKind& a, const AnimatedKind& b, const Animated<float>& s);

/// A leaf, or a blend of leaves, that is `a` at s = 0 and `b` at s = 1, made of `material`; null where there is no way.
FieldPtr leaf_between(const FieldNode& a, const FieldNode& b, const Animated<float>& s, const AnimatedMode::Material& material);

} // namespace kelpie
