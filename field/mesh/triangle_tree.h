// Questions about a place and all triangles of a mesh: how far the nearest is, and how often they wind around it.
#pragma once

#include "field/mesh/mesh.h"

namespace kelpie {

/// From p to the nearest point of a triangle.
double distance_to_triangle(const std::array<Vec3d, 3>&, const Vec3d& p);

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

  /// Calls visit(index) for each triangle of the mesh whose box meets this one.
  template <class Visit>
  void for_each_near(const Box3d& box, Visit&& visit) const {
    std::vector<uint32_t> stack{0};
    while (!stack.empty()) {
      const Node& node = nodes_[stack.back()];
      stack.pop_back();
      if (intersect(node.box, box).is_empty()) continue;
      if (node.count == 0 && nodes_.size() > 1) {
        stack.push_back(node.first), stack.push_back(node.first + 1);
        continue;
      }
      for (uint32_t i = node.first; i < node.first + node.count; ++i) {
        Box3d of_triangle;
        for (const Vec3d& corner : triangles_[i].corners) of_triangle.extend(corner);
        if (!intersect(of_triangle, box).is_empty()) visit(triangles_[i].index);
      }
    }
  }

  /// How far a ray goes until it first meets a triangle from behind; infinite where it meets none. `direction` is of unit length;
  /// triangles count of which the normal's cosine with it is at least `least_cosine`.
  double way_out(const Vec3d& origin, const Vec3d& direction, double least_cosine) const;

private:
  struct Placed {
    std::array<Vec3d, 3> corners;
    uint32_t index; ///< in the mesh
  };
  struct Node {
    Box3d box;
    Vec3d centre{0}, area{0}; ///< the mean place of the triangles by their areas; the sum of their vector areas
    double radius = 0;        ///< of a ball around `centre` that holds them
    uint32_t first = 0;       ///< of a leaf its first corner's index / 3; else the first child, whose sibling follows
    uint32_t count = 0;       ///< triangles of a leaf; 0: no leaf
  };

  void build(uint32_t node, size_t first, size_t count, int depth);
  double solid_angle(const Node&, const Vec3d& p) const;

  std::vector<Placed> triangles_;
  std::vector<Node> nodes_;
};

} // namespace kelpie
