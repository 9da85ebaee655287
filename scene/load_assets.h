// Fills what a scene holds in memory from the files that it names.
#pragma once

#include "scene/record_reader.h"

namespace kelpie {

/// Loads the clouds and distances of all nodes that were read and the meshes of all shapes, each file once, and matches the ends of
/// morphs. What is wrong goes to `problems`, at the place that names the file first or in the file; warnings to `diagnostics`.
void load_assets(const RecordReader&, Scene&, bool use_cache, ProblemList& problems, Diagnostics& diagnostics);

} // namespace kelpie
