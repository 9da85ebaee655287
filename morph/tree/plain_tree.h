// Trees in which nothing depends on what is around them: what can be taken apart and put together otherwise.
#pragma once

#include "morph/field_node.h"

namespace kelpie {

/// Whether an operator of several operands depends on their values, not only on their surfaces: Booleans below it are smooth.
bool joins_by_value(const FieldKinds::Variant<AnimatedMode>& kind);

/// Where a tree stands.
struct TreePlace {
  Animated<float> threshold{1.f};  ///< of its shape
  bool is_below_blend = false;     ///< then Booleans are smooth unless they say otherwise
  AnimatedMode::Material material; ///< of what has none of its own; not null
};

/// A copy of a tree without references, in one time: instances are affine warps above copies of their parts, numbers and materials are
/// retimed, Booleans have the formula that they would have chosen, a `surface_radius` is the radius that it stands for, and materials stand
/// on leaves, or patterns, which live in a space, on the warps that change it. Throws an Error (bad_data) where that would be more than
/// k_most_plain_nodes.
FieldPtr plain_tree(const FieldNode& root, const TreePlace& place);
inline constexpr size_t k_most_plain_nodes = 20'000;

/// A copy of a plain tree whose leaves have weights that are multiplied by a factor; null if one has no weight.
FieldPtr weighted_tree(const FieldNode& root, const Animated<float>& factor);

/// The children of a node, in the order of its table.
std::vector<FieldPtr> children_of(const FieldNode& node);

/// Around where the field of a plain tree may differ from 0, at a frame.
Box3d box_of_tree(const FieldNode& root, double frame);

/// Around what a node makes of what is below it: of a leaf its pieces, of a warp the images of `below`, of an operator `below` itself.
std::vector<Box3d> boxes_of_node(const FieldNode&, double frame, const std::vector<Box3d>& below);

/// Those of all leaves of a plain tree.
std::vector<Box3d> boxes_of_tree(const FieldNode& root, double frame);

size_t leaf_count(const FieldNode& root);

} // namespace kelpie
