// Boxes around the parts of a solid: proposals for the elements of a metamorphosis.
#pragma once

#include <vector>

#include "field/distances/distance_grid.h"

namespace kelpie {

struct PartBox {
  Vec3d centre{0}, size{1};
  Mat3d axes{1.0}; ///< orthonormal, as near to those of the space as the box allows
};

/// Divides the inside of a solid, as voxels of a 72nd of its longest side, by planes across its axes: each time where the boxes
/// around what is left, piece by piece, have the least volume, as long as that makes it much less. So legs, a seat and a back part. Pieces
/// whose common box is hardly larger than theirs are joined again. Larger ones first; none of what has no inside on the grid.
std::vector<PartBox> part_boxes(const DistanceGrid&);

} // namespace kelpie
