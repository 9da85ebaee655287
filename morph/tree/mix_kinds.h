// Two nodes of one kind, mixed.
#pragma once

#include <optional>

#include "base/time_map.h"
#include "morph/field_node.h"

namespace kelpie {

/// A node without its place in a tree.
using AnimatedKind = FieldKinds::Variant<AnimatedMode>;

/// Every number of it mixed: a at s = 0, b at s = 1; directions turn. Its children are those of a. None where the two are of different
/// kinds, or differ in anything that is no number that moves (a file, the length of a list, how a curve is made); falloffs may
/// differ, that of a is taken.
std::optional<AnimatedKind> mixed_kind(const AnimatedKind& a, const AnimatedKind& b, const Animated<float>& s);

/// Gives two nodes of one kind lists of equal lengths, where that changes neither: corners of hulls are repeated, one radius for all
/// becomes one for each.
void make_comparable(AnimatedKind& a, AnimatedKind& b);

/// The same with each of its numbers at another time.
AnimatedKind retimed_kind(AnimatedKind kind, const TimeMap& time);

} // namespace kelpie
