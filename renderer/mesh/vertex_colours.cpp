#include "renderer/mesh/vertex_colours.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "colour/spaces.h"
#include "colour/view.h"
#include "materials/surface_bsdf.h"
#include "renderer/cells/value_cells.h"
#include "renderer/program/material_mix.h"

namespace kelpie {

namespace {

/// A shape's texture, then its field, then its surface decide, as at a hit (renderer/integrate/surfaces.h).
class ShapeMaterials {
public:
  ShapeMaterials(const FrameScene& frame, const SampledShape& shape, const FieldProgram& program, const Box3d& box)
      : materials_(frame.materials), surface_(shape.surface) {
    if (!shape.texture.nodes.empty()) cells_.emplace_back(compile(shape.texture, shape.threshold, {.with_identities = true}), box);
    if (!shape.field.materials.empty()) cells_.emplace_back(program, box);
  }

  Vec3 colour(const Vec3d& p) const {
    SurfaceMix mix;
    for (const ValueCells& cells : cells_) add_materials_at(materials_, cells.program(), cells.code_at(p), p, {}, mix);
    const float rest = 1 - mix.weight();
    if (rest > 0 && surface_.is_set()) add_material(materials_, surface_, Vec3(p), {}, rest, mix);
    if (rest > 0 && !surface_.is_set()) mix.add(Matte<SampledMode>{}.surface(), rest);
    return SurfaceBsdf(mix.sum()).albedo();
  }

private:
  const SampledMaterials& materials_;
  MaterialIndex surface_;
  std::vector<ValueCells> cells_;
};

} // namespace

std::vector<std::array<uint8_t, 3>> colours_at(const FrameScene& frame, const SampledShape& shape, const FieldProgram& program,
                                               const std::vector<Vec3d>& places) {
  Box3d box;
  for (const Vec3d& p : places) box.extend(p);
  const ShapeMaterials materials(frame, shape, program, box);
  std::vector<Vec3> colours(places.size());
  parallel_for(size_t(0), places.size(), [&](size_t i) { colours[i] = materials.colour(places[i]); });
  if (!colours.empty()) from_scene_linear(&colours[0].x, colours.size(), 3, k_space_srgb);
  std::vector<std::array<uint8_t, 3>> out(places.size());
  for (size_t i = 0; i < out.size(); ++i)
    for (int c = 0; c < 3; ++c) out[i][size_t(c)] = static_cast<uint8_t>(std::lround(255 * std::clamp(colours[i][c], 0.f, 1.f)));
  return out;
}

} // namespace kelpie
