// Lights that have a place in the scene, against closed forms: by themselves, and in whole frames.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "base/orthonormal_basis.h"
#include "tests/support/random_kind.h"
#include "tests/support/render.h"

namespace kelpie {
namespace {

constexpr uint32_t k_light_samples = 4096;

template <class Kind>
Light light_of(const Kind& kind) {
  Diagnostics diagnostics;
  EnvironmentCache cache;
  return Light(make_emitter(kind, cache, diagnostics));
}

/// On a surface at p of normal n, by samples of the light.
double irradiance(const Light& light, const Vec3& p, const Vec3& n) {
  double sum = 0;
  for (uint32_t s = 0; s < k_light_samples; ++s) {
    const Arrival a = light.sample(p, Sampler(0, 0, 0, s).next_pair());
    if (a.pdf > 0) sum += a.radiance.x * std::max(0.f, glm::dot(a.direction, n)) / a.pdf / k_light_samples;
  }
  return sum;
}

/// Of a rectangle of radiance 1 that faces a surface, at a height above it and with a corner above the point that is lit: pi times
/// the form factor (Howell, "A catalog of radiation heat transfer configuration factors", B-3).
double under_a_corner(double width, double length, double height) {
  const double x = width / height, y = length / height, a = std::sqrt(1 + x * x), b = std::sqrt(1 + y * y);
  return 0.5 * (x / a * std::atan(y / a) + y / b * std::atan(x / b));
}

RectangleLight<SampledMode> rectangle() {
  RectangleLight<SampledMode> light;
  light.position = Vec3(0.3f, 0.2f, 1.5f), light.target = Vec3(0.3f, 0.2f, 0), light.width = 2, light.height = 1, light.strength = 10;
  return light;
}
DiscLight<SampledMode> disc() {
  DiscLight<SampledMode> light;
  light.position = Vec3(0, 0, 1.5f), light.target = Vec3(0), light.radius = 0.7f, light.strength = 10;
  return light;
}
SphereLight<SampledMode> sphere() {
  SphereLight<SampledMode> light;
  light.position = Vec3(1, 0, 2), light.radius = 0.7f, light.strength = 10;
  return light;
}

TEST(NearLights, RectangleHasItsFormFactor) {
  const auto light = rectangle(); // its edges lie at x -0.7 and 1.3, y -0.3 and 0.7
  const double expected =
      under_a_corner(1.3, 0.7, 1.5) + under_a_corner(0.7, 0.7, 1.5) + under_a_corner(1.3, 0.3, 1.5) + under_a_corner(0.7, 0.3, 1.5);
  EXPECT_NEAR(irradiance(light_of(light), Vec3(0), Vec3(0, 0, 1)), 10 / 2.0 * expected, 0.01 * 5 * expected);
  EXPECT_EQ(irradiance(light_of(light), Vec3(0, 0, 3), Vec3(0, 0, -1)), 0); // behind it
}

TEST(NearLights, DiscHasItsFormFactor) {
  const double radiance = 10 / (std::numbers::pi * 0.7 * 0.7), expected = std::numbers::pi * radiance * 0.7 * 0.7 / (0.7 * 0.7 + 1.5 * 1.5);
  EXPECT_NEAR(irradiance(light_of(disc()), Vec3(0), Vec3(0, 0, 1)), expected, 0.01 * expected);
  EXPECT_EQ(irradiance(light_of(disc()), Vec3(0, 0, 3), Vec3(0, 0, -1)), 0);
}

// Of a ball wholly above the horizon: that of all its light from its middle.
TEST(NearLights, SphereIsLitAsFromItsMiddle) {
  const double d2 = 5, expected = 10 / d2 * 2 / std::sqrt(d2);
  EXPECT_NEAR(irradiance(light_of(sphere()), Vec3(0), Vec3(0, 0, 1)), expected, 0.01 * expected);
  EXPECT_EQ(irradiance(light_of(sphere()), Vec3(1, 0, 2.1f), Vec3(0, 0, 1)), 0); // in it
}

TEST(NearLights, PointFallsWithTheSquareOfTheDistance) {
  PointLight<SampledMode> light;
  light.position = Vec3(0, 0, 2), light.strength = 10;
  EXPECT_NEAR(irradiance(light_of(light), Vec3(0), Vec3(0, 0, 1)), 10 / 4.0, 1e-3);
  EXPECT_NEAR(irradiance(light_of(light), Vec3(0, 0, 1), Vec3(0, 0, 1)), 10, 1e-3);
}

// Far away the size does not matter: strength is what it says.
TEST(NearLights, StrengthIsTheIrradianceAtOneUnitWereTheySmall) {
  auto r = rectangle();
  auto d = disc();
  auto s = sphere();
  r.position = d.position = s.position = Vec3(0, 0, 100), r.target = Vec3(0);
  for (const Light& light : {light_of(r), light_of(d), light_of(s)})
    EXPECT_NEAR(irradiance(light, Vec3(0), Vec3(0, 0, 1)) * 100 * 100, 10, 0.01);
}

// What samples say of a direction, and what a ray in that direction finds, are the same; and the density is one.
TEST(NearLights, SamplesAreWhatRaysFind) {
  Random r(7);
  auto from_below = rectangle();
  from_below.up = Vec3(0, 0, 1); // along its normal
  for (const Light& light : {light_of(rectangle()), light_of(from_below), light_of(disc()), light_of(sphere())})
    for (int trial = 0; trial < 20; ++trial) {
      const Vec3 p(r.uniform(-2, 2), r.uniform(-2, 2), r.uniform(-2, 1));
      int found = 0;
      double density = 0, seen = 0;
      for (uint32_t i = 0; i < k_light_samples; ++i) {
        const Arrival a = light.sample(p, Sampler(0, 0, 0, i).next_pair());
        if (!(a.pdf > 0)) continue;
        ASSERT_NEAR(glm::length(a.direction), 1, 1e-5);
        const Arrival b = light.seen_along(p, a.direction);
        if (b.radiance == Vec3(0)) continue; // at its very edge
        ++found;
        EXPECT_EQ(a.radiance, b.radiance);
        EXPECT_NEAR(a.pdf, b.pdf, 2e-3 * a.pdf);
        EXPECT_NEAR(a.distance, b.distance, 2e-3 * a.distance);
      }
      EXPECT_GT(found, 0.98 * k_light_samples);
      const OrthonormalBasis around(glm::normalize(light.sample(p, Vec2(0.5f)).direction));
      constexpr int n = 300;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const double cosine = 1 - 2 * (i + 0.5) / n, sine = std::sqrt(1 - cosine * cosine), phi = 2 * std::numbers::pi * (j + 0.5) / n;
          const Arrival a = light.seen_along(p, around.world_from_local(Vec3(sine * std::cos(phi), sine * std::sin(phi), cosine)));
          density += a.pdf * 4 * std::numbers::pi / (n * n), seen += a.pdf > 0;
        }
      EXPECT_NEAR(density, 1, 0.02 + 5 / std::sqrt(seen * 4)) << seen;
    }
}

// --- whole frames ---

/// A plane z = 0 seen from above.
FrameScene floor_scene(MaterialKinds::Variant<SampledMode> surface) {
  FrameScene scene;
  SampledShape shape;
  Plane<SampledMode> plane;
  plane.normal = Vec3(0, 0, 1);
  shape.geometry = plane;
  scene.shapes.push_back(shape);
  set_surface(scene, 0, std::move(surface));
  scene.camera.position = Vec3(0, 0, 40), scene.camera.fov = 0.05f;
  scene.film.resolution = {4, 4}, scene.film.spp = 1024, scene.film.bounces = 0;
  return scene;
}

double mean_green(const FrameScene& scene) {
  const IntegrateResult result = render(scene);
  double sum = 0;
  for (const float v : result.image.find("G")->pixels) sum += v;
  return sum / double(result.image.find("G")->pixels.size());
}

TEST(NearLightsInAFrame, LightAMattePlane) {
  Matte<SampledMode> matte;
  matte.colour.rgb = Vec3(0.5f);
  FrameScene scene = floor_scene(matte);
  auto light = sphere();
  light.visible = false;
  scene.lights.emplace_back(light);
  const double expected = 0.5 / std::numbers::pi * 10 / 5.0 * 2 / std::sqrt(5.0);
  EXPECT_NEAR(mean_green(scene), expected, 0.01 * expected);
  PointLight<SampledMode> point;
  point.position = light.position, point.strength = 10;
  scene.lights = {point};
  EXPECT_NEAR(mean_green(scene), expected, 0.001 * expected);
}

/// What a rough metal plane shows of a light to a viewer above, by samples of the light alone.
double by_samples_of_light(const Light& light, const SurfaceBsdf& bsdf) {
  double sum = 0;
  constexpr uint32_t n = 1 << 18;
  for (uint32_t s = 0; s < n; ++s) {
    const Arrival a = light.sample(Vec3(0), Sampler(0, 0, 0, s).next_pair());
    if (a.pdf > 0) sum += bsdf.evaluate(Vec3(0, 0, 1), a.direction).y * a.radiance.y / a.pdf / n;
  }
  return sum;
}

// Samples of lights and scattered rays, weighed, are what samples of lights are alone: on the last vertex and before it.
TEST(NearLightsInAFrame, BothWaysToALightAgreeWithOne) {
  auto from_the_side = sphere();
  from_the_side.visible = false;
  auto above = rectangle();
  above.visible = false;
  auto round = disc();
  round.visible = false;
  for (const float roughness : {0.3f, 0.6f})
    for (const LightKinds::Variant<SampledMode>& kind : {LightKinds::Variant<SampledMode>(from_the_side), {above}, {round}}) {
      Metal<SampledMode> metal;
      metal.roughness = roughness;
      FrameScene scene = floor_scene(metal);
      scene.lights.push_back(kind);
      const Light light = std::visit([](const auto& k) { return light_of(k); }, kind);
      const double expected = by_samples_of_light(light, SurfaceBsdf(metal.surface()));
      for (const int bounces : {0, 3}) {
        scene.film.bounces = bounces;
        EXPECT_NEAR(mean_green(scene), expected, 0.02 * expected) << roughness << " " << bounces;
      }
    }
}

TEST(NearLightsInAFrame, AreSeenUnlessTheyAreInvisible) {
  FrameScene scene = floor_scene(Matte<SampledMode>{});
  std::get<Matte<SampledMode>>(scene.materials[0]).colour.rgb = Vec3(0);
  auto light = sphere();
  light.position = Vec3(0, 0, 3);
  scene.lights.emplace_back(light);
  const double radiance = 10 / (std::numbers::pi * 0.7 * 0.7);
  EXPECT_NEAR(mean_green(scene), radiance, 1e-3 * radiance);
  std::get<SphereLight<SampledMode>>(scene.lights[0]).visible = false;
  EXPECT_EQ(mean_green(scene), 0);
  std::get<SphereLight<SampledMode>>(scene.lights[0]).visible = true;
  std::get<SphereLight<SampledMode>>(scene.lights[0]).position = Vec3(0, 0, -3); // behind the plane
  EXPECT_EQ(mean_green(scene), 0);
}

// A mirror shows a light that the camera does not see.
TEST(NearLightsInAFrame, AreSeenInAMirror) {
  Metal<SampledMode> mirror;
  mirror.roughness = 0, mirror.colour.rgb = Vec3(1);
  FrameScene scene = floor_scene(mirror);
  auto light = sphere();
  light.position = Vec3(0, 0, 3), light.visible = false;
  scene.lights.emplace_back(light);
  const double radiance = 10 / (std::numbers::pi * 0.7 * 0.7);
  for (const int bounces : {0, 2}) {
    scene.film.bounces = bounces;
    EXPECT_NEAR(mean_green(scene), radiance, 1e-3 * radiance) << bounces;
  }
}

// What lies before a light hides it; what lies beyond it does not.
TEST(NearLightsInAFrame, AreHiddenByWhatLiesBeforeThem) {
  Matte<SampledMode> matte;
  FrameScene scene = floor_scene(matte);
  auto light = disc();
  light.visible = false;
  scene.lights.emplace_back(light);
  const double lit = mean_green(scene);
  EXPECT_GT(lit, 0);
  SdfBox<SampledMode> box; // beside the view of the camera
  SampledShape lid;
  lid.field.nodes.emplace_back(box);
  const auto with_lid_at = [&](float z) {
    FrameScene covered = scene;
    box.centre = Vec3(0, 0, z), box.size = Vec3(8, 8, 0.2f);
    lid.field.nodes = {box};
    covered.shapes.push_back(lid);
    set_surface(covered, 1, matte);
    covered.camera.position = Vec3(0, 0, 0.4f), covered.camera.look_at = Vec3(0), covered.camera.fov = 1;
    covered.camera.up = Vec3(0, 1, 0);
    return mean_green(covered);
  };
  EXPECT_NEAR(with_lid_at(3), lit, 0.01 * lit);
  EXPECT_EQ(with_lid_at(1), 0);
}

} // namespace
} // namespace kelpie
