// How the camera sees the world.
#pragma once

#include "field/complex/detail.h"
#include "scene/scene.h"

namespace kelpie {

/// The pixels by which details of a scene are chosen, as a camera of it sees them.
inline PixelScale pixel_scale(const Scene& scene, const Camera<SampledMode>& camera, int picture_height) {
  const int height = scene.detail_height > 0 ? scene.detail_height : picture_height;
  return {camera.position, float(2 * std::tan(glm::radians(0.5 * double(camera.fov))) / height)};
}

} // namespace kelpie
