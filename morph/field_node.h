// Where all lists of field kinds meet: the node of a field tree.
#pragma once

#include "base/error.h"
#include "base/table.h"
#include "field/kinds.h"
#include "morph/kinds.h"

namespace kelpie {

using FieldKinds = Concat<FieldFolderKinds, MorphFolderKinds>;

/// A node of a scene's field tree; its parameters may be animated.
struct FieldNode {
  FieldKinds::Variant<AnimatedMode> kind;
  SourcePosition where;
  /// What it and all below it is made of, but for what has a material of its own; null: what is above it says so.
  AnimatedMode::Material material;
  /// What correspondences call it; empty: nothing.
  std::string name{};
};

using FieldPtr = AnimatedMode::Child;

/// A field at one moment: nodes in post-order (children before parents; the last one is the root), as FieldFold visits those that they
/// were sampled from. Instances of one part in one time share its nodes.
struct SampledField {
  std::vector<FieldKinds::Variant<SampledMode>> nodes;
  /// Of each node what it is made of, if it says so; empty where none does.
  std::vector<MaterialIndex> materials;
  /// As many nodes stand behind the root: what complex primitives were expanded to (renderer/program/expand.h).
  size_t piece_count = 0;
  /// Where there are pieces, the node of the union that stands above those of each primitive.
  uint32_t union_of_pieces = 0;

  size_t root() const { return nodes.size() - piece_count - 1; }
};

/// Whether two fields are the same throughout; expanded or not.
bool is_equal(const SampledField&, const SampledField&);

} // namespace kelpie
