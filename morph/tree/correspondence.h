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

/// All parts of a side.
Box3d box_around(const std::vector<MatchedPart>&);

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

/// Each with that of the same place, as many as the shorter list has.
std::vector<PartLink> links_in_order(size_t from, size_t to);

/// Of one leaf several come, or several become one: a leaf without a counterpart shares that of the leaf most like it.
void divide_leaves(std::vector<PartLink>& links, const std::vector<MatchedPart>& from, const std::vector<MatchedPart>& to);

/// Where a part without a counterpart comes from, or goes to: the place in it that is nearest to the nearest part that has one, and how
/// that moves on to where its counterpart is.
struct Anchor {
  Vec3 place{0}, drift{0};
};

/// How far it is from the middle of one box to that of another; 0 where one of them has no end.
Vec3 drift_between(const Box3d& from, const Box3d& to);

/// The anchor of a part of its `own` side; `side` is the member of links that is its own.
Anchor anchor_of(const MatchedPart& part, const std::vector<MatchedPart>& own, const std::vector<MatchedPart>& others,
                 const std::vector<PartLink>& links, size_t PartLink::*side);

} // namespace kelpie
