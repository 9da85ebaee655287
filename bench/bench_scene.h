// The scenes that are measured, by name.
#pragma once

#include <string>

#include "scene/scene.h"

namespace kelpie {

/// A number: the knotted cloud of so many blobs; `creature`, `creature_twisted`, `creature_bent`: the tree (see
/// creature_tree.h); anything else: the first frame of a scene file. Throws Error.
FrameScene bench_scene(const std::string& name);

} // namespace kelpie
