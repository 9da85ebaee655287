// Trees that are solved in SIMD lanes: operators over skeletons, under any warps. A cell holds its pruned tree.
#pragma once

#include <optional>
#include <vector>

#include "renderer/lanes/tree_view.h"
#include "renderer/program/evaluate.h"

namespace kelpie {

/// A tree by itself.
struct Tree {
  std::vector<TreeStep> steps;
  std::vector<TreeSpace> spaces;
  std::vector<float> leaves; ///< by rows
  std::vector<SolidLeaf> solids;
  std::vector<SolidPart> parts;
  std::vector<SolidEdge> edges;
  std::vector<LaneAxis> axes;
  TreeTraits traits;
  uint32_t leaf_count = 0; ///< with padding

  /// As it was made, but its room stays.
  void clear() {
    steps.clear(), spaces.clear(), leaves.clear(), solids.clear(), parts.clear(), edges.clear(), axes.clear();
    traits = {}, leaf_count = 0;
  }
  TreeView view() const { return {steps, spaces, leaves.data(), leaf_count, traits, {solids, parts.data(), edges.data()}, axes.data()}; }
};

/// Where warps turn rays more than this within a cell (at kinks and tears, mostly), bounds by tangents are loose: it is no tree.
inline constexpr double k_most_drift = 1;

/// How much the derivative of the map from the world to a space differs within a box, at most (Frobenius norm);
/// infinite where the map is not continuous. In a box where it is large a ray is far from a line.
double turning(const FieldProgram& program, uint32_t space, const Box3& box);

/// The tree of a cell, or nothing if `code` has a step that no tree has. `centre`: whence its places count.
std::optional<Tree> make_tree(const FieldProgram& program, const CodeView& code, const Box3& cell, const Vec3& centre);
/// The same in a tree that is there; false, and it is anything, if there is none.
bool make_tree(const FieldProgram& program, const CodeView& code, const Box3& cell, const Vec3& centre, Tree&);

/// Of a program in motion (renderer/program/motion.h): a tree whose leaves reach, anywhere in the cell, at least as far as they do at any
/// time of the slab. So its bounds hold at all times; its values mean nothing. Nothing where no such tree is known (widening.h).
std::optional<Tree> make_wide_tree(const FieldProgram& slab, const CodeView& code, const Box3& cell, const Vec3& centre);

} // namespace kelpie
