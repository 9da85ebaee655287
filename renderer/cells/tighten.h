// The part of a cell's box that holds its surface: rays that pass by it need not be solved.
#pragma once

#include "renderer/cells/cells.h"

namespace kelpie {

/// A part of a slab's time, which is 0 to 1.
struct TimeSpan {
  float start = 0, end = 1;
};

/// The box, cut back to where a sum of blobs may reach the threshold in that time; empty if it does nowhere. Not for blobs whose
/// radii or weights change.
Box3 tightened_to_blobs(const Box3&, BlobList, double threshold, TimeSpan = {});

/// The same for the tree of a cell, of which the box is a part; places of the tree count from `centre`.
Box3 tightened_to_tree(const Box3&, const TreeView&, const Vec3& centre, double threshold);

} // namespace kelpie
