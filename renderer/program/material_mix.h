// What a field is made of at a point, as one surface.
#pragma once

#include "renderer/program/materials_at.h"

namespace kelpie {

/// Adds the materials that materials_at() finds to what lacks of 1 in a mix (SurfaceMix or HeightMix). Their heights become lengths of
/// the world.
template <class Mix>
void add_materials_at(const SampledMaterials&, const FieldProgram&, const CodeView&, const Vec3d& p, const Footprint&, Mix&);

} // namespace kelpie
