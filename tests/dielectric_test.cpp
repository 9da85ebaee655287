// Clear things whose light is known: slabs, nested media, furnaces.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "materials/fresnel.h"
#include "renderer/integrate/wavelength.h"
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

// A hit that lies exactly on a face, as float numbers have it, has the normal of the face.
TEST(Dielectrics, AFlatFaceIsFlatAtRoundPlaces) {
  FrameScene scene = in_white(0);
  add_plate(scene, 2, 3, {});
  scene.camera.position = Vec3(0, -8, 8), scene.camera.fov = 20, scene.film.resolution = {64, 64}, scene.film.spp = 1;
  const std::vector<float> found = render(scene).image.find("N.Z")->pixels;
  EXPECT_EQ(std::count(found.begin(), found.end(), 1.f), 64 * 64);
}

/// A matte plane below a plate, seen from between them.
FrameScene plane_below(const Glass<SampledMode>& glass, bool tinted) {
  FrameScene scene = in_white(12);
  scene.lights.clear();
  Plane<SampledMode> plane;
  plane.normal = Vec3(0, 0, 1);
  SampledShape shape;
  shape.geometry = plane;
  scene.shapes.push_back(std::move(shape));
  Matte<SampledMode> matte;
  matte.colour.rgb = Vec3(0.5f);
  set_surface(scene, 0, matte);
  add_plate(scene, 0.3f, 0.5f, glass);
  scene.camera.position = Vec3(0, 0, 0.2f), scene.film.tinted_shadows = tinted;
  return scene;
}

// Light of a sun on a matte plane below a coloured plate: what both faces let pass and what the glass leaves.
TEST(Dielectrics, AShadowOfGlassIsTinted) {
  const Vec3 colour(0.8f, 0.4f, 0.1f);
  for (const float angle : {0.f, 50.f}) {
    FrameScene scene = plane_below(glass_of(colour, 0.2f), true);
    SunLight<SampledMode> sun;
    const float slope = angle * 0.0174532925f;
    sun.direction = Vec3(std::sin(slope), 0, std::cos(slope)), sun.strength = 3, sun.angle = 0;
    scene.lights.emplace_back(sun);
    scene.film.bounces = 0;
    const Vec3d found = mean_of(render(scene));
    const double cosine = std::cos(slope), reflected = fresnel_dielectric(std::cos(slope), 1.5f);
    for (int c = 0; c < 3; ++c) {
      const double left = std::pow(double(colour[c]), 1 / cosine) * (1 - reflected) * (1 - reflected);
      const double truth = 0.5 * 3 / 3.14159265 * cosine * left;
      EXPECT_NEAR(found[c], truth, 0.01 * truth) << c;
    }
  }
}

// No light is counted twice, and none is lost: below a clear plate in light from everywhere, the plane gets what the plate lets pass, and
// what that throws back of its own.
TEST(Dielectrics, TintedShadowsAreAsBrightAsALightBehindGlass) {
  double passed = 0; // of light from all around, reflected to and fro in the plate
  constexpr int k_steps = 1000;
  for (int i = 0; i < k_steps; ++i) {
    const double cosine = (i + 0.5) / k_steps, reflected = fresnel_dielectric(float(cosine), 1.5f);
    passed += 2 * cosine * (1 - reflected) / (1 + reflected) / k_steps;
  }
  const double truth = 0.5 * passed / (1 - 0.5 * (1 - passed));
  FrameScene scene = plane_below(glass_of(Vec3(1), 0), true);
  EnvironmentLight<SampledMode> light;
  light.preset = EnvironmentPreset::white;
  scene.lights.emplace_back(light);
  scene.film.spp = 1024, scene.film.bounces = 40;
  EXPECT_NEAR(mean_of(render(scene)).y, truth, 0.04 * truth); // what matte surfaces see of glass is blurred
}

// What is opaque stays so.
TEST(Dielectrics, AnOpaqueShapeBehindGlassShades) {
  FrameScene scene = plane_below(glass_of(Vec3(1), 0), true);
  SunLight<SampledMode> sun;
  sun.direction = Vec3(0, 0, 1), sun.angle = 0;
  scene.lights.emplace_back(sun);
  EXPECT_GT(mean_of(render(scene)).y, 0.1);
  add_plate(scene, 5, 6, {});
  set_surface(scene, 2, Matte<SampledMode>{});
  scene.film.bounces = 0;
  EXPECT_EQ(mean_of(render(scene)).y, 0);
}

SurfaceParameters dispersive(float ior, float abbe, float scale) {
  SurfaceParameters s;
  s.transmission_weight = 1, s.specular_ior = ior, s.specular_roughness = 0;
  s.transmission_dispersion_abbe_number = abbe, s.transmission_dispersion_scale = scale;
  return s;
}

TEST(Dispersion, HasTheAbbeNumberThatIsAskedFor) {
  for (const float abbe : {20.f, 55.f})
    for (const float scale : {0.25f, 1.f}) {
      const SurfaceParameters s = dispersive(1.6f, abbe, scale);
      EXPECT_NEAR(ior_at(s, 587.6f), 1.6f, 1e-5f);
      EXPECT_NEAR((1.6f - 1) / (ior_at(s, 486.1f) - ior_at(s, 656.3f)), abbe / scale, 0.01f * abbe / scale);
    }
  EXPECT_EQ(ior_at(dispersive(1.6f, 20, 0), 486.1f), 1.6f);
  EXPECT_EQ(ior_at(dispersive(1.6f, 20, 1), 0), 1.6f) << "light of all colours";
}

TEST(Dispersion, LeavesWhiteWhite) {
  Vec3d sum(0);
  constexpr int k_count = 3000;
  for (int i = 0; i < k_count; ++i) {
    const Monochrome light = monochrome((float(i) + 0.5f) / k_count);
    EXPECT_NEAR(light.weight.x + light.weight.y + light.weight.z, 3, 1e-5f);
    EXPECT_GE(std::min({light.weight.x, light.weight.y, light.weight.z}), 0);
    sum += Vec3d(light.weight) / double(k_count);
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], 1, 1e-4) << c;

  FrameScene scene = in_white(200); // a clear ball in white light cannot be seen
  scene.camera.position = Vec3(0, 0, 6), scene.camera.fov = 25;
  scene.film.resolution = {16, 16};
  SdfSphere<SampledMode> ball;
  ball.sphere_radius = 1;
  SampledShape shape;
  shape.field.nodes.emplace_back(ball);
  scene.shapes.push_back(std::move(shape));
  set_surface(scene, 0, dispersive(1.7f, 20, 1));
  const Vec3d found = mean_of(render(scene));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], 1, 0.01) << c;
}

} // namespace
} // namespace kelpie
