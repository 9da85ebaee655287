// The trees that kinds of scene files stand for.
#pragma once

#include "scene/record_reader.h"

namespace kelpie {

/// Puts in the place of each maker the tree that it describes. For scenes that are linked and loaded. A part that several shapes use has
/// the tree of the first. Reports what cannot be made.
void grow_trees(const std::vector<ReadTreeMaker>& makers, Scene& scene, ProblemList& problems);

} // namespace kelpie
