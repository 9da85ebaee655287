// An octree's leaves, cut into tetrahedra that fit together.
#pragma once

#include "renderer/mesh/octree.h"

namespace kelpie {

/// The tetrahedra of a leaf: each has as corners the middle of the leaf, that of a face, that of an edge of the face, and an end of the
/// edge; faces and edges are the smallest of all leaves that share them, so that tetrahedra of neighbours meet in whole faces
/// whatever the leaves' sizes (Manson and Schaefer, "Isosurfaces over simplicial partitions of multiresolution grids", 2010).
class CellTetrahedra {
public:
  using Place = Octree::Place;

  explicit CellTetrahedra(const Octree& octree) : octree_(octree) {}

  /// Calls `visit(std::array<Place, 4>)` for each.
  template <class Visit>
  void for_each(const Octree::Leaf& leaf, Visit&& visit) const {
    const Place middle = moved(leaf.lower, leaf.side / 2, leaf.side / 2, leaf.side / 2);
    for (unsigned axis = 0; axis < 3; ++axis)
      for (const bool is_upper : {false, true}) {
        Place corner = leaf.lower;
        if (is_upper) corner[axis] += leaf.side;
        divide_face({axis, is_upper}, corner, leaf.side, [&](const Place& face, const Place& edge, const Place& end) {
          visit(std::array<Place, 4>{middle, face, edge, end});
        });
      }
  }

private:
  struct Side {
    unsigned axis;
    bool is_upper;
    /// A plane's coordinate just beyond it; below 0 it wraps around to a large one.
    uint32_t beyond(uint32_t plane) const { return is_upper ? plane : plane - 1; }
    uint32_t before(uint32_t plane) const { return is_upper ? plane - 1 : plane; }
  };

  static Place moved(Place p, uint32_t x, uint32_t y, uint32_t z) { return {p[0] + x, p[1] + y, p[2] + z}; }

  template <class Visit>
  void divide_face(Side side, const Place& corner, uint32_t length, const Visit& visit) const {
    const unsigned u = (side.axis + 1) % 3, v = (side.axis + 2) % 3;
    Place middle = corner;
    middle[u] += length / 2, middle[v] += length / 2;
    Place beyond = middle;
    beyond[side.axis] = side.beyond(corner[side.axis]);
    if (octree_.is_divided(beyond, length)) {
      for (unsigned quarter = 0; quarter < 4; ++quarter) {
        Place sub = corner;
        sub[u] += (quarter & 1) * length / 2, sub[v] += (quarter >> 1) * length / 2;
        divide_face(side, sub, length / 2, visit);
      }
      return;
    }
    for (const unsigned along : {u, v})
      for (const bool is_upper : {false, true}) {
        const unsigned across = along == u ? v : u;
        Place start = corner;
        if (is_upper) start[across] += length;
        divide_edge(side, {across, is_upper}, along, start, length, [&](const Place& edge, const Place& end) { visit(middle, edge, end); });
      }
  }

  /// Of the four cells around the edge those on this side of `across` are no smaller than it.
  template <class Visit>
  void divide_edge(Side side, Side across, unsigned along, const Place& start, uint32_t length, const Visit& visit) const {
    Place middle = start, end = start;
    middle[along] += length / 2, end[along] += length;
    Place near = middle, far = middle;
    near[across.axis] = far[across.axis] = across.beyond(start[across.axis]);
    near[side.axis] = side.before(start[side.axis]), far[side.axis] = side.beyond(start[side.axis]);
    if (octree_.is_divided(near, length) || octree_.is_divided(far, length)) {
      divide_edge(side, across, along, start, length / 2, visit);
      divide_edge(side, across, along, middle, length / 2, visit);
      return;
    }
    visit(middle, start);
    visit(middle, end);
  }

  const Octree& octree_;
};

} // namespace kelpie
