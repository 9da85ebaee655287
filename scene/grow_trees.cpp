#include "scene/grow_trees.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "morph/field_fold.h"
#include "morph/tree/generic_tree.h"

namespace kelpie {

namespace {

size_t node_count(const FieldNode& root) {
  size_t count = 1;
  for (const FieldPtr& child : children_of(root)) count += node_count(*child);
  return count;
}

/// The names of the shapes in which each maker stands.
std::map<const FieldNode*, std::vector<std::string>> shapes_of(const std::vector<ReadTreeMaker>& makers, const Scene& scene) {
  std::map<const FieldNode*, std::vector<std::string>> shapes;
  for (const Shape& shape : scene.shapes) {
    std::set<const FieldNode*> nodes;
    const auto collect = [&](const FieldNode& node, const auto&...) { return nodes.insert(&node).second; };
    for (const FieldPtr& tree : {shape.field, shape.texture}) {
      FieldFold<char> fold(PartsShared::always);
      if (tree) fold(*tree, collect);
    }
    for (const ReadTreeMaker& maker : makers)
      if (nodes.count(maker.node.get())) shapes[maker.node.get()].push_back(shape.name);
  }
  return shapes;
}

/// Says where a progress is farthest outside [0, 1] in the frames of a scene.
void warn_of_overshoot(const Animated<float>& progress, const Frames& frames, const SourcePosition& where, Diagnostics& diagnostics) {
  constexpr int k_most_looks = 4000;
  std::vector<double> looks = progress.frames();
  const int count = progress.is_constant() ? 1 : std::min(k_most_looks, 1 + 4 * (frames.last - frames.first));
  for (int i = 0; i < count; ++i) looks.push_back(frames.first + (frames.last - frames.first) * double(i) / std::max(count - 1, 1));
  double farthest = 1e-4, at = 0; // a rounding is none
  float there = 0;
  for (const double frame : looks) {
    const float s = progress.at(frame);
    const double outside = double(std::max(-s, s - 1));
    if (outside > farthest) farthest = outside, at = frame, there = s;
  }
  if (there != 0)
    diagnostics.warning(where,
                        fmt::format("progress leaves [0, 1]: {:.4g} at frame {:.4g}; places and directions overshoot, all else stays as "
                                    "it is at that end",
                                    there, at));
}

class Grower {
public:
  Grower(const std::vector<ReadTreeMaker>& makers, const Frames& frames, ProblemList& problems, Diagnostics& diagnostics)
      : frames_(frames), problems_(problems), diagnostics_(diagnostics) {
    for (const ReadTreeMaker& maker : makers) makers_.emplace(maker.node.get(), &maker);
  }

  /// All trees below a node, from the innermost one.
  void grow(FieldNode& node, const TreePlace& place) { depth_of(node, place); }

  /// What was grown.
  std::vector<GrownTree> take() { return std::move(grown_); }

private:
  /// How many makers stand in one another below it, this one included. Each asks the one below it for twice as many values.
  static constexpr int k_most_deep = 6;
  /// Of all trees together.
  static constexpr size_t k_most_nodes = 1'000'000;

  int depth_of(FieldNode& node, TreePlace place) {
    const auto [known, is_new] = depths_.try_emplace(&node, 0);
    if (!is_new) return known->second;
    int deepest = 0;
    if (node.material) place.material = node.material;
    TreePlace below = place;
    below.is_below_blend |= joins_by_value(node.kind);
    const auto follow = [&]<class Edge>(Edge& edge, const ParameterRules&) {
      FieldNode* child;
      if constexpr (std::is_same_v<Edge, PartReference>)
        child = edge.target.get();
      else
        child = edge.get();
      deepest = std::max(deepest, depth_of(*child, below));
    };
    std::visit([&](auto& kind) { for_each_edge(kind, follow); }, node.kind);
    if (const auto maker = makers_.find(&node); maker != makers_.end()) {
      if (++deepest > k_most_deep)
        problems_.add(node.where, fmt::format("more than {} animorphoses in one another", k_most_deep));
      else if (count_ <= k_most_nodes)
        replace(*maker->second, place);
    }
    return depths_[&node] = deepest;
  }

  void replace(const ReadTreeMaker& maker, const TreePlace& place) {
    FieldNode& node = *maker.node;
    try {
      const auto [root, match] = generic_tree(maker.kind, place, node.where);
      warn_of_overshoot(maker.kind.progress, frames_, node.where, diagnostics_);
      for (const auto& pair : maker.kind.pairs)
        if (pair.progress) warn_of_overshoot(*pair.progress, frames_, pair.where, diagnostics_);
      node.kind = root->kind;
      if (root->material) node.material = root->material;
      grown_.push_back({maker.node, {}, match});
      if ((count_ += node_count(*root)) > k_most_nodes)
        problems_.add(node.where, fmt::format("the trees of all animorphoses have more than {} nodes", k_most_nodes));
    } catch (const Error& e) {
      problems_.add(e, node.where);
    }
  }

  const Frames frames_;
  ProblemList& problems_;
  Diagnostics& diagnostics_;
  std::map<const FieldNode*, const ReadTreeMaker*> makers_;
  std::map<const FieldNode*, int> depths_;
  std::vector<GrownTree> grown_;
  size_t count_ = 0;
};

} // namespace

std::vector<GrownTree> grow_trees(const std::vector<ReadTreeMaker>& makers, Scene& scene, ProblemList& problems, Diagnostics& diagnostics) {
  if (makers.empty()) return {};
  const auto shapes = shapes_of(makers, scene);
  Grower grower(makers, scene.frames, problems, diagnostics);
  for (const Shape& shape : scene.shapes)
    for (const FieldPtr& tree : {shape.field, shape.texture})
      if (tree) grower.grow(*tree, {shape.threshold, false, shape.surface});
  std::vector<GrownTree> grown = grower.take();
  for (GrownTree& tree : grown) tree.shapes = shapes.at(tree.root.get());
  return grown;
}

} // namespace kelpie
