#include "renderer/program/material_mix.h"

namespace kelpie {

void add_materials_at(const SampledMaterials& materials, const FieldProgram& program, const CodeView& code, const Vec3d& p,
                      const Footprint& footprint, SurfaceMix& mix) {
  thread_local std::vector<MaterialAt> found;
  const float rest = 1 - mix.weight();
  materials_at(program, code, p, footprint, found);
  for (const MaterialAt& m : found) add_material(materials, m.material, m.position, m.footprint, rest * m.share, mix);
}

} // namespace kelpie
