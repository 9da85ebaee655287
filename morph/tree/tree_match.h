// What becomes of what when one tree becomes another, as generic_tree() has decided it.
#pragma once

#include <optional>
#include <vector>

#include "morph/field_node.h"

namespace kelpie {

/// Why two nodes correspond.
enum class MatchedBy {
  place,      ///< they stand alike in what corresponds: the roots, what stands below two warps, what is carved, regions
  pair,       ///< one of the animorphosis's `pairs` names them, or nodes below them
  difference, ///< all correspondences of their operator together differ least so
  division,   ///< one of them was left without a counterpart, and shares that of the leaf most like it
};

/// What becomes of a node.
enum class NodeFate {
  becomes,   ///< another node, by what is between them
  exchanged, ///< they correspond, and have nothing in common: the one shrinks away while the other grows
  shrinks,   ///< it has no counterpart
  grows,     ///< it has none either, on the other side
};

/// Two nodes of both trees that correspond, or one that has no counterpart; the other is null then.
struct NodeMatch {
  FieldPtr from{}, to{};
  NodeFate fate = NodeFate::becomes;
  MatchedBy by = MatchedBy::place;
  FieldPtr from_warp{}, to_warp{};    ///< the warp right above, on the side that has come through one
  std::optional<double> difference{}; ///< difference_of() them; none where nothing was compared
  size_t from_ways = 1, to_ways = 1;  ///< into how many the node is divided, of which this is one
  Vec3 place{0};                      ///< of what shrinks or grows: where to, or where from
  size_t level = 0;                   ///< 0: the roots
  std::optional<size_t> within{};     ///< the match right above it, by its place in the list
  std::string_view between{};         ///< the kind of the node that goes from the one to the other
};

/// How two trees were matched.
struct TreeMatch {
  double frame = 0;               ///< at which their parts were compared
  std::vector<NodeMatch> nodes{}; ///< each before those below it
};

/// Where a node of the match at `index` is at a frame, in the space of both roots: `below` as the warps above its side show it.
std::vector<Box3d> in_space_of_root(const TreeMatch&, size_t index, FieldPtr NodeMatch::*warp, double frame, std::vector<Box3d> below);

/// Writes down matches while trees are descended.
class MatchLog {
public:
  /// What is added until it is closed stands below it.
  void open(NodeMatch match) {
    match.level = open_.size();
    if (!open_.empty()) match.within = open_.back();
    nodes_.push_back(std::move(match));
    open_.push_back(nodes_.size() - 1);
  }
  void close(NodeFate fate, const FieldNode& between) {
    NodeMatch& match = nodes_[open_.back()];
    match.fate = fate;
    match.between = std::visit([](const auto& kind) { return kind.k_name; }, between.kind);
    open_.pop_back();
  }

  std::vector<NodeMatch> take() { return std::move(nodes_); }

private:
  std::vector<NodeMatch> nodes_;
  std::vector<size_t> open_;
};

} // namespace kelpie
