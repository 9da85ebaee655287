// The order of blobs in memory.
#pragma once

#include <span>

#include "renderer/program/program.h"

namespace kelpie {

/// Orders the blobs of programs of one structure along a curve through space, by where they are in the first: what is near is
/// near in memory then, too. Clouds list blobs in any order, and building cells fetches those of a box again and again.
/// Their identities go with them, if there are any.
void sort_blobs(std::span<FieldProgram> moments, std::vector<LeafIdentity>& identities);

} // namespace kelpie
