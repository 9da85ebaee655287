// The tree that one animated field tree and another have in common.
#pragma once

#include "morph/tree/animorphosis.h"
#include "morph/tree/plain_tree.h"

namespace kelpie {

/// An ordinary tree whose parameters go from those of `from` (progress 0) to those of `to` (progress 1), both as they move: at the ends its
/// field is theirs. `where` is that of the animorphosis, for errors. Throws an Error (bad_data) where a pair names no node, or nodes that
/// cannot correspond. Source: Barbier, Galin, Akkouche; methods.md section 2, animorphosis.
FieldPtr generic_tree(const Animorphosis<AnimatedMode>&, const TreePlace& place, const SourcePosition& where);

} // namespace kelpie
