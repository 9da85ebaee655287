// What the shapes of a frame are made of, at a hit.
#pragma once

#include <memory>
#include <optional>

#include "materials/surface_bsdf.h"
#include "renderer/cells/value_cells.h"
#include "renderer/program/materials_at.h"
#include "renderer/trace/tracer.h"

namespace kelpie {

/// What heights of materials do to a surface, as a footprint sees them.
struct Relief {
  Vec3 slope{0};    ///< their gradient along the surface, over the footprint
  float unseen = 0; ///< the square of the slope of what is finer than that
};

/// Evaluates materials. Whatever varies over a shape is decided here: the hit knows the place, the moment, and of a field the cell with
/// what counts in it.
class Surfaces {
public:
  /// Both must outlive it. Cells of textures are built in the current TBB arena.
  Surfaces(const FrameScene& frame, const Tracer& tracer);

  /// The surface at a hit that is seen by a footprint (world space): of what the texture of the shape says there, else its field, else
  /// its `surface`. The answer may lie in `memory`.
  const SurfaceParameters& at(const Hit& hit, const Footprint& footprint, std::optional<SurfaceParameters>& memory) const;
  /// Whether materials of the shape have heights: else `relief_at` finds nothing.
  bool is_bumpy(const Hit& hit) const { return shapes_[hit.shape].is_bumpy; }
  /// By differences of heights. Of what is too fine for the footprint one sample of its slope at the hit counts.
  Relief relief_at(const Hit& hit, const Footprint& footprint) const;
  /// What the surface at a hit does with light, seen from the air outside: where the shape is opaque and the same all over; else nothing.
  const SurfaceBsdf* opaque_in_air(const Hit& hit) const {
    const std::optional<SurfaceBsdf>& bsdf = shapes_[hit.shape].in_air;
    return bsdf ? &*bsdf : nullptr;
  }

private:
  struct Shape {
    bool is_uniform = true, is_bumpy = false;
    SurfaceParameters surface = Matte<SampledMode>{}.surface(); ///< where it is uniform
    std::optional<SurfaceBsdf> in_air;                          ///< where it is uniform and opaque
    std::shared_ptr<const ValueCells> texture;
  };

  template <class Mix>
  void add_at(const Hit& hit, const Vec3& p, const Footprint& footprint, Mix& mix) const;
  Vec3 slope_at(const Hit& hit, const Footprint& footprint) const;

  const FrameScene& frame_;
  std::vector<Shape> shapes_;
};

} // namespace kelpie
