// The trees that kinds of scene files stand for.
#pragma once

#include "morph/tree/tree_match.h"
#include "scene/record_reader.h"

namespace kelpie {

struct ReadOptions;

/// A node that stands in the place of an animorphosis.
struct GrownTree {
  FieldPtr root;
  std::vector<std::string> shapes; ///< those that it is in
  TreeMatch match;
};

/// Puts in the place of each maker the tree that it describes, and returns these, inner ones first. For scenes that are linked and loaded.
/// A part that several shapes use has the tree of the first. Reports what cannot be made.
std::vector<GrownTree> grow_trees(const std::vector<ReadTreeMaker>& makers, Scene& scene, ProblemList& problems, Diagnostics& diagnostics);

/// read_scene() (scene/reader.h), and what became of the scene's animorphoses.
Scene read_scene_and_trees(const std::string& path, const ReadOptions&, Diagnostics&, std::vector<GrownTree>& trees);

} // namespace kelpie
