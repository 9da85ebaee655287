// What the rays that start in a small box start in: a camera, mostly.
#pragma once

#include <optional>

#include "renderer/trace/tracer.h"

namespace kelpie {

/// What is left in a small box of all fields.
class Surroundings {
public:
  Surroundings(const Tracer&, const Box3& box);
  /// The implicit shapes around a point of the box, for Ray::inside.
  ShapeSet shapes_around(const Vec3& p, float time) const;

private:
  /// What is left of a shape's program in the box, in a slab of time.
  struct Slab {
    const ShapeCells* cells;
    std::optional<bool> is_inside; ///< if it is the same everywhere, always
    Code code;                     ///< else
  };
  std::vector<std::vector<Slab>> shapes_;
};

} // namespace kelpie
