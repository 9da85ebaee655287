// The environments that need no file, as functions of the direction.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "colour/spaces.h"
#include "renderer/light/environment_map.h"

namespace kelpie {

namespace {

float smooth_step(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.f, 1.f);
  return t * t * (3 - 2 * t);
}

float gauss(float x, float width) { return std::exp(-x * x / (2 * width * width)); }

/// A light with rounded corners that hangs at `centre` and faces the origin. Its diffuser is brightest in
/// the middle, darker by `falloff` at the edge, fades out over `softness` of its half size, and is graded
/// across: `tilt` is how much brighter the right and the upper edge are than the opposite ones. Gradients
/// are what tells polished metal from white paint.
struct SoftBox {
  Vec3 centre, up;
  float half_width, half_height, softness, falloff;
  Vec2 tilt;
  Vec3 radiance;

  Vec3 seen_along(const Vec3& d) const {
    const Vec3 normal = glm::normalize(centre), right = glm::normalize(glm::cross(normal, up)), top = glm::cross(right, normal);
    const float towards = glm::dot(d, normal);
    if (towards <= 0.01f) return Vec3(0);
    const Vec3 p = d * (glm::length(centre) / towards);
    const float x = glm::dot(p, right) / half_width, y = glm::dot(p, top) / half_height;
    if (std::abs(x) >= 1 || std::abs(y) >= 1) return Vec3(0);
    const float corner = half_width < half_height ? half_height / half_width : half_width / half_height; // > 1: squarer ends
    const float power = 2 + 2 * std::min(corner, 3.f);
    const float edge = std::pow(std::pow(std::abs(x), power) + std::pow(std::abs(y), power), 1 / power);
    const float graded = (1 + tilt.x * x) * (1 + tilt.y * y) * (1 - falloff * std::min(1.f, 0.5f * (x * x + y * y)));
    return radiance * ((1 - smooth_step(1 - softness, 1, edge)) * std::max(graded, 0.f));
  }
};

/// A dark room for metal: what a chrome thing shows is the room, so it is composed like a picture. A broad
/// overhead box makes the long soft highlight, two tall strips draw the silhouette on both sides, a warm
/// and a cool one behind make the rim, and a graded cyclorama, lit behind the subject as seen by a camera
/// that looks along -z, keeps the dark parts from being black.
Vec3 studio(const Vec3& d) {
  static const SoftBox boxes[] = {
      {{0.15f, 2.6f, 0.75f}, {0, 0, -1}, 2.3f, 1.15f, 0.9f, 0.5f, {0.12f, 0.5f}, {4.7f, 4.6f, 4.45f}},  // overhead
      {{-3.0f, 0.55f, 0.9f}, {0, 1, 0}, 0.72f, 1.95f, 0.9f, 0.2f, {0.6f, 0.3f}, {3.3f, 3.45f, 3.7f}},   // strip, left
      {{3.0f, 0.45f, 1.6f}, {0, 1, 0}, 0.42f, 1.7f, 0.9f, 0.2f, {-0.5f, 0.35f}, {2.5f, 2.42f, 2.3f}},   // strip, right
      {{-2.6f, 1.0f, -2.8f}, {0, 1, 0}, 0.8f, 1.9f, 0.95f, 0.2f, {-0.4f, 0.4f}, {0.55f, 1.0f, 1.9f}},   // rim, cool
      {{2.6f, 0.9f, -3.0f}, {0, 1, 0}, 0.95f, 1.6f, 0.95f, 0.2f, {0.4f, 0.4f}, {2.1f, 1.05f, 0.45f}},   // rim, warm
      {{0.6f, 0.55f, 3.2f}, {0, 1, 0}, 2.6f, 1.5f, 1.0f, 0.3f, {0.2f, 0.3f}, {0.20f, 0.205f, 0.22f}},   // fill, behind the camera
      {{0.2f, -2.6f, 1.5f}, {0, 0, -1}, 3.2f, 1.5f, 1.0f, 0.2f, {-0.3f, -0.3f}, {0.42f, 0.41f, 0.40f}}, // reflector, below
  };
  const float up = d.y;
  const float behind = std::exp(-3.5f * (1 + d.z) - 5 * (up - 0.1f) * (up - 0.1f)); // the pool of light on the wall
  const Vec3 wall =
      Vec3(0.020f, 0.022f, 0.027f) + Vec3(0.062f, 0.066f, 0.074f) * smooth_step(0.8f, -0.1f, up) + Vec3(0.125f, 0.13f, 0.14f) * behind;
  const Vec3 floor = Vec3(0.090f, 0.087f, 0.083f) * smooth_step(-1.05f, 0.f, up) + Vec3(0.014f) + Vec3(0.06f) * behind;
  const float below = smooth_step(0.02f, -0.06f, up);
  Vec3 light = wall * (1 - below) + floor * below;
  light += Vec3(0.075f, 0.078f, 0.083f) * gauss(up, 0.05f); // where floor and wall meet
  for (const SoftBox& box : boxes) light += box.seen_along(d);
  return light * 1.25f; // a matte thing of 80 % then comes out a little above 0.6
}

/// The room of a product shot, composed for mirrors that are seen from the front: very large boxes left and right from nearly the
/// floor up, a graded one behind the camera, narrow cool and warm ones at the rims, and dark gaps between them that draw the shape's
/// edges. What a camera sees that looks along -z, within 60 degrees to either side, is a backdrop that is as bright at the horizon as a
/// matte floor of colour (0.15, 0.165, 0.19) in this light, and darkens upwards: floor and backdrop are one sweep.
Vec3 cyclorama(const Vec3& d) {
  static const SoftBox boxes[] = {
      {{-3.0f, 1.3f, 0.2f}, {0, 1, 0}, 1.9f, 1.4f, 0.4f, 0.3f, {0.6f, 0.3f}, {3.8f, 4.0f, 4.3f}},    // left
      {{3.0f, 1.2f, 0.5f}, {0, 1, 0}, 1.1f, 1.5f, 0.4f, 0.3f, {-0.5f, 0.3f}, {4.3f, 4.0f, 3.6f}},    // right
      {{-2.7f, 1.6f, -1.7f}, {0, 1, 0}, 0.5f, 1.3f, 0.6f, 0.25f, {-0.3f, 0.3f}, {1.6f, 2.3f, 3.6f}}, // rim, cool
      {{2.8f, 1.6f, -1.5f}, {0, 1, 0}, 0.5f, 1.3f, 0.6f, 0.25f, {0.3f, 0.3f}, {3.9f, 2.6f, 1.5f}},   // rim, warm
      {{0.4f, 1.2f, 3.2f}, {0, 1, 0}, 1.5f, 0.8f, 0.6f, 0.35f, {0.3f, 0.5f}, {2.0f, 2.0f, 2.0f}},    // behind the camera
      {{0.1f, 2.6f, -0.9f}, {0, 0, -1}, 1.5f, 0.7f, 0.7f, 0.3f, {0.1f, 0.3f}, {1.6f, 1.6f, 1.6f}},   // overhead
  };
  const Vec3 horizon(0.0951f, 0.1036f, 0.1209f); // the floor's colour times what comes from above
  const float backdrop = smooth_step(0.15f, 0.5f, -d.z);
  Vec3 light = horizon * ((0.22f + 0.78f * backdrop) * (1 - 0.7f * smooth_step(0, 0.35f, d.y)));
  for (const SoftBox& box : boxes) light += box.seen_along(d);
  return light;
}

/// A clear sky without a sun (a sun light makes sharp shadows better), for a camera that looks anywhere.
Vec3 sky(const Vec3& d) {
  const float up = d.y;
  const Vec3 zenith(0.42f, 0.52f, 0.76f), low(0.86f, 0.91f, 0.98f), glow(1.45f, 1.2f, 0.95f), ground(0.17f, 0.155f, 0.135f);
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
  parallel_for(0, height, [&](int row) {
    const float theta = std::numbers::pi_v<float> * (float(row) + 0.5f) / float(height);
    for (int column = 0; column < width; ++column) {
      const float phi = 2 * std::numbers::pi_v<float> * ((float(column) + 0.5f) / float(width) - 0.5f);
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
  case EnvironmentPreset::cyclorama: return paint(1024, 512, cyclorama);
  case EnvironmentPreset::sky: return paint(512, 256, sky);
  case EnvironmentPreset::white: break;
  }
  return paint(16, 8, [](const Vec3&) { return Vec3(1); });
}

} // namespace kelpie
