// The environments that need no file, as functions of the direction.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <tbb/parallel_for.h>

#include "colour/spaces.h"
#include "renderer/light/environment_map.h"

namespace kelpie {

namespace {

constexpr float k_pi = std::numbers::pi_v<float>;

float smooth_step(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.f, 1.f);
  return t * t * (3 - 2 * t);
}

float gauss(float x, float width) { return std::exp(-x * x / (2 * width * width)); }

/// A rectangular light that hangs at `centre`, faces the origin, and fades out over `softness` of its half size.
/// `falloff`: how much darker its diffuser is at the edge than in the middle.
struct SoftBox {
  Vec3 centre, up;
  float half_width, half_height, softness, falloff;
  Vec3 radiance;

  Vec3 seen_along(const Vec3& d) const {
    const Vec3 normal = glm::normalize(centre), right = glm::normalize(glm::cross(normal, up)), top = glm::cross(right, normal);
    const float towards = glm::dot(d, normal);
    if (towards <= 0.01f) return Vec3(0);
    const Vec3 p = d * (glm::length(centre) / towards);
    const float x = std::abs(glm::dot(p, right)) / half_width, y = std::abs(glm::dot(p, top)) / half_height;
    const float inside = (1 - smooth_step(1 - softness, 1, x)) * (1 - smooth_step(1 - softness * half_width / half_height, 1, y));
    const float r2 = std::min(1.f, 0.5f * (x * x + y * y));
    return radiance * (inside * (1 - falloff * r2));
  }
};

/// A dark room for metal: what a chrome thing shows is the room, so it is composed like a picture. A broad
/// overhead box makes the long soft highlight, two tall strips draw the silhouette on both sides, a warm
/// and a cool one behind make the rim, and a graded cyclorama keeps the dark parts from being black.
Vec3 studio(const Vec3& d) {
  static const SoftBox boxes[] = {
      {{0.3f, 3.0f, 0.6f}, {0, 0, -1}, 2.2f, 1.5f, 0.55f, 0.55f, {5.6f, 5.5f, 5.35f}}, // overhead
      {{-3.0f, 0.9f, 0.9f}, {0, 1, 0}, 0.55f, 2.3f, 0.7f, 0.3f, {5.2f, 5.35f, 5.6f}},  // strip, left
      {{3.0f, 0.7f, 1.5f}, {0, 1, 0}, 0.38f, 1.9f, 0.7f, 0.3f, {3.4f, 3.3f, 3.15f}},   // strip, right
      {{-2.6f, 1.0f, -2.6f}, {0, 1, 0}, 0.6f, 1.8f, 0.9f, 0.4f, {1.3f, 2.0f, 3.3f}},   // rim, cool
      {{2.4f, 0.8f, -2.9f}, {0, 1, 0}, 0.8f, 1.4f, 0.9f, 0.4f, {3.4f, 1.9f, 0.95f}},   // rim, warm
      {{0.9f, 0.35f, 3.2f}, {0, 1, 0}, 1.7f, 0.5f, 1.0f, 0.6f, {0.42f, 0.44f, 0.47f}}, // fill, behind the camera
  };
  const float up = d.y;
  const Vec3 wall = Vec3(0.045f, 0.049f, 0.057f) + Vec3(0.16f, 0.165f, 0.175f) * smooth_step(0.75f, -0.15f, up);
  const Vec3 floor = Vec3(0.105f, 0.102f, 0.098f) * smooth_step(-1.1f, -0.05f, up) + Vec3(0.016f);
  const float below = smooth_step(0.015f, -0.05f, up);
  Vec3 light = wall * (1 - below) + floor * below;
  light += Vec3(0.16f, 0.165f, 0.17f) * gauss(up - 0.03f, 0.07f); // where floor and wall meet
  for (const SoftBox& box : boxes) light += box.seen_along(d);
  return light;
}

/// A clear sky without a sun (a sun light makes sharp shadows better), for a camera that looks anywhere.
Vec3 sky(const Vec3& d) {
  const float up = d.y;
  const Vec3 zenith(0.16f, 0.29f, 0.56f), low(0.62f, 0.74f, 0.90f), glow(1.05f, 0.86f, 0.66f), ground(0.17f, 0.155f, 0.135f);
  const float height = std::max(up, 0.f);
  Vec3 above = zenith + (low - zenith) * std::pow(1 - height, 3.5f);
  const float side = 0.5f + 0.5f * glm::dot(d, glm::normalize(Vec3(-0.6f, 0, -0.8f))); // where the sun went down
  above += (glow - low) * (std::exp(-height * 7) * (0.25f + 0.75f * side * side));
  const Vec3 below = ground * (0.75f + 0.5f * std::exp(up * 6)) + low * (0.25f * std::exp(up * 14));
  const float t = smooth_step(-0.012f, 0.012f, up);
  return below * (1 - t) + above * t;
}

template <class Function>
EnvironmentMap paint(int width, int height, Function&& colour) {
  std::vector<Vec3> texels(size_t(width) * size_t(height));
  tbb::parallel_for(0, height, [&](int row) {
    const float theta = k_pi * (float(row) + 0.5f) / float(height);
    for (int column = 0; column < width; ++column) {
      const float phi = 2 * k_pi * ((float(column) + 0.5f) / float(width) - 0.5f);
      const Vec3 d(std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi));
      texels[size_t(row) * size_t(width) + size_t(column)] = colour(d);
    }
  });
  // The functions above speak ACEScg; a config may have another working space.
  to_scene_linear(&texels[0].x, texels.size(), 3, k_space_acescg);
  return EnvironmentMap(width, height, std::move(texels));
}

} // namespace

EnvironmentMap EnvironmentMap::make(EnvironmentPreset preset) {
  switch (preset) {
  case EnvironmentPreset::studio: return paint(1024, 512, studio);
  case EnvironmentPreset::sky: return paint(512, 256, sky);
  case EnvironmentPreset::white: break;
  }
  return paint(16, 8, [](const Vec3&) { return Vec3(1); });
}

} // namespace kelpie
