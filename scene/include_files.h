// `include`: the parts, materials and recipes of other files become the scene's.
#pragma once

#include "scene/assets.h"
#include "scene/document.h"

namespace kelpie {

/// What a scene may demand by including.
struct IncludeLimits {
  size_t depth = 16; ///< of files in one another
  size_t files = 1000;
  DocumentLimits all; ///< of all files together
};

/// Reads whatever the document's "include" names, and what that includes in turn, and moves its parts, materials and recipes into the
/// document. Returns what is left of each file, for the reader to check against the table of libraries. Files that cannot
/// be read, cycles and names that are taken go to `problems`.
std::vector<JsonValue> include_files(Document&, const AssetFolder&, ProblemList&, const IncludeLimits& = {});

} // namespace kelpie
