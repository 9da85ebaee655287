// Clear things whose light is known: slabs, nested media, furnaces.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/random_scene.h"
#include "tests/support/render.h"

namespace kelpie {
namespace {

/// Seen straight on from far away, in light that is the same from everywhere.
FrameScene in_white(int bounces) {
  FrameScene scene;
  EnvironmentLight<SampledMode> light;
  light.preset = EnvironmentPreset::white;
  scene.lights.emplace_back(light);
  scene.camera.position = Vec3(0, 0, 60), scene.camera.fov = 0.5f;
  scene.film.resolution = {8, 8}, scene.film.spp = 256, scene.film.bounces = bounces;
  return scene;
}

/// A plate across the view, from z = `from` to `to`.
void add_plate(FrameScene& scene, float from, float to, const Glass<SampledMode>& glass, int priority = 0) {
  SdfBox<SampledMode> box;
  box.centre = Vec3(0, 0, (from + to) / 2), box.size = Vec3(20, 20, to - from);
  SampledShape shape;
  shape.field.nodes.emplace_back(box);
  shape.priority = priority;
  scene.shapes.push_back(std::move(shape));
  set_surface(scene, scene.shapes.size() - 1, glass);
}

Glass<SampledMode> glass_of(const Vec3& colour, float depth, float ior = 1.5f) {
  Glass<SampledMode> glass;
  glass.colour.rgb = colour, glass.depth = depth, glass.ior = ior;
  return glass;
}

Vec3d mean_of(const IntegrateResult& result) {
  Vec3d mean(0);
  const char* names[] = {"R", "G", "B"};
  for (int c = 0; c < 3; ++c)
    for (const float v : result.image.find(names[c])->pixels) mean[c] += v / double(result.image.find(names[c])->pixels.size());
  return mean;
}

/// What a plate in white light sends to a viewer straight before it: `left` of the light on one way through it. All that is not absorbed,
/// reflected r at each face.
double plate(double left, double r) {
  const double round = r * left * r * left, once = (1 - r) * (1 - r) * left;
  return r + once * (r * left) / (1 - round) + once / (1 - round);
}

constexpr double k_reflected = 0.04; // (0.5 / 2.5)^2

TEST(Dielectrics, APlateAbsorbsByItsDepth) {
  FrameScene scene = in_white(40);
  const Vec3 colour(0.8f, 0.4f, 0.1f);
  add_plate(scene, -0.5f, 1, glass_of(colour, 1));
  const Vec3d found = mean_of(render(scene));
  for (int c = 0; c < 3; ++c) {
    const double truth = plate(std::pow(double(colour[c]), 1.5), k_reflected);
    EXPECT_NEAR(found[c], truth, 0.01 * truth) << c;
  }
}

// A liquid that reaches into its glass: the place that both claim is the glass's, and between them there is no face if they refract alike.
TEST(Dielectrics, OfOverlappingMediaTheHigherPriorityFills) {
  for (const bool liquid_first : {false, true}) {
    FrameScene scene = in_white(40);
    const Glass<SampledMode> glass = glass_of(Vec3(0.9f, 0.5f, 0.5f), 1), liquid = glass_of(Vec3(0.5f, 0.5f, 0.9f), 1);
    if (liquid_first) add_plate(scene, -1, 0.3f, liquid);
    add_plate(scene, 0, 1, glass, 1);
    if (!liquid_first) add_plate(scene, -1, 0.3f, liquid);
    const Vec3d found = mean_of(render(scene));
    for (int c = 0; c < 3; ++c) {
      const double left = double(glass.colour.rgb[c]) * double(liquid.colour.rgb[c]); // each is 1 thick where it fills
      EXPECT_NEAR(found[c], plate(left, k_reflected), 0.01) << c;
    }
  }
}

// No light is lost in a clear ball, nor in one with a bubble, frosted or polished.
TEST(Dielectrics, ClearThingsInWhiteLightAreInvisible) {
  for (const float roughness : {0.f, 0.3f}) {
    FrameScene scene = in_white(200);
    scene.camera.position = Vec3(0, 0, 6), scene.camera.fov = 25;
    scene.film.resolution = {24, 24}, scene.film.spp = 64;
    for (const int priority : {0, 1}) {
      SdfSphere<SampledMode> ball;
      ball.centre = Vec3(0.2f * float(priority), 0, 0), ball.sphere_radius = priority ? 0.3f : 1.f;
      SampledShape shape;
      shape.field.nodes.emplace_back(ball);
      shape.priority = priority;
      scene.shapes.push_back(std::move(shape));
      Glass<SampledMode> glass = glass_of(Vec3(1), 0, priority ? 1.f : 1.5f);
      glass.roughness = roughness;
      set_surface(scene, scene.shapes.size() - 1, glass);
    }
    const Vec3d found = mean_of(render(scene));
    EXPECT_NEAR(found.y, 1, 0.01) << roughness;
  }
}

} // namespace
} // namespace kelpie
