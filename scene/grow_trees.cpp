#include "scene/grow_trees.h"

#include <map>
#include <set>

#include "morph/tree/generic_tree.h"

namespace kelpie {

namespace {

class Grower {
public:
  Grower(const std::vector<ReadTreeMaker>& makers, ProblemList& problems) : problems_(problems) {
    for (const ReadTreeMaker& maker : makers) makers_.emplace(maker.node.get(), &maker);
  }

  /// All trees below a node, from the innermost one.
  void grow(FieldNode& node, TreePlace place) {
    if (!seen_.insert(&node).second) return;
    if (node.material) place.material = node.material;
    TreePlace below = place;
    below.is_below_blend |= joins_by_value(node.kind);
    const auto follow = [&]<class Edge>(Edge& edge, const ParameterRules&) {
      if constexpr (std::is_same_v<Edge, PartReference>)
        grow(*edge.target, below);
      else
        grow(*edge, below);
    };
    std::visit([&](auto& kind) { for_each_edge(kind, follow); }, node.kind);
    if (const auto maker = makers_.find(&node); maker != makers_.end()) replace(node, maker->second->kind, place);
  }

private:
  void replace(FieldNode& node, const Animorphosis<AnimatedMode>& kind, const TreePlace& place) {
    try {
      const FieldPtr tree = generic_tree(kind, place, node.where);
      node.kind = tree->kind;
      if (tree->material) node.material = tree->material;
    } catch (const Error& e) {
      problems_.add(e, node.where);
    }
  }

  ProblemList& problems_;
  std::map<const FieldNode*, const ReadTreeMaker*> makers_;
  std::set<const FieldNode*> seen_;
};

} // namespace

void grow_trees(const std::vector<ReadTreeMaker>& makers, Scene& scene, ProblemList& problems) {
  if (makers.empty()) return;
  Grower grower(makers, problems);
  for (const Shape& shape : scene.shapes)
    for (const FieldPtr& tree : {shape.field, shape.texture})
      if (tree) grower.grow(*tree, {shape.threshold, false, shape.surface});
}

} // namespace kelpie
