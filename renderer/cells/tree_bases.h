// Where the leaves of a tree are computed from.
#pragma once

#include <utility>
#include <vector>

#include "renderer/cells/tree.h"

namespace kelpie {

/// The world, or a warped space that is a base of others.
struct TreeBase {
  uint32_t slot = 0;    ///< as leaf_space has it
  Vec3d centre;         ///< of the cell, as the solvers have it
  double turning = 0;   ///< how much the derivative of the map from the world differs within the cell, at most
  double bending = 0;   ///< half the largest second derivative of that map
  double lipschitz = 1; ///< a Lipschitz constant of that map
};

/// A Lipschitz constant of a linear map: at least its largest singular value, and that for similarities.
double lipschitz(const Mat3d&);

/// The bases of a tree, each found when it is first asked for.
class TreeBases {
public:
  /// `centre`: of the cell. The warped spaces are added to `out`.
  TreeBases(const FieldProgram& program, const Box3& cell, const Vec3& centre, Tree& out)
      : program_(program), cell_(cell), centre_(centre), out_(out) {}

  /// The base of a space, and the affine map from there; false if the map from the world is too far from linear.
  bool find(uint32_t space, TreeBase&, Affine& local_from_base);

private:
  void find_bending(const Space& warp, const TreeBase& parent, double lipschitz_between, TreeBase& base) const;
  Box3d box_before(const Space& warp) const;

  const FieldProgram& program_;
  const Box3& cell_;
  Vec3 centre_;
  Tree& out_;
  std::vector<std::pair<uint32_t, TreeBase>> known_; ///< but the world
};

} // namespace kelpie
