#include "renderer/program/material_mix.h"

#include <cmath>

namespace kelpie {

namespace {

/// How long in the world what has length 1 in the space of a material is, along the surface: by the footprint as both see it.
float world_per_local(const Footprint& world, const Footprint& local) {
  if (world.is_point() || (world.u == local.u && world.v == local.v)) return 1;
  const float area = glm::length(glm::cross(local.u, local.v));
  return area > 0 ? std::sqrt(glm::length(glm::cross(world.u, world.v)) / area) : 1;
}

} // namespace

template <class Mix>
void add_materials_at(const SampledMaterials& materials, const FieldProgram& program, const CodeView& code, const Vec3d& p,
                      const Footprint& footprint, Mix& mix) {
  thread_local std::vector<MaterialAt> found;
  const float rest = 1 - mix.weight();
  materials_at(program, code, p, footprint, found);
  for (const MaterialAt& m : found) {
    const float scale = world_per_local(footprint, m.footprint);
    if (scale == 1) {
      add_material(materials, m.material, m.position, m.footprint, rest * m.share, mix);
      continue;
    }
    Mix part;
    add_material(materials, m.material, m.position, m.footprint, 1, part);
    mix.add_part(part, scale, rest * m.share);
  }
}

template void add_materials_at(const SampledMaterials&, const FieldProgram&, const CodeView&, const Vec3d&, const Footprint&, SurfaceMix&);
template void add_materials_at(const SampledMaterials&, const FieldProgram&, const CodeView&, const Vec3d&, const Footprint&, HeightMix&);

} // namespace kelpie
