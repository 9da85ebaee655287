// What moves while the shutter is open: rays at random times, judged by the reference at their times; bounds, and the slabs and
// windows of time. (Pictures: blur_test.cpp.)
#include <gtest/gtest.h>

#include "renderer/program/bound.h"
#include "tests/support/moving_field.h"

namespace kelpie {
namespace {

constexpr int k_rays = 6000;

// --- rays ---

TEST(MovingTracer, Clouds) {
  for (const Falloff f : {Falloff::quartic, Falloff::wyvill})
    for (const BlobCloud& cloud : {coincident_cloud(f), thin_cloud(f), negative_cloud(f)})
      for (const CloudMotion moves : {CloudMotion::centres, CloudMotion::everything, CloudMotion::some})
        for (const double reach : {0.5, 2.0}) {
          SCOPED_TRACE(testing::Message() << "falloff " << int(f) << ", moves " << int(moves) << ", reach " << reach);
          expect_right(judge_moving_rays(moving_cloud(cloud, reach, moves), {1, 1}, k_rays / 10));
        }
}

TEST(MovingTracer, Ellipsoids) {
  for (const Falloff f : {Falloff::quartic, Falloff::wyvill})
    for (const CloudMotion moves : {CloudMotion::centres, CloudMotion::everything, CloudMotion::some})
      for (const double reach : {0.3, 1.0}) {
        SCOPED_TRACE(testing::Message() << "falloff " << int(f) << ", moves " << int(moves) << ", reach " << reach);
        const MovingField field = moving_cloud(ellipsoid_cloud(f), reach, moves);
        const auto node_at = [&](double time) { return reference_of(moving_field_at(field, time)); };
        expect_right(judge_moving_rays(field, {1, 1}, 200, {}, node_at));
      }
}

TEST(MovingTracer, EllipsoidsInTrees) {
  for (const CloudMotion moves : {CloudMotion::centres, CloudMotion::everything}) {
    MovingField field = moving_cloud(ellipsoid_cloud(Falloff::quartic), 0.5, moves);
    for (SampledField* of : {&field.start, &field.end}) {
      Segment<SampledMode> segment;
      segment.from = Vec3(-1), segment.to = Vec3(1), segment.radius = 0.3f, segment.weight = 2;
      Difference<SampledMode> cut;
      cut.children = {unsigned(of->nodes.size() - 1), add(*of, segment)};
      add(*of, cut);
    }
    const auto node_at = [&](double time) { return reference_of(moving_field_at(field, time)); };
    expect_right(judge_moving_rays(field, {1, 1}, 400, {}, node_at));
  }
}

TEST(MovingTracer, TheThresholdMayMove) {
  const BlobCloud cloud = negative_cloud(Falloff::quartic);
  expect_right(judge_moving_rays({field_of(cloud), field_of(cloud)}, {0.8f, 1.2f}, k_rays));
}

TEST(MovingTracer, TreesOfEverything) {
  Tallies all;
  for (unsigned trial = 0; trial < 250 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    const MovingField field = random_moving_tree(trial, 1 + int(trial % 3));
    all += judge_moving_rays(field, {1, trial % 2 ? 1.f : 0.9f}, 60, trial % 4 < 2 ? CellLimits{} : k_small_cells);
    expect_nothing_wrong(all);
  }
  expect_right(all);
}

// No kind stands while its numbers move, but what is prepared for a moment.
TEST(MovingTracer, EveryKindMoves) {
  FieldKinds::for_each([]<template <class> class Kind>() {
    using K = Kind<SampledMode>;
    const bool moves = (!Skeleton<K> || MovingSkeleton<K>)&&(!Warp<K> || MovingWarp<K>);
    const bool is_prepared = Warp<K> && requires(K kind) { kind.prepare(); };
    EXPECT_NE(moves, is_prepared) << K::k_name << (moves ? " need not be prepared" : " needs displacement_from()");
  });
}

TEST(MovingTracer, EveryKind) {
  const EveryKind every(Metamorphoses::left_out);
  Tallies all;
  for (unsigned i = 0; i < 60 && !HasFailure(); ++i) { // each leaf, below each warp and each operator
    const unsigned trial = 61 * i;
    SCOPED_TRACE(trial);
    const MovingField field = random_moving_field(every, trial);
    all += judge_moving_rays(field, {1, 1}, 3, {}, [&](double time) { return reference_of(moving_field_at(field, time)); });
    expect_nothing_wrong(all);
  }
  expect_right(all);
}

// Weights and objects move; the elements stand, and with them the maps.
TEST(MovingTracer, Metamorphoses) {
  Tallies all;
  for (unsigned trial = 0; trial < 8 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    MovingField field;
    Metamorphosis<SampledMode> kind = random_kind<Metamorphosis>(r);
    make_small(kind);
    SdfBox<SampledMode> box;
    SdfSphere<SampledMode> sphere;
    kind.reach = 2; // slopes are 1 over that
    box.size = Vec3(1.4f, 1.1f, 1.2f), sphere.sphere_radius = 0.7f, box.radius = sphere.radius = float(kind.reach);
    kind.objects[0].field = add(field.start, box), kind.objects[1].field = add(field.start, sphere);
    box.centre = Vec3(0.1 * r.direction()), sphere.sphere_radius = 0.8f;
    add(field.end, box), add(field.end, sphere);
    add(field.start, kind);
    for (auto& feature : kind.features) std::swap(feature.weights[0], feature.weights[1]);
    add(field.end, kind);
    all += judge_moving_rays(field, {1, 1.1f}, 20, {}, [&](double time) { return reference_of(moving_field_at(field, time)); });
    expect_nothing_wrong(all);
  }
  expect_right(all);
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

// Where a liquid is matched anew while the shutter is open its parts go on: each moment is what it is by itself, in few slabs if it rests
// there. Where several passages fall into one shutter there are more of them, and what is seen is as right.
TEST(MovingTracer, LiquidsFlowThroughInnerEnds) {
  const auto row_at = [](const Vec3& from, const Vec3& to, int count, Falloff falloff) {
    BlobCloud cloud;
    for (int i = 0; i < count; ++i) cloud.push_back({glm::mix(from, to, float(i) / float(count - 1)), 0.7f - 0.02f * float(i), 2, falloff});
    return cloud;
  };
  const BlobCloud a = row_at({-1, 0, 0}, {1, 0, 0}, 6, Falloff::quartic), b = row_at({0, -1, 0}, {0, 1.2f, 0}, 9, Falloff::cubic),
                  c = row_at({-0.5f, -0.5f, 0}, {1, 0.5f, 0.3f}, 5, Falloff::quartic);
  for (const Correspondence how : {Correspondence::flow, Correspondence::transport})
    for (const bool is_fast : {false, true}) {
      SCOPED_TRACE(is_fast);
      const std::array<const BlobCloud*, 3> few{&a, &b, &c};
      const std::array<const BlobCloud*, 7> many{&a, &b, &c, &b, &a, &b, &c};
      Liquid<SampledMode> liquid;
      liquid.morph = is_fast ? std::make_shared<const LiquidChain>(many, how, VolumeRule::linear)
                             : std::make_shared<const LiquidChain>(few, how, VolumeRule::linear);
      const auto at = [&](double time) {
        liquid.progress = float(is_fast ? 0.1 + 0.8 * time : 0.5 + 0.1 * (time - 0.5) * std::abs(time - 0.5)); // it rests there, or not
        SampledField field;
        add(field, liquid);
        FrameScene scene = scene_of(field);
        scene.frame = time;
        return scene;
      };
      FrameScene moving = at(0.5);
      moving.camera.shutter = 1, moving.moment = at;
      const Tracer tracer(moving);
      EXPECT_LE(tracer.slab_count(), is_fast ? 32u : 16u);
      double most = 0;
      int hits = 0, wrong = 0;
      for (int i = 0; i < 16; ++i) {
        const double time = (i + 0.5) / 16;
        const Tracer still(at(time));
        for (int k = 0; k < 200; ++k) {
          Random r(unsigned(1000 * i + k));
          Ray ray;
          ray.origin = Vec3(float(r.uniform(-1.2, 1.2)), float(r.uniform(-1.2, 1.2)), 5), ray.direction = Vec3(0, 0, -1),
          ray.time = float(time);
          SolveCounters counters;
          Hit hit, expected;
          const bool is_hit = tracer.intersect(ray, counters, hit);
          if (is_hit != still.intersect(ray, counters, expected))
            ++wrong; // at a silhouette
          else if (is_hit)
            ++hits, most = std::max(most, std::abs(double(hit.t) - double(expected.t)));
        }
      }
      EXPECT_GT(hits, 500);
      EXPECT_LE(wrong, hits / 100);
      EXPECT_LT(most, is_fast ? 0.2 : 0.03);
    }
}

// A ray's answer does not depend on its packet, to the last bit, whatever the times of the others.
TEST(MovingTracer, APacketIsNoMoreThanItsRays) {
  for (const CloudMotion moves : {CloudMotion::centres, CloudMotion::everything}) {
    const MovingField field = moving_cloud(coincident_cloud(Falloff::quartic), 3, moves);
    const FrameScene scene = moving_scene(field, {1, 1});
    CellLimits limits;
    limits.slabs = 4;
    const Tracer tracer(scene, limits);
    EXPECT_EQ(tracer.slab_count(), 4u);
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
    EXPECT_EQ(far_apart, 0u) << "of " << hits;
  }
}

// --- bounds ---

// Bounds of a moving program contain samples of it at all times, in boxes of any size; so does its support.
TEST(MovingBounds, ContainSamples) {
  int moving = 0, outside = 0, positive = 0;
  for (unsigned trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    const MovingField field = random_moving_tree(trial, 1 + int(trial % 3), MovingTree::with_points);
    std::vector<FieldProgram> ends = compile({field.start, field.end}, std::array{1.0, trial % 2 ? 1.0 : 1.3});
    FieldProgram program = std::move(ends[0]);
    if (!set_in_motion(program, std::move(ends[1])) || !program.motion || program.support.is_empty()) continue;
    ++moving;
    const Vec3d centre = r.in(program.support), half(r.log_uniform(1e-3, 1), r.log_uniform(1e-3, 1), r.log_uniform(1e-3, 1));
    const Box3d box{centre - half, centre + half};
    std::vector<Interval> ranges;
    bound(program, program.code, box, ranges);
    for (int i = 0; i < 60; ++i) {
      const double u = r.uniform(0, 1);
      const FieldProgram& now = at(program, program.code, u);
      const Vec3d p = r.in(box), far = r.in(program.support.padded(0.3 * program.support.diagonal()));
      const double f = evaluate(now, program.code, Point3<double>{p.x, p.y, p.z});
      EXPECT_LE(ranges.back().lo - 1e-5, f);
      EXPECT_GE(ranges.back().hi + 1e-5, f);
      positive += f > 0;
      if (!program.support.contains(far)) {
        ++outside;
        EXPECT_LE(evaluate(now, program.code, Point3<double>{far.x, far.y, far.z}), 0);
      }
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(moving, 200);
  EXPECT_GT(positive, 4 * moving);
  EXPECT_GT(outside, 20 * moving);
}

// --- slabs ---

size_t slabs_of(const FrameScene& scene) { return Tracer(scene).slab_count(); }

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
  const MovingField field = moving_cloud(start, reach, CloudMotion::centres);
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
        const auto inside = [&](const Vec3d& p) { return evaluate(now, shape.program.code, Point3<double>{p.x, p.y, p.z}) > 1; };
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
  EXPECT_EQ(windows(moving_cloud(cloud, 0.4, CloudMotion::centres)), 2u);
  EXPECT_EQ(windows(moving_cloud(cloud, 0.05, CloudMotion::centres)), 1u);
  EXPECT_EQ(windows(moving_cloud(cloud, 0, CloudMotion::centres)), 1u);
  const FrameScene changing = moving_scene(moving_cloud(cloud, 0.4, CloudMotion::everything), {1, 1});
  EXPECT_EQ(Tracer(changing).window_count(), Tracer(changing).slab_count());
}

} // namespace
} // namespace kelpie
