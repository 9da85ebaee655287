// How much liquid a cloud of blobs is.
#pragma once

#include <vector>

#include "field/potential/blob.h"

namespace kelpie {

/// The shape {f > 1} of a cloud, to about a hundredth of its size.
struct CloudExtent {
  Box3 box;          ///< empty where there is no such shape
  Box3 bulk;         ///< along each axis without the outermost hundredth of the volume at either end
  double volume = 0; ///< cubic scene units
};

/// Samples the sum of a cloud's potentials on a fixed grid over `box`, so that clouds are compared on
/// the same points. The same cloud yields the same numbers on every machine and thread.
class VolumeGrid {
public:
  /// About `cells` cubic cells.
  VolumeGrid(const Box3& box, size_t cells);

  /// The volume where the sum exceeds 1, in cells (fractions count).
  double volume(const BlobCloud&) const;
  /// The factor of all weights that makes `volume` be `wanted` (within [1/64, 64]).
  double gain_for_volume(const BlobCloud&, double wanted) const;

  /// Where the sum exceeds 1.
  CloudExtent extent(const BlobCloud&) const;

  /// Calls `visit(lower, upper)` with the corners of each cell in which the sum exceeds 1.
  template <class Visit>
  void for_each_cell_inside(const BlobCloud& cloud, Visit&& visit) const {
    const std::vector<float> sums = potentials(cloud);
    size_t i = 0;
    for (size_t z = 0; z < count_[2]; ++z)
      for (size_t y = 0; y < count_[1]; ++y)
        for (size_t x = 0; x < count_[0]; ++x) {
          if (!(sums[i++] > 1)) continue;
          const Vec3 p = origin_ + step_ * Vec3(x, y, z);
          visit(p - 0.5f * step_, p + 0.5f * step_);
        }
  }

private:
  std::vector<float> potentials(const BlobCloud&) const;

  Vec3 origin_; ///< centre of the first cell
  float step_;
  size_t count_[3];
};

/// On a grid of its own.
CloudExtent extent_of(const BlobCloud&);

/// Some thousand points spread evenly over the shape {f > 1}: what a camera must hold.
std::vector<Vec3> points_inside(const BlobCloud&);

} // namespace kelpie
