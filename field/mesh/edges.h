// The edges of a triangle mesh and who shares them.
#pragma once

#include <vector>

#include "field/mesh/mesh.h"

namespace kelpie {

/// One side of a triangle: it runs from `low` to `high` (low < high) or, where `is_reversed`, back.
struct HalfEdge {
  uint32_t low, high, triangle;
  bool is_reversed;
};

/// All half edges, those of one edge side by side, in ascending order of (low, high, triangle).
std::vector<HalfEdge> sorted_half_edges(const std::vector<Triangle>&);

/// Calls `visit(first, last)` with the range of half edges of each edge.
template <class Visit>
void for_each_edge(const std::vector<HalfEdge>& halves, Visit&& visit) {
  for (size_t i = 0; i < halves.size();) {
    size_t j = i + 1;
    while (j < halves.size() && halves[j].low == halves[i].low && halves[j].high == halves[i].high) ++j;
    visit(halves.data() + i, halves.data() + j);
    i = j;
  }
}

} // namespace kelpie
