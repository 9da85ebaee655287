// What the shapes of a frame are made of, at a hit.
#pragma once

#include <memory>
#include <optional>

#include "materials/surface_bsdf.h"
#include "renderer/cells/value_cells.h"
#include "renderer/program/materials_at.h"
#include "renderer/trace/tracer.h"

namespace kelpie {

/// Evaluates materials. Whatever varies over a shape is decided here: the hit knows the place, the moment, and of a field the cell with
/// what counts in it.
class Surfaces {
public:
  /// Both must outlive it. Cells of textures are built in the current TBB arena.
  Surfaces(const FrameScene& frame, const Tracer& tracer);

  /// The surface at a hit that is seen by a footprint (world space): of what the texture of the shape says there, else its field, else
  /// its `surface`. The answer may lie in `memory`.
  const SurfaceParameters& at(const Hit& hit, const Footprint& footprint, std::optional<SurfaceParameters>& memory) const;
  /// Whether the footprint of a hit is of no use: the shape is the same all over.
  bool is_uniform(const Hit& hit) const { return shapes_[hit.shape].is_uniform; }
  /// What the surface at a hit does with light, seen from the air outside: where the shape is opaque and the same all over; else nothing.
  const SurfaceBsdf* opaque_in_air(const Hit& hit) const {
    const std::optional<SurfaceBsdf>& bsdf = shapes_[hit.shape].in_air;
    return bsdf ? &*bsdf : nullptr;
  }

private:
  struct Shape {
    bool is_uniform = true;
    SurfaceParameters surface = Matte<SampledMode>{}.surface(); ///< where it is uniform
    std::optional<SurfaceBsdf> in_air;                          ///< where it is uniform and opaque
    std::shared_ptr<const ValueCells> texture;
  };

  const FrameScene& frame_;
  std::vector<Shape> shapes_;
};

} // namespace kelpie
