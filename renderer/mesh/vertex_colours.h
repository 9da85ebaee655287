// The colours of a shape's materials, where vertices are.
#pragma once

#include "renderer/mesh/mesh_object.h"
#include "renderer/program/program.h"
#include "scene/scene.h"

namespace kelpie {

/// Of places on the surface of a shape, in its scene: the colour that its materials have there in white light, sRGB. `program` is that of
/// its field, with identities. Runs in the current TBB arena.
std::vector<std::array<uint8_t, 3>> colours_at(const FrameScene&, const SampledShape&, const FieldProgram& program,
                                               const std::vector<Vec3d>& places);

} // namespace kelpie
