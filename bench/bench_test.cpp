// What the benchmarks stand on: the creature is what it is said to be, and the triangles are the field's surface.
#include <map>

#include <gtest/gtest.h>

#include "bench/bench_scene.h"
#include "bench/creature_tree.h"
#include "renderer/integrate/camera_rays.h"
#include "renderer/trace/tracer.h"
#ifdef KELPIE_TRIANGLES
#include "bench/triangle_scene.h"
#endif

namespace kelpie {
namespace {

FieldProgram program_of(const char* scene) {
  const SampledShape shape = bench_scene(scene).shapes.at(0);
  return compile(shape.field, shape.threshold);
}

TEST(Creature, HasAbout2000ElementsWhateverTheWarps) {
  for (const CreatureWarps warps : {CreatureWarps::none, CreatureWarps::twist, CreatureWarps::bend}) {
    const FieldProgram program = program_of(std::string(creature_name(warps)).c_str());
    EXPECT_NEAR(double(program.element_count()), 2000, 100);
    EXPECT_EQ(program.spaces.size() > 1, warps != CreatureWarps::none);
  }
}

TEST(Creature, IsTheSameEachTime) {
  EXPECT_EQ(make_creature_scene(CreatureWarps::twist), make_creature_scene(CreatureWarps::twist));
  EXPECT_NE(make_creature_scene(CreatureWarps::twist), make_creature_scene(CreatureWarps::none));
}

#ifdef KELPIE_TRIANGLES

TEST(FieldMesh, IsClosedAndLiesOnTheSurface) {
  const FieldProgram program = program_of("100");
  const double voxel = 0.02;
  const FieldMesh mesh = mesh_field(program, voxel);
  ASSERT_GT(mesh.triangles.size(), 30000u);
  std::map<std::pair<uint32_t, uint32_t>, int> edges; // each as often in one direction as in the other
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const uint32_t a = mesh.triangles[i], b = mesh.triangles[i % 3 == 2 ? i - 2 : i + 1];
    edges[std::minmax(a, b)] += a < b ? 1 : -1;
  }
  for (const auto& [edge, sum] : edges) ASSERT_EQ(sum, 0);
  for (const Vec3& p : mesh.points) {
    const double field = evaluate(program, program.code, Point3<double>{p.x, p.y, p.z}),
                 slope = glm::length(gradient(program, program.code, p));
    EXPECT_LT(std::abs(field - program.threshold), 0.25 * voxel * slope + 0.02) << p.x << ' ' << p.y << ' ' << p.z;
  }
}

/// The mesh of `scene` is hit by the rays that hit the field, and there.
void expect_same_hits(const char* scene_name) {
  const FrameScene scene = bench_scene(scene_name);
  const Tracer tracer(scene);
  const float voxel = 0.01f;
  const TriangleScene triangles(mesh_field(program_of(scene_name), voxel));
  const CameraRays camera(scene.camera, Vec2i(128, 72));
  int hits = 0, differ = 0;
  for (int y = 0; y < 72; y += 4)
    for (int x = 0; x < 128; x += 4) {
      std::vector<Ray> rays;
      for (int i = 0; i < 16; ++i) rays.push_back(camera.through(Vec2(x + i % 4, y + i / 4) + 0.5f, Vec2(0)));
      SolveCounters counters;
      std::array<Hit, k_packet> met;
      std::array<TriangleHit, k_packet> met_triangles;
      const uint32_t a = tracer.intersect(rays, counters, met.data()), b = triangles.intersect(rays, true, met_triangles.data());
      for (size_t i = 0; i < rays.size(); ++i) {
        TriangleHit alone;
        const bool is_hit = triangles.intersect(rays[i], alone);
        EXPECT_EQ(is_hit, bool(b >> i & 1));
        EXPECT_EQ(triangles.occluded(rays[i]), is_hit);
        hits += a >> i & 1;
        differ += (a >> i & 1) != (b >> i & 1) || ((a & b) >> i & 1 && std::abs(met[i].t - met_triangles[i].t) > 5 * voxel);
      }
      EXPECT_EQ(triangles.occluded(rays, true), b);
    }
  EXPECT_GT(hits, 500);
  EXPECT_LT(differ, hits / 50); // silhouettes
}

TEST(Triangles, HitWhereTheCloudIs) { expect_same_hits("1000"); }
TEST(Triangles, HitWhereTheTwistedCreatureIs) { expect_same_hits("creature_twisted"); }

#endif

} // namespace
} // namespace kelpie
