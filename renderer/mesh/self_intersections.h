// Triangles of a mesh that meet where they should not.
#pragma once

#include "field/mesh/mesh.h"

namespace kelpie {

/// Places on a lattice on which arithmetic is exact: multiples of a power of two, none of them more than 2^22 steps from 0. They are float
/// numbers, too, so files hold them as they are.
class ExactLattice {
public:
  /// For places within a box.
  explicit ExactLattice(const Box3d&);
  Vec3d snapped(const Vec3d& p) const { return step_ * glm::round(p / step_); }
  double step() const { return step_; }

private:
  double step_ = 1;
};

/// Two triangles, by index.
using TrianglePair = std::pair<uint32_t, uint32_t>;

/// All pairs of triangles that have more in common than the vertices they share: points, or all of themselves where they are folded onto
/// one another. Triangles without an area are in pairs with themselves. Exact for positions on the lattice. In ascending order. Runs in the
/// current TBB arena.
std::vector<TrianglePair> self_intersections(const Mesh&, const ExactLattice&);

} // namespace kelpie
