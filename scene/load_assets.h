// Fills what field nodes hold in memory from the files they name.
#pragma once

#include "scene/record_reader.h"

namespace kelpie {

/// Loads the clouds of all nodes, each file once, and matches the ends of morphs. What is wrong goes to
/// `problems`, at the place that names the file.
void load_assets(const std::vector<ReadNode>&, const Document&, ProblemList& problems);

} // namespace kelpie
