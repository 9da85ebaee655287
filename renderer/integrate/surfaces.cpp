#include "renderer/integrate/surfaces.h"

#include "renderer/program/material_mix.h"

namespace kelpie {

namespace {

/// Less than this is what float numbers lack of 1.
constexpr float k_rest = 1e-5f;

/// Calls visit(material) for every one that a field names.
template <class Visit>
void for_each_material(const SampledField& field, const Visit& visit) {
  const auto one = [&](MaterialIndex material) {
    if (material.is_set()) visit(material);
  };
  for (const MaterialIndex material : field.materials) one(material);
  for (const auto& node : field.nodes)
    std::visit(
        [&](const auto& kind) {
          for_each_value(
              [&]<class T>(const ParameterRules&, const T& value) {
                if constexpr (std::is_same_v<T, MaterialIndex>) one(value);
              },
              kind);
        },
        node);
}

/// Whether heights vary over a shape that is not uniform.
bool has_heights(const SampledMaterials& all, const SampledShape& shape) {
  bool found = shape.surface.is_set() && has_height(all, shape.surface);
  for (const SampledField* field : {&shape.field, &shape.texture})
    for_each_material(*field, [&](MaterialIndex material) { found = found || has_height(all, material); });
  return found;
}

/// Heights are compared at least so far apart that the rounding of positions does not show.
float least_step(const Hit& hit) { return 500 * rounding_at(hit.position, hit.t); }

Footprint at_least_as_wide_as(float width, const Footprint& footprint) {
  const auto stretched = [width](const Vec3& v) { return v * std::max(1.f, width / glm::length(v)); };
  return {stretched(footprint.u), stretched(footprint.v)};
}

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
    s.is_bumpy = !s.is_uniform && has_heights(frame.materials, shape);
    if (s.is_uniform && shape.surface.is_set()) s.surface = surface_of(frame.materials, shape.surface);
    if (s.is_uniform && s.surface.transmission_weight == 0) s.in_air.emplace(s.surface);
  }
}

const SurfaceParameters& Surfaces::at(const Hit& hit, const Footprint& footprint, std::optional<SurfaceParameters>& memory) const {
  const Shape& shape = shapes_[hit.shape];
  if (shape.is_uniform) return shape.surface;
  SurfaceMix mix;
  add_at(hit, hit.position, footprint, mix);
  return memory.emplace(mix.sum());
}

/// At a point near the hit; of a field what counts in the hit's cell.
template <class Mix>
void Surfaces::add_at(const Hit& hit, const Vec3& p, const Footprint& footprint, Mix& mix) const {
  const Shape& shape = shapes_[hit.shape];
  const Vec3d at_point(p);
  if (shape.texture)
    add_materials_at(frame_.materials, shape.texture->program(), shape.texture->code_at(at_point), at_point, footprint, mix);
  if (mix.weight() < 1 - k_rest && hit.slab && !frame_.shapes[hit.shape].field.materials.empty()) {
    const CodeView& code = *hit.slab->cells[hit.cell].code;
    add_materials_at(frame_.materials, at_with_materials(hit.slab->program, code, hit.slab->slab_time(hit.time)), code, at_point, footprint,
                     mix);
  }
  if (mix.weight() < 1 - k_rest) {
    if (const MaterialIndex rest = frame_.shapes[hit.shape].surface; rest.is_set())
      add_material(frame_.materials, rest, p, footprint, 1 - mix.weight(), mix);
    else
      mix.add(shape.surface, 1 - mix.weight());
  }
}

/// The gradient of the heights along the surface: each is the mean over a footprint, and they are half a footprint apart.
Vec3 Surfaces::slope_at(const Hit& hit, const Footprint& footprint) const {
  const auto height = [&](const Vec3& p) {
    HeightMix mix;
    add_at(hit, p, footprint, mix);
    return mix.sum();
  };
  const float here = height(hit.position);
  const auto along = [&](const Vec3& v) { return (height(hit.position + 0.5f * v) - here) * 2 / glm::dot(v, v) * v; };
  return along(footprint.u) + along(footprint.v);
}

Relief Surfaces::relief_at(const Hit& hit, const Footprint& footprint) const {
  const float least = least_step(hit);
  const Footprint seen = at_least_as_wide_as(least, footprint);
  Relief relief{slope_at(hit, seen)};
  const float shrink = least / std::sqrt(std::max(glm::dot(seen.u, seen.u), glm::dot(seen.v, seen.v)));
  constexpr float k_all = 0.5f; // what is finer than that cannot be told from the whole
  if (shrink > k_all) return relief;
  const Vec3 fine = slope_at(hit, at_least_as_wide_as(least, {seen.u * shrink, seen.v * shrink}));
  relief.unseen = std::max(0.f, glm::dot(fine, fine) - glm::dot(relief.slope, relief.slope));
  return relief;
}

} // namespace kelpie
