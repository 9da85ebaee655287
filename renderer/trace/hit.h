// Where a ray met a surface, and the rays that start there.
#pragma once

#include "renderer/trace/solve.h"

namespace kelpie {

struct Hit {
  float t = 0;
  Vec3 position{0};
  Vec3 normal{0};                   ///< unit, out of the shape (for a plane: its upper side); smooth on a mesh. It faces the ray
                                    ///< where the surface does
  uint32_t shape = 0;               ///< index into FrameScene::shapes
  uint32_t cell = 0;                ///< of `slab`
  const ShapeCells* slab = nullptr; ///< the shape's cells at the ray's time; null where it is geometry
  float time = 0;                   ///< the ray's
  float epsilon = 0;                ///< offset of secondary rays along the normal, on the side where they start
  /// The ray comes out of the shape here; else it goes in. (What is below a plane is inside it.)
  bool is_leaving = false;
  /// From the position to where rays on the near side start, but for the offset: the facets of a smooth mesh lie
  /// below the surface that they stand for, and would shadow one another.
  Vec3 lift{0};
};

/// The normal, turned to the side from which the ray came. What is near and far of a surface is decided by it alone.
Vec3 facing_normal(const Ray& arrived, const Hit&);

/// The sides of a surface, as the ray has it that met it: where it came from, and where it would go.
enum class Side { near, far };

/// A ray that starts at a hit: reflected or towards a light (near), or into what is behind the surface (far).
/// It lies in the shapes that `arrived` lay in, but for the surface that it crosses.
Ray depart(const Ray& arrived, const Hit&, const Vec3& direction, Side);

/// Of what rounds positions to float: an offset must not drown in that.
inline float rounding_at(const Vec3& p, float t) { return 5e-7f * (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) + t); }

} // namespace kelpie
