// Gives instances the parts that they name.
#pragma once

#include "scene/record_reader.h"

namespace kelpie {

/// What a scene may demand through references, however short its text.
struct PartLimits {
  size_t depth = 64;            ///< of fields in one another
  double elements = 10'000'000; ///< nodes of fields and blobs of clouds, counted as often as they are used
};

/// Links all instances. Reports names that no part has, cycles, and fields too deep in one another: after the latter two there
/// are no links.
void link_parts(const std::vector<ReadNode>&, Scene&, const Document&, ProblemList&, const PartLimits& = {});

/// Reports the first shape with which there are too many elements. For scenes that were linked and loaded without a problem.
void check_size(const Scene&, ProblemList&, const PartLimits& = {});

} // namespace kelpie
