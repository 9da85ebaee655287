// Blurred pictures, which are the means of still ones; and the channel that says how things move.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "renderer/integrate/camera_rays.h"
#include "tests/support/moving_field.h"
#include "tests/support/render.h"

namespace kelpie {
namespace {

// --- pictures ---

/// A scene for a field that moves as `at` says, lit by a sun, from the open shutter's time.
using SceneAt = std::function<FrameScene(double time)>;

FrameScene lit(FrameScene scene) {
  SunLight<SampledMode> sun;
  sun.direction = Vec3(1, 2, 3), sun.angle = 0;
  scene.lights.emplace_back(sun);
  for (size_t i = 0; i < scene.shapes.size(); ++i) set_surface(scene, i, Matte<SampledMode>{});
  scene.film.resolution = {40, 30}, scene.film.bounces = 0, scene.film.filter = PixelFilter::box;
  scene.film.background.kind = Background::Kind::transparent;
  scene.camera.position += Vec3(0, -1, -1.5f);
  return scene;
}

/// The blurred picture against the mean of still ones at the middles of equal steps of time.
void expect_blur_is_mean(const SceneAt& at, double tolerance = 2e-3) {
  constexpr int k_stills = 256, k_spp = 256;
  FrameScene blurred = lit(at(0.5));
  blurred.camera.shutter = 1, blurred.frame = 0.5;
  blurred.moment = [&](double frame) { return lit(at(frame)); };
  blurred.film.spp = k_spp;
  const IntegrateResult blur = render(blurred);
  std::vector<double> mean(blur.image.data_window.area()), coverage(mean.size());
  for (int i = 0; i < k_stills; ++i) {
    FrameScene still = lit(at((i + 0.5) / k_stills));
    still.film.spp = 4, still.frame = i; // a pattern of samples of its own
    const IntegrateResult result = render(still);
    for (size_t p = 0; p < mean.size(); ++p)
      mean[p] += result.image.find("G")->pixels[p] / k_stills, coverage[p] += result.image.find("A")->pixels[p] / k_stills;
  }
  // A pixel is a mean over the unit cube of film and time, stratified: it errs by a few parts in a hundred at an edge.
  double sum = 0, expected = 0, worst = 0, squares = 0;
  for (size_t p = 0; p < mean.size(); ++p) {
    const double a = blur.image.find("A")->pixels[p], g = blur.image.find("G")->pixels[p];
    sum += g, expected += mean[p];
    worst = std::max({worst, std::abs(a - coverage[p]), std::abs(g - mean[p])});
    squares += square(g - mean[p]);
  }
  EXPECT_GT(expected, 3);
  EXPECT_NEAR(sum, expected, tolerance * expected);
  EXPECT_LT(worst, 0.1);
  EXPECT_LT(std::sqrt(squares / double(mean.size())), 0.006);
}

TEST(Blur, DropsThatMerge) {
  const SceneAt at = [](double t) {
    BlobCloud cloud;
    for (const float side : {-1.f, 1.f}) cloud.push_back({Vec3(side * float(1.2 - 0.9 * t), 0.3f * side, 0), 1.2f, 2, Falloff::quartic});
    return scene_of(field_of(cloud));
  };
  expect_blur_is_mean(at);
  // Apart at the beginning, one at the end: seen through the gap, or not.
  FrameScene scene = at(0.5);
  scene.frame = 0.5, scene.camera.shutter = 1, scene.moment = at;
  const Tracer tracer(scene);
  Ray ray;
  ray.origin = Vec3(0, 0, 5), ray.direction = Vec3(0, 0, -1);
  SolveCounters counters;
  EXPECT_FALSE(tracer.occluded(ray, counters));
  ray.time = 0.99f;
  EXPECT_TRUE(tracer.occluded(ray, counters));
}

TEST(Blur, ASegmentUnderARotatingWarp) {
  expect_blur_is_mean([](double t) {
    SampledField field;
    Segment<SampledMode> segment;
    segment.from = Vec3(-1, 0, 0), segment.to = Vec3(1, float(0.5 * t), 0), segment.radius = 0.8f, segment.weight = 2;
    Rotate<SampledMode> rotate;
    rotate.axis = Vec3(0, 0.3f, 1), rotate.angle = float(90 * t), rotate.child = add(field, segment);
    add(field, rotate);
    return scene_of(field);
  });
}

TEST(Blur, ATwistThatWinds) {
  expect_blur_is_mean([](double t) {
    SampledField field;
    Segment<SampledMode> segment;
    segment.from = Vec3(0.6f, -1, 0), segment.to = Vec3(0.6f, 1, 0), segment.radius = 0.7f, segment.weight = 2;
    Twist<SampledMode> twist;
    twist.rate = float(120 * t), twist.child = add(field, segment);
    add(field, twist);
    return scene_of(field);
  });
}

TEST(Blur, TheThresholdThatFalls) {
  expect_blur_is_mean([](double t) {
    return scene_of(field_of({Blob{Vec3(0), 1.5f, 2, Falloff::wyvill}, Blob{Vec3(1, 0, 0), 1, 1, Falloff::quartic}}), float(1.5 - t));
  });
}

TEST(Blur, ACameraThatPasses) {
  expect_blur_is_mean([](double t) {
    FrameScene scene = scene_of(field_of({Blob{Vec3(0), 1.5f, 2, Falloff::quartic}}));
    scene.camera.position = Vec3(float(t - 0.5), float(1 + t), 5), scene.camera.fov = float(35 + 10 * t);
    scene.camera.up = Vec3(float(0.3 * t), 1, 0);
    return scene;
  });
}

TEST(Blur, APlaneThatRises) {
  expect_blur_is_mean([](double t) {
    FrameScene scene = scene_of(field_of({Blob{Vec3(0), 1.5f, 2, Falloff::quartic}}));
    SampledShape shape;
    Plane<SampledMode> plane;
    plane.position = Vec3(0, float(-1 + 0.8 * t), 0), plane.normal = Vec3(0, 1, float(0.2 * t));
    shape.name = "floor", shape.geometry = plane;
    scene.shapes.push_back(shape);
    return scene;
  });
}

/// A tetrahedron.
std::shared_ptr<const SurfaceMesh> small_mesh() {
  Diagnostics diagnostics;
  const std::vector<Vec3d> corners{{-0.6, -0.4, -0.5}, {0.7, -0.5, -0.3}, {0, -0.4, 0.8}, {0.1, 0.9, 0}};
  return std::make_shared<SurfaceMesh>(make_surface_mesh(corners, {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}, {}, "test", diagnostics));
}

SampledShape mesh_shape(const std::shared_ptr<const SurfaceMesh>& surface, const Vec3& position, float angle, const Vec3& scale) {
  TriangleMesh<SampledMode> mesh;
  mesh.mesh = surface, mesh.position = position, mesh.angle = angle, mesh.axis = Vec3(0.2f, 1, 0.1f), mesh.scale = scale;
  SampledShape shape;
  shape.name = "mesh", shape.geometry = mesh;
  return shape;
}

TEST(Blur, AMeshThatTumbles) {
  const auto surface = small_mesh();
  expect_blur_is_mean([&](double t) {
    FrameScene scene = scene_of(field_of({Blob{Vec3(0.8f, 0.3f, 0), 0.7f, 2, Falloff::quartic}}));
    scene.shapes.push_back(
        mesh_shape(surface, Vec3(float(0.8 * t - 0.6), float(0.3 * t), 0), float(150 * t), Vec3(1, float(1 - 0.4 * t), 1)));
    return scene;
  });
}

// From inside a shape that comes and goes the camera sees its inside while it is there. (It comes at once: the stills' steps show.)
TEST(Blur, TheShapeAroundTheCamera) {
  expect_blur_is_mean(
      [](double t) {
        FrameScene scene = scene_of(field_of({Blob{Vec3(float(4 * t - 2), 0, 4), 2, 3, Falloff::quartic}}));
        return scene;
      },
      0.05);
}

TEST(Blur, IsTheSameOnAnyNumberOfThreads) {
  FrameScene scene = lit(point_scene(Animated<Vec3>({{9, Vec3(-2, 0, 0), {}}, {11, Vec3(2, 1, 0), {}}}, Interpolation::linear), 1));
  scene.film.spp = 6; // no multiple of the slabs
  std::vector<std::vector<float>> pictures;
  for (const size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    pictures.push_back(render(scene).image.find("R")->pixels);
  }
  EXPECT_EQ(pictures[0], pictures[1]);
  EXPECT_EQ(pictures[0], pictures[2]);
}

// What stands still is the same picture, whether the shutter is open or not, but for the pattern of samples.
TEST(Blur, OfWhatStandsIsNone) {
  const FrameScene still = lit(point_scene(Vec3(0.2f, 0, 0), 0));
  FrameScene scene = still;
  scene.camera.shutter = 1, scene.moment = [&](double) { return still; };
  EXPECT_EQ(render(scene).image.find("R")->pixels, render(still).image.find("R")->pixels);
}

// --- the channel `motion` ---

/// Renders a field that moves as `at` says, from frame 3 on, and compares the motion of each pixel that meets the surface.
void expect_motion(const SceneAt& at, float shutter, double tolerance,
                   const std::function<Vec3d(const Vec3d& p, const Vec3d& normal, double frame)>& velocity) {
  FrameScene scene = lit(at(3));
  scene.frame = 3, scene.camera.shutter = shutter, scene.moment = [&](double frame) { return lit(at(frame)); };
  scene.film.aovs = {Aov::P, Aov::N, Aov::motion}, scene.film.spp = 4, scene.film.filter = PixelFilter::centre;
  const IntegrateResult result = render(scene);
  const auto channel = [&](const char* name, size_t i) { return result.image.find(name)->pixels[i]; };
  const auto vec = [&](const std::string& name, size_t i) {
    return Vec3d(channel((name + ".X").c_str(), i), channel((name + ".Y").c_str(), i), channel((name + ".Z").c_str(), i));
  };
  const CameraRays now(scene.camera, scene.film.resolution), next(lit(at(4)).camera, scene.film.resolution);
  size_t met = 0;
  for (size_t i = 0; i < result.image.data_window.area(); ++i) {
    const Vec2 motion(channel("motion.X", i), channel("motion.Y", i));
    ASSERT_TRUE(std::isfinite(motion.x) && std::isfinite(motion.y));
    const Vec3d p = vec("P", i), n = vec("N", i);
    if (n == Vec3d(0)) continue;
    const Vec2 expected = next.film_of(Vec3(p + velocity(p, n, 3))) - now.film_of(Vec3(p));
    EXPECT_LT(glm::distance(motion, expected), tolerance * (1 + glm::length(expected)));
    ++met;
  }
  EXPECT_GT(met, 50u);
}

// A field does not know what slides within its surface: the velocity is the part along the normal.
TEST(Motion, OfABlobThatTravels) {
  const Vec3d way(0.3, -0.2, 0.1);
  for (const float shutter : {0.f, 1.f})
    expect_motion(
        [&](double t) {
          return scene_of(field_of({Blob{Vec3(way * (t - 3)), 1.5f, 2, Falloff::quartic}}));
        },
        shutter, 2e-3, [&](const Vec3d&, const Vec3d& n, double) { return n * glm::dot(n, way); });
}

TEST(Motion, OfABlobThatGrowsAndOfThresholds) {
  // f = w (1 - r^2/R^2)^2 = T: the radius r of the surface changes with w, and as well with T.
  const auto radius = [](double weight, double threshold) { return 1.5 * std::sqrt(1 - std::sqrt(threshold / weight)); };
  const double h = 1e-4;
  expect_motion(
      [&](double t) {
        return scene_of(field_of({Blob{Vec3(0), 1.5f, float(2 + 0.3 * (t - 3)), Falloff::quartic}}));
      },
      0, 5e-3, [&](const Vec3d&, const Vec3d& n, double) { return n * ((radius(2 + 0.3 * h, 1) - radius(2, 1)) / h); });
  expect_motion(
      [&](double t) {
        return scene_of(field_of({Blob{Vec3(0), 1.5f, 2, Falloff::quartic}}), float(1 + 0.2 * (t - 3)));
      },
      0, 5e-3, [&](const Vec3d&, const Vec3d& n, double) { return n * ((radius(2, 1 + 0.2 * h) - radius(2, 1)) / h); });
}

TEST(Motion, OfASegmentUnderAWarp) {
  const Vec3d axis = glm::normalize(Vec3d(0, 0.3, 1));
  const double rate = glm::radians(20.0);
  expect_motion(
      [&](double t) {
        SampledField field;
        Segment<SampledMode> segment;
        segment.from = Vec3(-1, 0, 0), segment.to = Vec3(1, 0, 0), segment.radius = 0.8f, segment.weight = 2;
        Rotate<SampledMode> rotate;
        rotate.axis = Vec3(axis), rotate.angle = float(20 * (t - 3)), rotate.child = add(field, segment);
        add(field, rotate);
        return scene_of(field);
      },
      0, 5e-3, [&](const Vec3d& p, const Vec3d& n, double) { return n * glm::dot(n, glm::cross(axis, p) * rate); });
}

TEST(Motion, OfAMesh) {
  const auto surface = small_mesh();
  const Vec3d axis = glm::normalize(Vec3d(Vec3(0.2f, 1, 0.1f))), way(0.2, 0.1, 0);
  const double rate = glm::radians(2.0);
  expect_motion(
      [&](double t) {
        FrameScene scene;
        scene.shapes.push_back(mesh_shape(surface, Vec3(way * (t - 3)), float(2 * (t - 3)), Vec3(1.5f)));
        return scene;
      },
      0, 2e-2, [&](const Vec3d& p, const Vec3d&, double) { return way + glm::cross(axis, p) * rate; });
}

TEST(Motion, OfTheCamera) {
  expect_motion(
      [&](double t) {
        FrameScene scene = scene_of(field_of({Blob{Vec3(0), 1.5f, 2, Falloff::quartic}}));
        scene.camera.position = Vec3(float(0.2 * (t - 3)), 1, 6), scene.camera.look_at = Vec3(float(0.1 * (t - 3)), 0, 0);
        return scene;
      },
      0, 1e-3, [](const Vec3d&, const Vec3d&, double) { return Vec3d(0); });
}

// What is infinitely far moves as the camera turns, here by about the field of view over the picture's height a degree.
TEST(Motion, OfTheBackground) {
  const auto at = [](double t) {
    FrameScene scene = lit(scene_of(field_of({Blob{Vec3(0, 0, 50), 1.5f, 2, Falloff::quartic}})));
    scene.camera.position = Vec3(0, 0, 0), scene.camera.look_at = Vec3(float(std::sin(0.01 * t)), 0, float(-std::cos(0.01 * t)));
    scene.film.aovs = {Aov::motion};
    return scene;
  };
  FrameScene scene = at(0);
  scene.moment = at;
  const IntegrateResult result = render(scene);
  const size_t middle = result.image.index(20, 15);
  const double focal = 15 / std::tan(glm::radians(17.5)); // in pixels
  EXPECT_NEAR(result.image.find("motion.X")->pixels[middle], -0.01 * focal, 0.01);
  EXPECT_NEAR(result.image.find("motion.Y")->pixels[middle], 0, 0.01);
}

} // namespace
} // namespace kelpie
