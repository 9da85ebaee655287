// A mesh of a field, as one who traces triangles would make it: by OpenVDB, from samples in a narrow band.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/program/program.h"

namespace kelpie {

struct FieldMesh {
  std::vector<Vec3> points;
  std::vector<uint32_t> triangles; ///< three points each
};

/// Samples field - threshold every `voxel` (scene units) in the blocks of 8^3 voxels that the surface can pass
/// through, by the program pruned to the block, and makes quadrangles of them. Parallel.
FieldMesh mesh_field(const FieldProgram& program, double voxel);

} // namespace kelpie
