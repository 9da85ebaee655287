// What heights do to the normal of a surface.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec.h"

namespace kelpie {

/// The normal of a surface that heights raise: `slope` is their gradient along the surface.
inline Vec3 raised_normal(const Vec3& normal, const Vec3& slope) { return glm::normalize(normal - slope); }

/// The raised normal, or one near it that can be seen and reflects the viewer to what lies above the true surface. All are unit vectors;
/// `out`, to the viewer, lies above the true surface. A mirrored direction that lies too low is pulled up along the true normal, and
/// the normal is what lies in the middle between the viewer and that (Keller et al. 2017, "The Iray Light Transport Simulation").
inline Vec3 seen_normal(const Vec3& true_normal, const Vec3& raised, const Vec3& out) {
  constexpr float k_lowest = 0.02f; // above the surface: the cosine
  const float lowest = std::min(k_lowest, glm::dot(out, true_normal));
  const Vec3 mirrored = 2 * std::max(0.f, glm::dot(out, raised)) * raised - out;
  const float up = glm::dot(mirrored, true_normal);
  if (up >= lowest) return raised;
  const Vec3 middle = out + glm::normalize(mirrored + (lowest - up) * true_normal);
  const float length = glm::length(middle);
  constexpr float k_least = 1e-3f; // seen along the surface: nothing lies in the middle of opposite directions
  return length > k_least ? middle / length : true_normal;
}

/// Of light from a direction the part that gets past other bumps, so that none leaks through the true surface, and light does not end
/// at a line (Estevez, Lecocq and Stein 2019, "A Microfacet-Based Shadowing Function to Solve the Bump Terminator Problem").
inline float past_bumps(const Vec3& true_normal, const Vec3& seen, const Vec3& in) {
  const auto tangent2 = [](float cosine) { return 1 / (cosine * cosine) - 1; };
  const float tilt = glm::dot(true_normal, seen), cosine = glm::dot(true_normal, in);
  if (cosine <= 0) return 0;
  const float alpha2 = tilt > 0 ? std::min(1.f, 0.125f * tangent2(tilt)) : 1.f;
  return 2 / (1 + std::sqrt(1 + std::max(0.f, alpha2 * tangent2(std::min(1.f, cosine)))));
}

} // namespace kelpie
