// What moves while the shutter is open: rays at random times, judged by the reference at their times; and blurred
// pictures, which are the means of still ones.
#include <atomic>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "renderer/integrate/camera_rays.h"
#include "renderer/integrate/integrate.h"
#include "renderer/program/bound.h"
#include "tests/support/moving_field.h"

namespace kelpie {
namespace {

constexpr int k_rays = 6000;

// --- rays ---

void expect_exact(const Tally& tally, int rays) {
  EXPECT_EQ(tally.missed, 0);
  EXPECT_EQ(tally.false_hits, 0);
  EXPECT_EQ(tally.disagreeing_shadows, 0);
  EXPECT_EQ(tally.wrong_normals, 0);
  EXPECT_GT(tally.hits, rays / 10);
}

/// What may move of a cloud's blobs.
enum class Moves { centres, everything, some };

MovingField moving_cloud(BlobCloud start, double reach, Moves moves) {
  Random r(5);
  BlobCloud end = start;
  for (size_t i = 0; i < end.size(); ++i) {
    if (moves == Moves::some && i % 3) continue;
    Blob& b = end[i];
    b.centre += Vec3(r.direction() * r.uniform(0, reach * b.radius));
    if (moves == Moves::everything) b.radius *= float(r.uniform(0.8, 1.2)), b.weight *= float(r.uniform(0.8, 1.2));
  }
  return {field_of(start), field_of(end)};
}

TEST(MovingTracer, Clouds) {
  for (const Falloff f : {Falloff::quartic, Falloff::wyvill})
    for (const BlobCloud& cloud : {coincident_cloud(f), thin_cloud(f), negative_cloud(f)})
      for (const Moves moves : {Moves::centres, Moves::everything, Moves::some})
        for (const double reach : {0.5, 2.0}) {
          SCOPED_TRACE(testing::Message() << "falloff " << int(f) << ", moves " << int(moves) << ", reach " << reach);
          expect_exact(judge_moving_rays(moving_cloud(cloud, reach, moves), {1, 1}, k_rays / 4), k_rays / 4);
        }
}

TEST(MovingTracer, TheThresholdMayMove) {
  const BlobCloud cloud = negative_cloud(Falloff::quartic);
  expect_exact(judge_moving_rays({field_of(cloud), field_of(cloud)}, {0.8f, 1.2f}, k_rays), k_rays);
}

TEST(MovingTracer, TreesOfEverything) {
  int hits = 0, rays = 0;
  for (unsigned trial = 0; trial < 250; ++trial) {
    SCOPED_TRACE(trial);
    const MovingField field = random_moving_tree(trial, 1 + int(trial % 3));
    const Tally tally = judge_moving_rays(field, {1, trial % 2 ? 1.f : 0.9f}, 120, trial % 4 < 2 ? CellLimits{} : k_small_cells);
    EXPECT_EQ(tally.missed, 0);
    EXPECT_EQ(tally.false_hits, 0);
    EXPECT_EQ(tally.disagreeing_shadows, 0);
    hits += tally.hits, rays += 120;
    if (HasFailure()) return;
  }
  EXPECT_GT(hits, rays / 10);
}

// No kind stands while its numbers move.
TEST(MovingTracer, EveryKindMoves) {
  FieldKinds::for_each([]<template <class> class Kind>() {
    using K = Kind<SampledMode>;
    const bool moves = (!Skeleton<K> || MovingSkeleton<K>)&&(!Warp<K> || MovingWarp<K>);
    EXPECT_TRUE(moves || K::k_name == "axial") << K::k_name << " needs displacement_from()";
  });
}

TEST(MovingTracer, EveryKind) {
  const EveryKind every;
  int hits = 0, rays = 0;
  for (unsigned i = 0; i < 60; ++i) { // each leaf, below each warp and each operator
    const unsigned trial = 61 * i;
    SCOPED_TRACE(trial);
    const MovingField field = random_moving_field(every, trial);
    const Tally tally = judge_moving_rays(field, {1, 1}, 16, {}, [&](double time) { return reference_of(moving_field_at(field, time)); });
    EXPECT_EQ(tally.missed, 0);
    EXPECT_EQ(tally.false_hits, 0);
    EXPECT_EQ(tally.disagreeing_shadows, 0);
    hits += tally.hits, rays += 32;
    if (HasFailure()) return;
  }
  EXPECT_GT(hits, rays / 10);
}

// An axial deformation is stepped: in each slab of time it stands as it is in the middle.
TEST(MovingTracer, AxesStandInTheMiddleOfASlab) {
  const auto at = [](double t) {
    SampledField field;
    Segment<SampledMode> segment;
    segment.from = Vec3(0, -0.6f, 0), segment.to = Vec3(0, 0.6f, 0), segment.radius = 0.3f, segment.weight = 2;
    Axial<SampledMode> axial;
    AxialAxis<SampledMode>& axis = axial.axes.emplace_back();
    axis.rest = {Vec3(0, -1, 0), Vec3(0, 0, 0), Vec3(0, 1, 0)}, axis.radius = 0.8f;
    for (const Vec3& p : axis.rest) axis.deformed.push_back(p + Vec3(float(0.4 * t), 0, 0));
    axial.prepare();
    axial.child = add(field, segment), add(field, axial);
    FrameScene scene = scene_of(field);
    scene.frame = t;
    return scene;
  };
  FrameScene moving = at(0.5);
  moving.camera.shutter = 1, moving.moment = at;
  CellLimits limits;
  for (const uint32_t slabs : {1u, 2u, 4u}) {
    limits.slabs = slabs;
    const Tracer tracer(moving, limits);
    EXPECT_EQ(tracer.slab_count(), slabs);
    for (int i = 0; i < 16; ++i) {
      Ray ray;
      ray.origin = Vec3(5, 0.1f, 0.02f), ray.direction = Vec3(-1, 0, 0), ray.time = float(i + 0.5) / 16;
      SolveCounters counters;
      Hit hit, still;
      ASSERT_TRUE(tracer.intersect(ray, counters, hit));
      ASSERT_TRUE(Tracer(at((std::floor(double(ray.time) * slabs) + 0.5) / slabs)).intersect(ray, counters, still));
      EXPECT_NEAR(hit.t, still.t, 1e-5);
    }
  }
}

// A ray's answer does not depend on its packet, to the last bit, whatever the times of the others.
TEST(MovingTracer, APacketIsNoMoreThanItsRays) {
  for (const Moves moves : {Moves::centres, Moves::everything}) {
    const MovingField field = moving_cloud(coincident_cloud(Falloff::quartic), 3, moves);
    const FrameScene scene = moving_scene(field, {1, 1});
    CellLimits limits;
    limits.slabs = 4;
    const Tracer tracer(scene, limits);
    EXPECT_EQ(tracer.slab_count(), moves == Moves::centres ? 4u : tracer.slab_count());
    std::vector<Ray> rays;
    for (int i = 0; i < 4000; ++i) {
      Random r(i);
      rays.push_back(random_ray(r, tracer.bounds(), {}, true));
      rays.back().time = float(r.uniform(0, 1));
    }
    SolveCounters counters;
    size_t hits = 0, far_apart = 0;
    for (size_t first = 0; first < rays.size(); first += k_packet) {
      const std::span<const Ray> packet = std::span<const Ray>(rays).subspan(first, k_packet);
      std::array<Hit, k_packet> together;
      const uint32_t found = tracer.intersect(packet, counters, together.data()), dark = tracer.occluded(packet, counters);
      EXPECT_EQ(found, dark);
      for (size_t i = 0; i < k_packet; ++i) {
        Hit lone, alone;
        const bool in_packet = found >> i & 1, met = tracer.intersect(packet.subspan(i, 1), counters, &lone) & 1;
        ASSERT_EQ(met, in_packet);
        ASSERT_TRUE(!met || (lone.t == together[i].t && lone.position == together[i].position && lone.normal == together[i].normal));
        const bool met_alone = tracer.intersect(packet[i], counters, alone);
        hits += met;
        far_apart += met != met_alone || (met && std::abs(alone.t - lone.t) > 1e-5f * tracer.bounds().diagonal());
      }
    }
    EXPECT_GT(hits, rays.size() / 10);
    EXPECT_LE(far_apart, hits / 1000);
  }
}

// --- bounds ---

// Bounds of a moving program contain samples of it at all times, in boxes of any size; so does its support.
TEST(MovingBounds, ContainSamples) {
  for (unsigned trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    const MovingField field = random_moving_tree(trial, 1 + int(trial % 3), MovingTree::with_points);
    std::vector<FieldProgram> ends = compile({field.start, field.end}, std::array{1.0, trial % 2 ? 1.0 : 1.3});
    FieldProgram program = std::move(ends[0]);
    if (!set_in_motion(program, std::move(ends[1])) || !program.motion || program.support.is_empty()) continue;
    const Vec3d centre = r.in(program.support), half(r.log_uniform(1e-3, 1), r.log_uniform(1e-3, 1), r.log_uniform(1e-3, 1));
    const Box3d box{centre - half, centre + half};
    std::vector<Interval> ranges;
    bound(program, program.code, box, ranges);
    for (int i = 0; i < 60; ++i) {
      const double u = r.uniform(0, 1);
      const FieldProgram& now = at(program, program.code, u);
      const Vec3d p = r.in(box), far = r.in(program.support.padded(0.3 * program.support.diagonal()));
      const double f = evaluate(now, now.code, Point3<double>{p.x, p.y, p.z});
      EXPECT_LE(ranges.back().lo - 1e-5, f);
      EXPECT_GE(ranges.back().hi + 1e-5, f);
      if (!program.support.contains(far)) {
        EXPECT_LE(evaluate(now, now.code, Point3<double>{far.x, far.y, far.z}), 0);
      }
    }
    if (HasFailure()) return;
  }
}

// --- slabs ---

size_t slabs_of(const FrameScene& scene) { return Tracer(scene).slab_count(); }

FrameScene point_scene(const Animated<Vec3>& centre, float shutter, double frame = 10) {
  const auto moment = [centre](double at) {
    Point<SampledMode> point;
    point.centre = centre.at(at), point.radius = 1, point.weight = 2;
    SampledField field;
    add(field, point);
    FrameScene scene = scene_of(field);
    scene.frame = at;
    return scene;
  };
  FrameScene scene = moment(frame);
  scene.moment = moment, scene.camera.shutter = shutter;
  for (const auto& key : centre.keys()) scene.breaks.push_back(key.frame);
  return scene;
}

TEST(Slabs, AsManyAsTheMotionNeeds) {
  using Keys = std::vector<Key<Vec3>>;
  const auto linear = [](Keys keys) { return Animated<Vec3>(std::move(keys), Interpolation::linear); };
  EXPECT_EQ(slabs_of(point_scene(Vec3(1, 2, 3), 1)), 1u);
  EXPECT_EQ(slabs_of(point_scene(linear({{0, Vec3(0), {}}, {20, Vec3(4), {}}}), 1)), 1u);
  EXPECT_GE(slabs_of(point_scene(linear({{0, Vec3(0), {}}, {20, Vec3(400, 0, 0), {}}}), 1)), 8u);
  // A corner in the middle of the shutter is the border of two slabs; elsewhere it takes more.
  EXPECT_EQ(slabs_of(point_scene(linear({{9, Vec3(0), {}}, {10, Vec3(0.5), {}}, {11, Vec3(0), {}}}), 1)), 2u);
  EXPECT_GE(slabs_of(point_scene(linear({{9, Vec3(0), {}}, {10.2, Vec3(0.5), {}}, {11, Vec3(0), {}}}), 1)), 4u);
  // A pulse that is over in less than any sample of the motion would see.
  EXPECT_GE(slabs_of(point_scene(linear({{9, Vec3(0), {}}, {10.3, Vec3(0), {}}, {10.31, Vec3(1), {}}, {10.32, Vec3(0), {}}}), 1)), 8u);
  // A step in the middle needs no more than the border.
  EXPECT_EQ(slabs_of(point_scene(Animated<Vec3>(Keys{{0, Vec3(0), {}}, {10, Vec3(1, 0, 0), {}}}, Interpolation::step), 1)), 2u);
}

// --- windows ---

/// A cloud of one falloff, of which the centres move.
FieldProgram travelling_cloud(const BlobCloud& start, double reach) {
  const MovingField field = moving_cloud(start, reach, Moves::centres);
  std::vector<FieldProgram> ends = compile({field.start, field.end}, std::array{1.0, 1.0});
  EXPECT_TRUE(set_in_motion(ends[0], std::move(ends[1])));
  return std::move(ends[0]);
}

// At any time all of the surface is in the boxes of that time's window: points close together, one on either side.
TEST(Windows, HoldTheSurfaceOfTheirTime) {
  for (const BlobCloud& cloud : {coincident_cloud(Falloff::quartic), thin_cloud(Falloff::quartic)})
    for (const uint32_t windows : {1u, 2u, 4u}) {
      SCOPED_TRACE(windows);
      const ShapeCells shape = build_cells(travelling_cloud(cloud, 0.8), {}, windows);
      ASSERT_EQ(shape.windows(), windows);
      Random r(3);
      int found = 0;
      for (int i = 0; i < 60000 && found < 300; ++i) {
        const double u = i % 7 == 0 ? double(i % (windows + 1)) / windows : r.uniform(0, 1);
        const FieldProgram& now = at(shape.program, shape.program.code, u);
        const auto inside = [&](const Vec3d& p) { return evaluate(now, now.code, Point3<double>{p.x, p.y, p.z}) > 1; };
        Vec3d a = r.in(shape.program.support), b = a + r.direction() * r.uniform(0, 0.2);
        if (inside(a) == inside(b)) continue;
        ++found;
        for (int k = 0; k < 50; ++k) (inside(0.5 * (a + b)) == inside(a) ? a : b) = 0.5 * (a + b);
        const auto cells = shape.cells_in(std::min(static_cast<size_t>(u * windows), size_t{windows} - 1));
        EXPECT_TRUE(std::any_of(cells.begin(), cells.end(), [&](const Cell& c) { return c.box.padded(1e-5f).contains(Vec3(a)); }))
            << "no cell at " << a.x << ' ' << a.y << ' ' << a.z << " at time " << u;
      }
      EXPECT_GE(found, 100);
    }
}

// They cut back what the whole slab would need.
TEST(Windows, AreNarrowerThanTheSlab) {
  const auto volume = [](uint32_t windows) {
    const ShapeCells shape = build_cells(travelling_cloud(thin_cloud(Falloff::quartic), 0.8), {}, windows);
    double sum = 0;
    for (const Cell& cell : shape.cells) sum += double(cell.box.extent().x) * cell.box.extent().y * cell.box.extent().z;
    return sum / windows;
  };
  EXPECT_LT(volume(2), 0.97 * volume(1));
  EXPECT_LT(volume(4), volume(2));
}

// A cloud in fast motion has two windows in each slab, whatever else has none.
TEST(Windows, OnlyOfTravellingClouds) {
  const auto windows = [](const MovingField& field) { return Tracer(moving_scene(field, {1, 1})).window_count(); };
  const BlobCloud cloud = thin_cloud(Falloff::quartic);
  EXPECT_EQ(windows(moving_cloud(cloud, 0.4, Moves::centres)), 2u);
  EXPECT_EQ(windows(moving_cloud(cloud, 0.05, Moves::centres)), 1u);
  EXPECT_EQ(windows(moving_cloud(cloud, 0, Moves::centres)), 1u);
  const FrameScene changing = moving_scene(moving_cloud(cloud, 0.4, Moves::everything), {1, 1});
  EXPECT_EQ(Tracer(changing).window_count(), Tracer(changing).slab_count());
}

// --- pictures ---

IntegrateResult render(const FrameScene& scene) {
  Diagnostics diagnostics;
  EnvironmentCache cache;
  const std::vector<Light> lights = make_lights(scene, cache, diagnostics);
  const std::atomic<bool> stop{false};
  const Tracer tracer(scene);
  return integrate(
      scene, tracer, lights, {0, 0, scene.film.resolution.x, scene.film.resolution.y}, [](double) {}, stop);
}

/// A scene for a field that moves as `at` says, lit by a sun, from the open shutter's time.
using SceneAt = std::function<FrameScene(double time)>;

FrameScene lit(FrameScene scene) {
  SunLight<SampledMode> sun;
  sun.direction = Vec3(1, 2, 3), sun.angle = 0;
  scene.lights.emplace_back(sun);
  for (SampledShape& shape : scene.shapes) shape.surface = Matte<SampledMode>{};
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
