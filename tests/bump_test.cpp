// Bumps: the slopes of heights, normals that can be seen, light that does not leak, and no shimmer at any distance.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "materials/bump.h"
#include "base/orthonormal_basis.h"
#include "tests/support/render.h"

namespace kelpie {
namespace {

/// A surface with a height.
template <template <class> class Kind>
Kind<SampledMode> raised(Kind<SampledMode> surface, float height) {
  surface.bump_height = height;
  return surface;
}

/// Materials of a scene; what is added gets the next index.
MaterialIndex add(FrameScene& scene, MaterialKinds::Variant<SampledMode> material) {
  scene.materials.push_back(std::move(material));
  return {static_cast<uint32_t>(scene.materials.size() - 1)};
}

/// A pattern whose surfaces stand out by 0 where it is 0, and by `height` where it is 1.
template <template <class> class Pattern, template <class> class Surface>
MaterialIndex add_bump(FrameScene& scene, Pattern<SampledMode> pattern, const Surface<SampledMode>& surface, float height) {
  pattern.stops.resize(2);
  pattern.stops[0] = {0, add(scene, surface)};
  pattern.stops[1] = {1, add(scene, raised(surface, height))};
  pattern.prepare();
  return add(scene, pattern);
}

Matte<SampledMode> white_matte() {
  Matte<SampledMode> m;
  m.colour.rgb = Vec3(1);
  return m;
}

/// A plane, z = 0, seen from above.
FrameScene plane_from(float distance) {
  FrameScene scene;
  Plane<SampledMode> plane;
  plane.normal = Vec3(0, 0, 1);
  SampledShape shape;
  shape.geometry = plane;
  scene.shapes.push_back(shape);
  scene.camera.position = Vec3(0.02f, 0.03f, distance), scene.camera.look_at = Vec3(0.02f, 0.03f, 0), scene.camera.fov = 20;
  scene.film.resolution = {16, 16}, scene.film.spp = 16, scene.film.bounces = 0;
  return scene;
}

void add_sun(FrameScene& scene, const Vec3& direction) {
  SunLight<SampledMode> sun;
  sun.direction = direction, sun.strength = 2, sun.angle = 0;
  scene.lights.emplace_back(sun);
}

Gradient<SampledMode> along(const Vec3& direction, float size) {
  Gradient<SampledMode> gradient;
  gradient.direction = direction, gradient.size = size;
  return gradient;
}

std::vector<float> pixels_of(const FrameScene& scene) { return render(scene).image.find("G")->pixels; }

Vec3 normal_at(const IntegrateResult& result, int x, int y) {
  const size_t i = result.image.index(x, y);
  return {result.image.find("N.X")->pixels[i], result.image.find("N.Y")->pixels[i], result.image.find("N.Z")->pixels[i]};
}

TEST(Bump, NormalsCanBeSeenAndMirrorWhatLiesAboveTheSurface) {
  std::mt19937 random(1);
  const auto between = [&](float a, float b) { return a + (b - a) * static_cast<float>(random() >> 8) * 0x1p-24f; };
  const auto direction = [&] {
    const float z = between(-1, 1), phi = between(0, 6.2831853f), sine = std::sqrt(1 - z * z);
    return Vec3(sine * std::cos(phi), sine * std::sin(phi), z);
  };
  int kept = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Vec3 normal = direction();
    Vec3 out = direction();
    const float up = std::exp2(between(-16, 0)), side = glm::dot(out, normal); // also along the surface
    out = glm::normalize(out - side * normal + up * normal);
    const OrthonormalBasis basis(normal);
    const Vec3 slope = std::exp2(between(-8, 8)) * glm::normalize(between(-1, 1) * basis.x + between(-1, 1) * basis.y);
    const Vec3 raised = raised_normal(normal, slope), seen = seen_normal(normal, raised, out);
    ASSERT_NEAR(glm::length(seen), 1, 1e-5f);
    ASSERT_GT(glm::dot(seen, normal), 0);
    ASSERT_GT(glm::dot(seen, out), 0);
    ASSERT_GT(glm::dot(2 * glm::dot(seen, out) * seen - out, normal), -1e-6f) << i;
    kept += seen == raised;
    const Vec3 in = direction();
    const float past = past_bumps(normal, seen, in);
    ASSERT_GE(past, 0);
    ASSERT_LE(past, 1);
    if (glm::dot(in, normal) <= 0) {
      ASSERT_EQ(past, 0);
    }
  }
  EXPECT_GT(kept, 20'000) << "what can be seen stays as it is";
}

TEST(Bump, AGradientTiltsTheNormalByItsSlope) {
  for (const float height : {0.1f, -0.4f, 1.5f}) {
    FrameScene scene = plane_from(2);
    scene.shapes[0].surface = add_bump(scene, along(Vec3(1, 1, 0), 4), white_matte(), height);
    add_sun(scene, Vec3(0, 0, 1));
    // Half of it: stops are as far apart as the profile is long, which is linear
    const Vec3 expected = glm::normalize(Vec3(0, 0, 1) - height / 4 * glm::normalize(Vec3(1, 1, 0)));
    scene.camera.position += Vec3(1, 1, 0), scene.camera.look_at += Vec3(1, 1, 0);
    const IntegrateResult result = render(scene);
    const Vec3 found = normal_at(result, 8, 8);
    EXPECT_LT(glm::distance(found, expected), 2e-3f) << height;
    EXPECT_NEAR(result.image.find("R")->pixels[result.image.index(8, 8)], 2 / 3.14159265f * found.z, 0.01f);
  }
}

// In a node that is twice as large heights are twice as high, and slopes stay; turned, they turn.
TEST(Bump, LivesInTheSpaceOfItsNode) {
  FrameScene scene = plane_from(12);
  scene.shapes[0].geometry.reset();
  SampledField& field = scene.shapes[0].field;
  SdfBox<SampledMode> box;
  box.size = Vec3(2, 2, 2), box.centre = Vec3(0, 0, -1);
  Scale<SampledMode> scale;
  scale.by = Vec3(3), scale.child = 0;
  Rotate<SampledMode> turn;
  turn.axis = Vec3(0, 0, 1), turn.angle = 90, turn.child = 1;
  field.nodes.emplace_back(box), field.nodes.emplace_back(scale), field.nodes.emplace_back(turn);
  field.materials.resize(3);
  field.materials[0] = add_bump(scene, along(Vec3(1, 0, 0), 1), white_matte(), 0.3f);
  scene.camera.position += Vec3(0, 1.5f, 0), scene.camera.look_at += Vec3(0, 1.5f, 0); // the middle of the gradient, which now goes up
  const Vec3 found = normal_at(render(scene), 8, 8), expected = glm::normalize(Vec3(0, -0.3f, 1));
  EXPECT_LT(glm::distance(found, expected), 4e-3f) << found.x << " " << found.y << " " << found.z;
}

// Where two materials meet there is a step, as high as they differ.
TEST(Bump, AStripeHasWallsAndIsFlatBetweenThem) {
  FrameScene scene = plane_from(2);
  Stripes<SampledMode> stripes;
  stripes.size = 0.5f, stripes.softness = 1;
  scene.shapes[0].surface = add_bump(scene, stripes, white_matte(), 0.05f);
  scene.film.resolution = {256, 4};
  const IntegrateResult result = render(scene);
  float steepest = 0, sum = 0;
  for (int x = 0; x < 256; ++x) {
    const Vec3 n = normal_at(result, x, 2);
    steepest = std::max(steepest, std::abs(n.x / n.z)), sum += n.x / n.z;
  }
  EXPECT_NEAR(steepest, 0.05f * 1.5f / 0.25f, 0.02f); // t^2 (3 - 2 t) over half a period
  EXPECT_LT(std::abs(sum / 256), 0.02f * steepest) << "up as far as down";
}

TEST(Bump, MakesNoLight) {
  for (const bool is_metal : {false, true}) {
    FrameScene scene = plane_from(4);
    scene.camera.position = Vec3(0, -4, 2), scene.camera.look_at = Vec3(0), scene.camera.up = Vec3(0, 0, 1);
    EnvironmentLight<SampledMode> light;
    light.preset = EnvironmentPreset::white;
    scene.lights.emplace_back(light);
    scene.film.bounces = 8, scene.film.spp = 256;
    Dents<SampledMode> dents;
    dents.size = 0.4f;
    Metal<SampledMode> metal;
    metal.colour.rgb = Vec3(1), metal.roughness = 0.2f;
    scene.shapes[0].surface = is_metal ? add_bump(scene, dents, metal, 0.1f) : add_bump(scene, dents, white_matte(), 0.1f);
    double mean = 0;
    for (const float v : pixels_of(scene)) mean += v / 256.;
    EXPECT_LE(mean, 1.002);
    EXPECT_GE(mean, 0.85);
  }
}

TEST(Bump, LightFromBelowDoesNotLeakThroughTheSurface) {
  FrameScene scene = plane_from(2);
  Dents<SampledMode> dents;
  scene.shapes[0].surface = add_bump(scene, dents, white_matte(), 0.3f);
  add_sun(scene, Vec3(1, 0, -0.02f));
  for (const float v : pixels_of(scene)) ASSERT_EQ(v, 0);
  scene.lights.clear();
  add_sun(scene, Vec3(1, 0, 0.3f));
  float brightest = 0;
  for (const float v : pixels_of(scene)) brightest = std::max(brightest, v);
  EXPECT_GT(brightest, 0.3f) << "though slopes reach the light";
}

TEST(Bump, DoesNotShimmerAtAnyDistance) {
  Dents<SampledMode> dents;
  dents.size = 0.25f;
  double near_mean = 0;
  for (int step = 0; step < 24; ++step) {
    const double pixels = std::exp2(6 - 12 * step / 23.); // a period: 64 to 1/64
    SCOPED_TRACE(pixels);
    const float pixel = float(dents.size / pixels);
    FrameScene scene = plane_from(pixel * 8 / std::tan(0.1745329f));
    scene.film.resolution = {16, 16};
    scene.camera.position += Vec3(0.37f, 0.21f, 0), scene.camera.look_at += Vec3(0.37f, 0.21f, 0);
    scene.shapes[0].surface = add_bump(scene, dents, white_matte(), 0.025f);
    add_sun(scene, Vec3(1, 0, 1));
    double sum = 0, squares = 0;
    for (const float v : pixels_of(scene)) sum += v, squares += double(v) * v;
    const double mean = sum / 256, deviation = std::sqrt(std::max(0., squares / 256 - mean * mean));
    if (pixels < 4) {
      near_mean = near_mean == 0 ? mean : near_mean;
      EXPECT_NEAR(mean, near_mean, 0.03 * near_mean);
    }
    if (pixels < 0.5) {
      EXPECT_LE(deviation, 0.06 * mean);
    }
    if (pixels > 8) {
      EXPECT_GE(deviation, 0.02 * mean) << "the dents are there";
    }
  }
}

// What is too fine to be seen as a bump blurs what is reflected.
TEST(Bump, FinerThanAPixelIsRoughness) {
  FrameScene scene = plane_from(400);
  Metal<SampledMode> mirror;
  mirror.colour.rgb = Vec3(1), mirror.roughness = 0.05f;
  SunLight<SampledMode> sun;
  sun.direction = Vec3(0.3f, 0, 1), sun.strength = 2, sun.angle = 0; // its mirror image is 8 degrees beside the camera
  scene.lights.emplace_back(sun);
  const auto brightness = [&] {
    double mean = 0;
    for (const float v : pixels_of(scene)) mean += v / 256.;
    return mean;
  };
  set_surface(scene, 0, mirror);
  const double smooth = brightness();
  Dents<SampledMode> dents;
  scene.shapes[0].surface = add_bump(scene, dents, mirror, 0.05f);
  EXPECT_GT(brightness(), 5 * smooth);
}

TEST(Bump, OfOneHeightIsNone) {
  FrameScene scene = plane_from(2);
  add_sun(scene, Vec3(1, 0, 1));
  set_surface(scene, 0, white_matte());
  const auto flat = pixels_of(scene);
  set_surface(scene, 0, raised(white_matte(), 0.7f));
  EXPECT_EQ(pixels_of(scene), flat);
}

TEST(OrthonormalBasis, LiesAlongADirection) {
  for (const Vec3& z : {Vec3(0, 0, 1), Vec3(0, 0, -1), glm::normalize(Vec3(1, -2, 0.5f))})
    for (const Vec3& along : {Vec3(1, 0, 0), Vec3(0, 3, 0), Vec3(0, 0, 2)}) {
      const OrthonormalBasis basis(z, along);
      EXPECT_NEAR(glm::dot(basis.x, basis.y), 0, 1e-6f);
      EXPECT_NEAR(glm::dot(glm::cross(basis.x, basis.y), z), 1, 1e-5f);
      EXPECT_NEAR(glm::dot(basis.y, along), 0, 1e-5f);
      EXPECT_GE(glm::dot(basis.x, along), -1e-6f);
    }
}

} // namespace
} // namespace kelpie
