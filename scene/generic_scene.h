// A scene in which morphs of trees are ordinary, key-framed trees.
#pragma once

#include "scene/grow_trees.h"

namespace kelpie {

/// The file, and what was done to it.
struct GenericScene {
  std::string text;
  size_t trees = 0;  ///< that stand in the place of an animorphosis
  size_t curves = 0; ///< what of them is keys that were computed…
  size_t keys = 0;   ///< …so many in all…
  double error = 0;  ///< …and so far off at most, as a part of the largest number of a value
};

/// The scene file at `path`, with the tree of each animorphosis in its place; all else as the file has it, but comments. Its materials
/// stand in the scene's `materials`. Throws an Error (bad_data) where no animorphosis stands in the file itself.
GenericScene generic_scene(const std::string& path, const Scene&, const std::vector<GrownTree>&);

} // namespace kelpie
