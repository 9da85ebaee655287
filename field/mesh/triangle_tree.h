// Questions about a place and all triangles of a mesh: how far the nearest is, and how often they wind around it.
#pragma once

#include "field/mesh/mesh.h"

namespace kelpie {

/// A tree of boxes over triangles.
class TriangleTree {
public:
  /// Copies what it needs.
  explicit TriangleTree(const Mesh&);

  /// From p to the nearest point of the nearest triangle, or `most` if that is farther. In units of the file, relative to the
  /// mesh's origin, as p.
  double distance(const Vec3d& p, double most) const;

  /// The generalised winding number (Jacobson, Kavan, Sorkine-Hornung 2013): 1 inside a closed mesh, 0 outside, smooth across holes.
  /// Far clusters of triangles count as one dipole each (Barill et al. 2018, "Fast winding numbers for soups and clouds"), which
  /// errs by less than 0.05.
  double winding(const Vec3d& p) const;

private:
  struct Node {
    Box3d box;
    Vec3d centre{0}, area{0}; ///< the mean place of the triangles by their areas; the sum of their vector areas
    double radius = 0;        ///< of a ball around `centre` that holds them
    uint32_t first = 0;       ///< of a leaf its first corner's index / 3; else the first child, whose sibling follows
    uint32_t count = 0;       ///< triangles of a leaf; 0: no leaf
  };

  void build(uint32_t node, size_t first, size_t count, int depth);
  double solid_angle(const Node&, const Vec3d& p) const;

  std::vector<std::array<Vec3d, 3>> triangles_;
  std::vector<Node> nodes_;
};

} // namespace kelpie
