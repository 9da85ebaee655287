// How far a surface is that is known by samples near it only.
#pragma once

#include "field/distances/distance_grid.h"
#include "field/skeletons/frame.h"

namespace kelpie {

/// The distances of a DistanceGrid go on beyond its band: on a second lattice of four times the voxels, and beyond that by the way to its
/// box. Where the surface is they change nothing; far from it they are off by about a coarse voxel.
class FarDistances {
public:
  /// Uses all threads.
  explicit FarDistances(const DistanceGrid& near);

  /// The signed distance at p, given what the grid says there: for double, Interval and Dual.
  template <class Real>
  Real extend(const Real& near, const Point3<Real>& p) const {
    const Real zero(0.0), far = at(p);
    return near + max(zero, far - Real(band_)) + min(zero, far + Real(band_));
  }

private:
  template <class Real>
  Real at(const Point3<Real>& p) const {
    const Box3d& box = coarse_.box();
    const Point3<Real> c{clamp(p.x, box.lower.x, box.upper.x), clamp(p.y, box.lower.y, box.upper.y), clamp(p.z, box.lower.z, box.upper.z)};
    return distance_in(coarse_, c) + norm(norm(p.x - c.x, p.y - c.y), p.z - c.z);
  }

  double band_; ///< of the grid near the surface
  DistanceGrid coarse_;
};

} // namespace kelpie
