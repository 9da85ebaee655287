// Space around a solid, divided where its surface is.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "renderer/mesh/solid.h"

namespace kelpie {

/// Cubes in one another. Places are counted in ticks, half the side of the smallest cube that there may be, from the root's lower corner.
class Octree {
public:
  using Place = std::array<uint32_t, 3>;

  struct Cell {
    uint32_t first_child = 0; ///< of eight, side by side, x fastest; 0: a leaf
    uint32_t code = 0;        ///< what matters there
    bool is_proved = false;   ///< of a leaf: it is empty or full
    bool is_crossed = false;  ///< of a leaf: samples show the surface in it
  };
  struct Leaf {
    uint32_t cell;
    Place lower;
    uint32_t side; ///< ticks
  };

  /// Divides a solid's bounds until in each leaf the surface is flat but for `tolerance` by samples of its normals, and is proved to be one
  /// sheet, or the leaf is so small (a 128th of the whole, or four tolerances) that samples count; or until the leaf is smaller than the
  /// tolerance. What is proved to be empty or full is not divided; what shows no surface and is not proved is divided once more, and made
  /// whole again where nothing was found. Runs in the current TBB arena; does not depend on the number of threads. Throws Error,
  /// out_of_memory, where there would be too many cells. The tolerance must be a 65,536th of the bounds' longest side or more: places are
  /// 20 bits.
  Octree(const Solid&, double tolerance);

  /// All leaves that are not proved.
  const std::vector<Leaf>& leaves() const { return leaves_; }
  /// Whether the cube of this side (ticks) around a place has children.
  bool is_divided(const Place& place, uint32_t side) const;
  /// What matters at a place, and at what is no further than a smallest cell.
  const Code& code_at(const Place&) const;
  Vec3d position(const Place& p) const { return origin_ + tick_ * Vec3d(p[0], p[1], p[2]); }
  double tick() const { return tick_; }

private:
  struct Decision;
  Decision decide(const Leaf&) const;
  void divide(std::vector<Leaf> frontier);
  void make_whole();
  void find_leaves(const Leaf& within);
  Leaf child_of(const Leaf& parent, uint32_t child) const;
  Box3d box_of(const Leaf&) const;
  /// Goes down to the cell of a side around a place, or the leaf that holds it.
  const Cell& find(const Place&, uint32_t side, uint32_t& found_side) const;

  const Solid& solid_;
  double tolerance_, tick_ = 1;
  Vec3d origin_{0};
  uint32_t root_side_ = 2;
  std::vector<Cell> cells_;
  std::vector<Code> codes_;
  std::vector<Leaf> leaves_;
};

} // namespace kelpie
