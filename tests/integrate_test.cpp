// Light transport against what is known in closed form.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "renderer/film/pixel_filter.h"
#include "renderer/integrate/sample_batch.h"
#include "tests/support/render.h"

namespace kelpie {
namespace {

// The property that makes few samples enough: every 16 samples of a pixel fill all elementary intervals.
// Many samples at once are what each is alone, to the last bit.
TEST(Sampler, ABatchIsItsSamples) {
  for (const uint32_t count : {1u, 3u, 16u, 37u})
    for (uint32_t pixel = 0; pixel < 20; ++pixel) {
      const uint32_t first = 16 * pixel * pixel;
      std::vector<float> x(count), y(count), alone(count);
      for (uint32_t pair = 0; pair < 3; ++pair) {
        next_pairs({pixel, 7 * pixel, 5}, pair, first, count, x.data(), y.data());
        next_numbers({pixel, 7 * pixel, 5}, pair, first, count, alone.data());
        for (uint32_t i = 0; i < count; ++i) {
          Sampler sampler(pixel, 7 * pixel, 5, first + i), after({pixel, 7 * pixel, 5}, first + i, pair), again = after;
          for (uint32_t skipped = 0; skipped < pair; ++skipped) sampler.next_pair();
          const Vec2 point = sampler.next_pair();
          ASSERT_EQ(point, Vec2(x[i], y[i]));
          Sampler thrice = after;
          ASSERT_EQ(point, Vec2(thrice.next_triple()));
          ASSERT_EQ(point, after.next_pair());
          ASSERT_EQ(thrice.next_pair(), after.next_pair());
          ASSERT_EQ(again.next(), alone[i]);
        }
      }
    }
}

TEST(Sampler, EveryPointOfEveryPixelIsStratified) {
  for (uint32_t pixel = 0; pixel < 200; ++pixel)
    for (int pair = 0; pair < 4; ++pair) {
      std::array<int, 16> columns{}, rows{}, squares{}, thirds{};
      for (uint32_t s = 0; s < 16; ++s) {
        Sampler sampler(pixel, 3 * pixel + 1, 7, s);
        Vec3 u(0);
        for (int i = 0; i <= pair; ++i) u = sampler.next_triple();
        ++columns[size_t(u.x * 16)], ++rows[size_t(u.y * 16)], ++squares[size_t(u.x * 4) * 4 + size_t(u.y * 4)];
        ++thirds[size_t(u.z * 16)];
      }
      for (size_t i = 0; i < 16; ++i) {
        ASSERT_EQ(columns[i], 1);
        ASSERT_EQ(rows[i], 1);
        ASSERT_EQ(squares[i], 1);
        ASSERT_EQ(thirds[i], 1);
      }
    }
}

TEST(PixelFilter, OffsetsAreCentredAndOfTheFiltersWidth) {
  for (const PixelFilter kind : {PixelFilter::centre, PixelFilter::box, PixelFilter::gaussian}) {
    const PixelFilterSampler filter(kind);
    double mean = 0, square = 0;
    constexpr int n = 4096;
    for (int i = 0; i < n; ++i) {
      const double x = filter.offset(Vec2((float(i) + 0.5f) / n, 0.5f)).x;
      mean += x / n, square += x * x / n;
    }
    EXPECT_NEAR(mean, 0, 1e-3);
    const double expected = kind == PixelFilter::centre ? 0
                            : kind == PixelFilter::box  ? 1 / std::sqrt(12.0)
                                                        : 0.47; // cut off: a little below 0.5
    EXPECT_NEAR(std::sqrt(square), expected, 0.01);
  }
}

TEST(Lights, SunGivesItsStrengthWhateverItsAngle) {
  for (const float angle : {0.f, 0.02f, 0.53f, 20.f, 90.f}) {
    SunLight<SampledMode> sun;
    sun.direction = Vec3(0, 1, 0), sun.strength = 3, sun.angle = angle;
    const SunEmitter light(sun);
    double irradiance = 0;
    constexpr uint32_t n = 4096;
    for (uint32_t s = 0; s < n; ++s) {
      const Arrival a = light.sample(Vec3(0), Sampler(0, 0, 0, s).next_pair());
      irradiance += a.radiance.x * a.direction.y / a.pdf / n;
      EXPECT_FLOAT_EQ(a.is_delta ? 0 : light.seen_along(Vec3(0), a.direction).pdf, a.is_delta ? 0 : a.pdf);
    }
    EXPECT_NEAR(irradiance, 3, 3e-3) << angle;
  }
}

// --- whole frames ---

FrameScene blob_in_white(MaterialKinds::Variant<SampledMode> surface) {
  Point<SampledMode> point;
  point.radius = 1, point.weight = 2, point.falloff = Falloff::quartic;
  FrameScene scene = in_white(point, std::move(surface));
  scene.camera.position = Vec3(0, 0, 3);
  scene.film.resolution = {48, 32}, scene.film.spp = 16, scene.film.bounces = 4;
  return scene;
}

// A convex body in light that is the same from everywhere reflects its albedo, at every bounce limit.
TEST(Integrate, WhiteFurnace) {
  for (const int bounces : {0, 1, 4})
    for (const float albedo : {1.f, 0.5f}) {
      Matte<SampledMode> m;
      m.colour.rgb = Vec3(albedo);
      FrameScene scene = blob_in_white(m);
      scene.film.bounces = bounces, scene.film.background.kind = Background::Kind::transparent;
      const IntegrateResult result = render(scene);
      double sum = 0, coverage = 0;
      for (const float v : result.image.find("R")->pixels) sum += v;
      for (const float v : result.image.find("A")->pixels) coverage += v;
      ASSERT_GT(coverage, 50);
      EXPECT_NEAR(sum / coverage, albedo, 0.01 * albedo) << bounces;
    }
}

// A perfect mirror in white light cannot be told from the light.
TEST(Integrate, MirrorInWhiteLightIsInvisible) {
  Metal<SampledMode> m;
  m.colour.rgb = Vec3(1), m.roughness = 0;
  FrameScene scene = blob_in_white(m);
  scene.film.specular_antialiasing = false;
  const IntegrateResult result = render(scene);
  for (const float v : result.image.find("G")->pixels) EXPECT_NEAR(v, 1, 1e-4);
}

// A mirroring ball of radius r scatters a sun of irradiance E evenly, with the intensity E r^2 / 4. One that is 6 pixels wide does so
// without sparks.
TEST(Integrate, SmallChromeDropsDoNotSparkle) {
  struct Seen {
    double mean = 0, noise = 0;
  };
  FrameScene scene = blob_in_white(Metal<SampledMode>{});
  scene.lights.clear();
  SunLight<SampledMode> sun;
  sun.direction = Vec3(1, 1, 2), sun.angle = 0;
  scene.lights.emplace_back(sun);
  scene.camera.position = Vec3(0, 0, 8), scene.film.bounces = 0;
  const auto seen = [&](bool antialiased) {
    scene.film.specular_antialiasing = antialiased;
    Seen result;
    double squares = 0;
    constexpr int k_frames = 64;
    for (int frame = 0; frame < k_frames; ++frame) {
      scene.frame = frame;
      double sum = 0;
      const IntegrateResult picture = render(scene);
      for (const float v : picture.image.find("G")->pixels) sum += v;
      result.mean += sum / k_frames, squares += sum * sum / k_frames;
    }
    result.noise = std::sqrt(std::max(0., squares - result.mean * result.mean)) / result.mean;
    return result;
  };
  const Seen plain = seen(false), smooth = seen(true);
  const double r2 = 1 - std::sqrt(0.5), pixel = 2 * std::tan(double(scene.camera.fov) * std::numbers::pi / 360) / scene.film.resolution.y;
  const double truth = 0.9 * sun.strength * r2 / 4 / (8 * 8 * pixel * pixel);
  EXPECT_NEAR(smooth.mean, truth, 0.2 * truth); // a rough ball throws more back to where light comes from
  EXPECT_LT(smooth.noise, 0.1);
  EXPECT_LT(smooth.noise, 0.1 * plain.noise);
}

// A facing plane under a sun of irradiance E reflects albedo E / pi.
TEST(Integrate, SunOnAPlane) {
  FrameScene scene;
  SampledShape shape;
  Plane<SampledMode> plane;
  plane.normal = Vec3(0, 0, 1);
  shape.geometry = plane;
  Matte<SampledMode> m;
  m.colour.rgb = Vec3(0.5f);
  scene.shapes.push_back(shape);
  set_surface(scene, 0, m);
  SunLight<SampledMode> sun;
  sun.direction = Vec3(0, 0, 1), sun.strength = 2, sun.angle = 0;
  scene.lights.emplace_back(sun);
  scene.camera.position = Vec3(0, 0, 3), scene.film.resolution = {8, 8}, scene.film.spp = 1;
  const IntegrateResult result = render(scene);
  for (const float v : result.image.find("B")->pixels) EXPECT_NEAR(v, 0.5 * 2 / std::numbers::pi, 1e-5);
}

TEST(Integrate, GeometryOfTheCentralSample) {
  FrameScene scene = blob_in_white(Matte<SampledMode>{});
  scene.film.filter = PixelFilter::centre, scene.film.spp = 1, scene.film.resolution = {33, 33};
  const IntegrateResult result = render(scene);
  const size_t middle = result.image.index(16, 16), corner = result.image.index(0, 0);
  const double radius = std::sqrt(1 - std::sqrt(0.5)); // 2 (1 - r^2)^2 = 1
  EXPECT_NEAR(result.image.find("Z")->pixels[middle], 3 - radius, 1e-5);
  EXPECT_NEAR(result.image.find("P.Z")->pixels[middle], radius, 1e-5);
  EXPECT_NEAR(result.image.find("N.Z")->pixels[middle], 1, 1e-5);
  EXPECT_EQ(result.image.find("Z")->pixels[corner], 1e10f);
  EXPECT_EQ(result.image.find("A")->pixels[corner], 0);
  EXPECT_EQ(result.image.find("N.X")->pixels[corner], 0);
}

// From within, the surface is seen at the far side, lit by nothing but itself.
TEST(Integrate, CameraInsideAShapeSeesItsInside) {
  FrameScene scene = blob_in_white(Matte<SampledMode>{});
  scene.camera.position = Vec3(0, 0, 0), scene.camera.look_at = Vec3(0, 0, -1);
  scene.film.resolution = {16, 16};
  const IntegrateResult result = render(scene);
  for (const float v : result.image.find("A")->pixels) EXPECT_EQ(v, 1);
  for (const float v : result.image.find("R")->pixels) EXPECT_EQ(v, 0);
  EXPECT_EQ(result.nonfinite, 0u);
}

// A ball of lower priority in the way is not there.
TEST(Integrate, WhatLiesInAMediumOfHigherPriorityIsNotSeen) {
  FrameScene scene = blob_in_white(Matte<SampledMode>{});
  scene.shapes.push_back(scene.shapes[0]);
  Point<SampledMode>& within = std::get<Point<SampledMode>>(scene.shapes[1].field.nodes[0]);
  within.centre = Vec3(0, 0, -0.3f), within.radius = 0.2f;
  scene.camera.position = Vec3(0, 0, 0), scene.camera.look_at = Vec3(0, 0, -1);
  scene.film.filter = PixelFilter::centre, scene.film.spp = 1, scene.film.resolution = {9, 9};
  const auto depth = [&](int priority, int priority_within) {
    scene.shapes[0].priority = priority, scene.shapes[1].priority = priority_within;
    const IntegrateResult result = render(scene);
    return result.image.find("Z")->pixels[result.image.index(4, 4)];
  };
  const float relative = std::sqrt(1 - std::sqrt(0.5f)); // radius of the surface over that of influence
  for (const int same : {0, 5}) EXPECT_NEAR(depth(same, same), 0.3f - 0.2f * relative, 1e-5);
  EXPECT_NEAR(depth(0, 1), 0.3f - 0.2f * relative, 1e-5);
  EXPECT_NEAR(depth(1, 0), relative, 1e-5);
}

TEST(Integrate, AnyNumberOfThreadsAndAnyCropMakeTheSamePixels) {
  FrameScene scene = blob_in_white(Metal<SampledMode>{});
  std::vector<std::vector<float>> reds;
  for (const size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    reds.push_back(render(scene).image.find("R")->pixels);
  }
  EXPECT_EQ(reds[0], reds[1]);
  EXPECT_EQ(reds[0], reds[2]);

  const IntegrateResult crop = render(scene, {13, 9, 31, 22});
  for (int y = 9; y < 22; ++y)
    for (int x = 13; x < 31; ++x) ASSERT_EQ(crop.image.find("R")->pixels[crop.image.index(x, y)], reds[0][size_t(y * 48 + x)]);
}

} // namespace
} // namespace kelpie
