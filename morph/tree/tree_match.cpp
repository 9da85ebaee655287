#include "morph/tree/tree_match.h"

#include "morph/tree/plain_tree.h"

namespace kelpie {

std::vector<Box3d> in_space_of_root(const TreeMatch& tree, size_t index, FieldPtr NodeMatch::*warp, double frame,
                                    std::vector<Box3d> below) {
  for (std::optional<size_t> i = index; i; i = tree.nodes[*i].within)
    if (const FieldPtr& above = tree.nodes[*i].*warp) below = boxes_of_node(*above, frame, below);
  return below;
}

} // namespace kelpie
