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

/// Calls visit(child) for every node right below one; not for what an instance refers to. A child that could not be read is
/// null.
template <class Visit>
void for_each_child(const FieldNode& node, Visit&& visit) {
  const auto one = [&](const auto& member) {
    if constexpr (std::is_same_v<decltype(member), const FieldPtr&>)
      visit(member);
    else if constexpr (std::is_same_v<decltype(member), const std::vector<FieldPtr>&>)
      for (const FieldPtr& child : member) visit(child);
  };
  std::visit([&](const auto& kind) { std::apply([&](const auto&... row) { (one(kind.*(row.member)), ...); }, kind.parameters()); },
             node.kind);
}

/// A field at one moment: nodes in post-order (children before parents; the last one is the root). Instances of one part and
/// one time offset share its nodes.
struct SampledField {
  std::vector<FieldKinds::Variant<SampledMode>> nodes;
  /// As many nodes stand behind the root: what complex primitives were expanded to (renderer/program/expand.h).
  size_t piece_count = 0;

  size_t root() const { return nodes.size() - piece_count - 1; }
};

/// Whether two fields are the same throughout; expanded or not.
bool is_equal(const SampledField&, const SampledField&);

} // namespace kelpie
