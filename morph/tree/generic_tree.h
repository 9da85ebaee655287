// The tree that one animated field tree and another have in common.
#pragma once

#include "morph/tree/animorphosis.h"
#include "morph/tree/plain_tree.h"
#include "morph/tree/tree_match.h"

namespace kelpie {

/// A tree, and of what it was made.
struct GenericTree {
  FieldPtr root;
  TreeMatch match;
};

/// An ordinary tree whose parameters go from those of `from` (progress 0) to those of `to` (progress 1), both as they move: at the ends its
/// field is theirs, to within their detail where generalized cylinders of other curves or numbers of points become one another. `where` is
/// that of the animorphosis, for errors. Throws an Error (bad_data) where a pair names no node, or nodes that cannot correspond. Source:
/// Barbier, Galin, Akkouche; methods.md section 2, animorphosis.
GenericTree generic_tree(const Animorphosis<AnimatedMode>&, const TreePlace& place, const SourcePosition& where);

} // namespace kelpie
