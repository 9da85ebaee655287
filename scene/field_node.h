// Where all lists of field kinds meet: the node of a field tree.
#pragma once

#include "base/error.h"
#include "field/kinds.h"
#include "morph/kinds.h"

namespace kelpie {

using FieldKinds = Concat<FieldFolderKinds, MorphFolderKinds>;

/// A node of a scene's field tree; its parameters may be animated.
struct FieldNode {
  FieldKinds::Variant<AnimatedMode> kind;
  SourcePosition where;
};

/// A field at one moment: nodes in post-order (children before parents; the last one is the root).
struct SampledField {
  std::vector<FieldKinds::Variant<SampledMode>> nodes;
};

/// Whether two fields are the same throughout.
bool is_equal(const SampledField&, const SampledField&);

} // namespace kelpie
