// Infinite planes.
#pragma once

#include <optional>

#include "renderer/trace/hit.h"
#include "scene/geometry.h"
#include "scene/scene.h"

namespace kelpie {

/// The planes of a frame.
class Planes {
public:
  explicit Planes(const FrameScene&);

  /// Whether the ray meets one before hit.t; then `hit` says where.
  bool meet(const Ray&, Hit& hit) const;
  /// The velocity of a plane along its normal, per exposure; nothing if the shape is none.
  std::optional<Vec3> velocity(const Hit&) const;

private:
  struct PlaneShape {
    std::vector<Plane<SampledMode>> states; ///< see state_at
    uint32_t shape;
  };
  std::vector<PlaneShape> planes_;
};

} // namespace kelpie
