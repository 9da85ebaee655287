#pragma once

#include "scene/problem_list.h"
#include "scene/scene.h"

namespace kelpie {

/// What a metamorphosis mixes must be distances: whatever below one is none is a problem, at its place.
void check_distances(const Scene&, ProblemList&);

} // namespace kelpie
