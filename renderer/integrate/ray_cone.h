// How much of the world a ray stands for.
#pragma once

#include <algorithm>
#include <cmath>

#include "materials/patterns/footprint.h"

namespace kelpie {

/// What a pixel sees around a ray, and what is left of that after bounces: a cone about it (Amanatides 1984).
struct RayCone {
  float width = 0;  ///< where the ray starts, in scene units
  float spread = 0; ///< by how much it grows a unit of length

  float width_at(float t) const { return width + spread * t; }

  /// Where it meets a surface with a unit normal.
  Footprint on_surface(const Vec3& direction, const Vec3& normal, float t) const {
    // Where the surface is seen from the side the footprint is long, and ends somewhere.
    constexpr float k_least_cosine = 0.05f;
    const float w = width_at(t), cosine = std::max(std::abs(glm::dot(direction, normal)), k_least_cosine);
    const Vec3 across = glm::cross(normal, direction);
    const float sine = glm::length(across);
    if (!(sine > 1e-4f)) { // straight on: any two directions
      const Vec3 x = glm::normalize(glm::cross(normal, std::abs(normal.x) < 0.5f ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
      return {w * x, w * glm::cross(normal, x)};
    }
    const Vec3 side = across / sine;
    return {w * side, (w / cosine) * glm::cross(side, normal)};
  }

  /// Behind a surface at t, in a direction that was chosen with a density per solid angle: one of few samples stands for many
  /// directions. A mirror or a clear surface leaves the cone as it is, but for `bend`: by how much the normals within it differ.
  RayCone scattered(float t, float pdf, bool is_delta, float bend) const {
    constexpr float k_share = 0.1f; // of the lobe's width that one of a pixel's samples stands for
    const float lobe = is_delta ? 0 : k_share / std::sqrt(std::max(pdf, 1e-2f));
    return {width_at(t), std::max(spread + 2 * bend, lobe)};
  }
};

} // namespace kelpie
