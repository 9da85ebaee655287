// The camera as other programs expect it in EXR headers.
#pragma once

#include <cmath>

#include <glm/mat4x4.hpp>
#include <glm/trigonometric.hpp>

#include "scene/camera.h"

namespace kelpie {

struct CameraMatrices {
  glm::mat4 camera_from_world;
  glm::mat4 ndc_from_world;
};

/// RenderMan's conventions, for column vectors (in memory these are the row-vector matrices of EXR):
/// camera space is left-handed, x to the right, y up, z into the picture; NDC, after the division by w,
/// is [-1, 1] from left to right and from bottom to top of the picture, z = -1/distance (so that it can be inverted).
inline CameraMatrices camera_matrices(const Camera<SampledMode>& camera, Vec2i resolution) {
  const Vec3 forward = glm::normalize(camera.look_at - camera.position);
  const Vec3 right = glm::normalize(glm::cross(forward, camera.up));
  const Vec3 up = glm::cross(right, forward);
  glm::mat4 m(1);
  for (int i = 0; i < 3; ++i) m[i] = glm::vec4(right[i], up[i], forward[i], 0);
  m[3] = glm::vec4(-glm::dot(camera.position, right), -glm::dot(camera.position, up), -glm::dot(camera.position, forward), 1);
  const float tan_half = std::tan(glm::radians(camera.fov) / 2);
  glm::mat4 ndc(0);
  ndc[0][0] = float(resolution.y) / (tan_half * float(resolution.x));
  ndc[1][1] = 1 / tan_half;
  ndc[3][2] = -1;
  ndc[2][3] = 1;
  return {m, ndc * m};
}

} // namespace kelpie
