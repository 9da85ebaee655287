// Which child of one operator becomes which of another.
#pragma once

#include "morph/field_node.h"

namespace kelpie {

/// A child of an operator as it is matched.
struct MatchedPart {
  const FieldNode* node = nullptr;
  Box3d box;
  size_t leaves = 1;
  Vec3 colour{0}; ///< the mean of what its leaves are made of
};

/// Two children that correspond, by their places in their lists.
struct PartLink {
  size_t from, to;
  friend bool operator==(const PartLink&, const PartLink&) = default;
};

/// How much two parts differ: in place and size within all parts of their side, kind, name, number of leaves, and colour; 0: not at
/// all.
double difference_of(const MatchedPart& a, const MatchedPart& b, const Box3d& around_a, const Box3d& around_b);

/// The links that are forced, and of what has none the assignment of least difference: as many links as the shorter list allows. Those
/// that remain are in no link.
std::vector<PartLink> match_children(const std::vector<MatchedPart>& from, const std::vector<MatchedPart>& to,
                                     const std::vector<PartLink>& forced);

} // namespace kelpie
