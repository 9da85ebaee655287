// Which skeletons are special cases of which, and how one becomes another.
#pragma once

#include <optional>
#include <string>

#include "morph/tree/mix_kinds.h"

namespace kelpie {

/// How two skeletons become one another: in one or two stages, in each of which one kind changes its parameters.
struct SkeletonPath {
  struct Stage {
    AnimatedKind from, to; ///< of one kind, with lists of equal lengths
  };
  std::vector<Stage> stages; ///< the end of the first is the same solid as the beginning of the second
  double cost = 0;
};

/// The cheapest path from one skeleton to another: within a kind that has both as special cases, or through a special case of both.
/// Their radii of influence, weights and falloffs are as at the ends. None where a kind is no skeleton of the graph. Source: Galin,
/// Leclercq, Akkouche, "Morphing the BlobTree", 2000: the graph of skeletons.
std::optional<SkeletonPath> skeleton_path(const AnimatedKind& from, const AnimatedKind& to);

/// The graph, for Graphviz.
std::string skeleton_graph_dot();

} // namespace kelpie
