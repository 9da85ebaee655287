// How large the blobs and skeletons of a program are: what the sizes of cells and of offsets follow.
#pragma once

#include "renderer/program/program.h"

namespace kelpie {

/// Blobs and skeletons of a code.
size_t element_count(const Code&);

/// The smallest radius of influence (half the smallest side of a skeleton's support), in world units.
double smallest_radius(const FieldProgram&, const Code&);

/// The smallest radius of influence of the skeletons, without their own size, in world units; infinite if there is none.
double smallest_influence(const FieldProgram&, const Code&);

/// How fine the finest lattice is by whose samples something is known, in world units; infinite if there is none. Bounds of it are
/// narrow over few voxels only.
double smallest_lattice(const FieldProgram&, const Code&);

} // namespace kelpie
