#include "renderer/integrate/surfaces.h"

#include "renderer/program/material_mix.h"

namespace kelpie {

namespace {

/// Less than this is what float numbers lack of 1.
constexpr float k_rest = 1e-5f;

} // namespace

Surfaces::Surfaces(const FrameScene& frame, const Tracer& tracer) : frame_(frame) {
  for (const SampledShape& shape : frame.shapes) {
    Shape& s = shapes_.emplace_back();
    if (!shape.texture.nodes.empty()) {
      FieldProgram program = compile(shape.texture, shape.threshold, {.with_identities = true});
      s.texture = std::make_shared<const ValueCells>(std::move(program), Box3d{Vec3d(tracer.bounds().lower), Vec3d(tracer.bounds().upper)});
    }
    s.is_uniform =
        !s.texture && shape.field.materials.empty() && (!shape.surface.is_set() || kelpie::is_uniform(frame.materials, shape.surface));
    if (s.is_uniform && shape.surface.is_set()) s.surface = surface_of(frame.materials, shape.surface);
    if (s.is_uniform && s.surface.transmission_weight == 0) s.in_air.emplace(s.surface);
  }
}

const SurfaceParameters& Surfaces::at(const Hit& hit, const Footprint& footprint, std::optional<SurfaceParameters>& memory) const {
  const Shape& shape = shapes_[hit.shape];
  if (shape.is_uniform) return shape.surface;
  SurfaceMix mix;
  if (shape.texture)
    add_materials_at(frame_.materials, shape.texture->program(), shape.texture->code_at(Vec3d(hit.position)), Vec3d(hit.position),
                     footprint, mix);
  if (mix.weight() < 1 - k_rest && hit.slab && !frame_.shapes[hit.shape].field.materials.empty()) {
    const CodeView& code = *hit.slab->cells[hit.cell].code;
    add_materials_at(frame_.materials, at_with_materials(hit.slab->program, code, hit.slab->slab_time(hit.time)), code, Vec3d(hit.position),
                     footprint, mix);
  }
  if (mix.weight() < 1 - k_rest) {
    if (const MaterialIndex rest = frame_.shapes[hit.shape].surface; rest.is_set())
      add_material(frame_.materials, rest, hit.position, footprint, 1 - mix.weight(), mix);
    else
      mix.add(shape.surface, 1 - mix.weight());
  }
  return memory.emplace(mix.sum());
}

} // namespace kelpie
