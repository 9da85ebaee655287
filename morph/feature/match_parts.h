// Which parts of several solids are one feature.
#pragma once

#include <string>

#include "base/box.h"
#include "morph/feature/part_boxes.h"

namespace kelpie {

/// A solid with its parts.
struct PartedSolid {
  Box3d box; ///< around the solid
  std::vector<PartBox> boxes;
};

/// A feature that at least two of the solids have.
struct ProposedFeature {
  std::string name;       ///< part_a, part_b, … from below; mirror images in x are part_a_left (less x) and part_a_right
  std::vector<int> parts; ///< of each solid which of its boxes; -1: none
};

/// Matches parts by where they are in their solids and how large they are: solid by solid, the assignment of the least sum of differences.
/// What differs too much is a feature of its own.
std::vector<ProposedFeature> match_parts(const std::vector<PartedSolid>&);

/// For each row of a table the column that it gets, no column twice, so that the sum is least. There are at least as many columns as rows.
/// The Hungarian method (Kuhn 1955), by shortest augmenting paths: O(rows² columns).
std::vector<int> least_assignment(const std::vector<std::vector<double>>& cost);

} // namespace kelpie
