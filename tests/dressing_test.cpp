// Triangle meshes among the shapes: every hit by brute force in double, no gaps, smooth normals without their artefacts.
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include "renderer/trace/tracer.h"
#include "tests/support/random_scene.h"

namespace kelpie {
namespace {

struct Faces {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;
};

TriangleMesh<SampledMode> mesh_of(const Faces& faces, double crease = 30) {
  Diagnostics diagnostics;
  TriangleMesh<SampledMode> kind;
  kind.mesh = std::make_shared<SurfaceMesh>(make_surface_mesh(faces.positions, faces.triangles, {crease}, "test", diagnostics));
  return kind;
}

FrameScene scene_of(const TriangleMesh<SampledMode>& mesh) {
  FrameScene scene;
  SampledShape shape;
  shape.name = "mesh", shape.geometry = mesh;
  scene.shapes.push_back(std::move(shape));
  return scene;
}

/// Triangles anywhere, of any size.
Faces random_soup(int count) {
  Random r(1);
  Faces faces;
  for (int i = 0; i < count; ++i) {
    const Vec3d centre = r.in(Box3d{Vec3d(-1), Vec3d(1)});
    const double size = r.log_uniform(1e-3, 0.5);
    const uint32_t first = static_cast<uint32_t>(faces.positions.size());
    for (int k = 0; k < 3; ++k) faces.positions.push_back(Vec3d(Vec3(centre + size * r.direction()))); // float, as they are traced
    faces.triangles.push_back({first, first + 1, first + 2});
  }
  return faces;
}

/// A ball of 2 n by n patches.
Faces ball(int n) {
  Faces faces;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      const double polar = glm::pi<double>() * i / n, around = glm::pi<double>() * j / n;
      const double s = i == 0 || i == n ? 0 : std::sin(polar); // the poles are single points
      faces.positions.push_back({s * std::cos(around), std::cos(polar), s * std::sin(around)});
    }
  const auto at = [&](int i, int j) { return static_cast<uint32_t>(i * 2 * n + j % (2 * n)); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      faces.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
      faces.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
    }
  return faces;
}

Faces cube() {
  Faces faces;
  for (int i = 0; i < 8; ++i) faces.positions.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
  for (const std::array<uint32_t, 4>& q :
       {std::array<uint32_t, 4>{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
    faces.triangles.push_back({q[0], q[1], q[2]}), faces.triangles.push_back({q[0], q[2], q[3]});
  return faces;
}

/// Where the ray meets a triangle; infinity where it does not. `margin` says by how much it is on the inside (or out).
double meet(const Ray& ray, const Vec3d& a, const Vec3d& b, const Vec3d& c, double& margin) {
  const Vec3d o(ray.origin), d(ray.direction), e = b - a, f = c - a, n = glm::cross(e, f);
  const double across = glm::dot(d, n), t = glm::dot(a - o, n) / across;
  const Vec3d p = o + t * d - a;
  const double area = glm::dot(n, n), v = glm::dot(glm::cross(e, p), n) / area, u = glm::dot(glm::cross(p, f), n) / area;
  margin = std::min({u, v, 1 - u - v});
  return margin >= 0 && t > ray.t_near && t < ray.t_far ? t : std::numeric_limits<double>::infinity();
}

Ray ray_between(const Vec3& from, const Vec3& to) {
  Ray ray;
  ray.origin = from, ray.direction = glm::normalize(to - from);
  return ray;
}

TEST(Dressing, EveryHitIsTheNearestTriangle) {
  const Faces faces = random_soup(400);
  const Tracer tracer(scene_of(mesh_of(faces)));
  SolveCounters counters;
  int hits = 0, judged = 0;
  for (int i = 0; i < 5000; ++i) {
    Random r(i);
    Ray ray = ray_between(Vec3(r.direction() * r.uniform(0.1, 4)), random_point(r));
    if (i % 5 == 0) ray.t_far = float(r.uniform(0.5, 3));
    double nearest = std::numeric_limits<double>::infinity();
    bool is_close_call = false;
    for (const Triangle& t : faces.triangles) {
      double margin = 0;
      nearest = std::min(nearest, meet(ray, faces.positions[t[0]], faces.positions[t[1]], faces.positions[t[2]], margin));
      is_close_call |= std::abs(margin) < 1e-3;
    }
    is_close_call |= std::abs(nearest - ray.t_far) < 1e-4;
    if (is_close_call) continue;
    ++judged;
    Hit hit;
    ASSERT_EQ(tracer.intersect(ray, counters, hit), std::isfinite(nearest)) << i;
    ASSERT_EQ(tracer.occluded(ray, counters), std::isfinite(nearest)) << i;
    if (!std::isfinite(nearest)) continue;
    ++hits;
    EXPECT_NEAR(hit.t, nearest, 1e-5) << i;
    EXPECT_LT(glm::length(hit.position - (ray.origin + hit.t * ray.direction)), 1e-5f) << i;
    EXPECT_NEAR(glm::length(hit.normal), 1, 1e-5);
    EXPECT_EQ(hit.is_leaving, glm::dot(hit.normal, ray.direction) > 0);
    Hit first; // what leaves the hit does not meet it again
    const Ray back = depart(ray, hit, -ray.direction, Side::near), on = depart(ray, hit, ray.direction, Side::far);
    EXPECT_TRUE(!tracer.intersect(back, counters, first) || first.t > 1e-3 * hit.t) << i;
    EXPECT_TRUE(!tracer.intersect(on, counters, first) || first.position != hit.position) << i;
  }
  EXPECT_GT(judged, 4000);
  EXPECT_GT(hits, 500);
}

// From inside a closed mesh every ray meets it, through its edges too. Where many triangles meet in a vertex Embree
// promises nothing: one ray in ten thousand that are aimed at vertices slips through.
TEST(Dressing, ClosedMeshesAreWatertight) {
  const Faces faces = ball(12);
  const Tracer tracer(scene_of(mesh_of(faces)));
  SolveCounters counters;
  int slipped = 0;
  constexpr int k_rays = 30000;
  for (int i = 0; i < k_rays; ++i) {
    Random r(i);
    const Triangle& t = faces.triangles[size_t(r.below(int(faces.triangles.size())))];
    const Vec3d a = faces.positions[t[0]], b = faces.positions[t[1]];
    const bool at_vertex = i % 3 == 0;
    const Vec3d target = at_vertex ? a : i % 3 == 1 ? a + r.uniform(0.01, 0.99) * (b - a) : 2.0 * r.direction();
    const Ray ray = ray_between(Vec3(0.5 * r.direction()), Vec3(target));
    Hit hit;
    const bool found = tracer.intersect(ray, counters, hit);
    EXPECT_EQ(tracer.occluded(ray, counters), found);
    slipped += !found;
    EXPECT_TRUE(at_vertex || found) << i;
    EXPECT_TRUE(!found || hit.is_leaving);
  }
  EXPECT_LT(slipped, k_rays / 10000);
}

/// A field, a mesh through it and a plane below.
FrameScene mixture() {
  FrameScene scene = scene_of(field_of(thin_cloud(Falloff::quartic)));
  SampledShape mesh, floor;
  mesh.name = "mesh", mesh.geometry = mesh_of(random_soup(200));
  floor.name = "floor", floor.geometry = Plane<SampledMode>{Vec3(0, -0.5f, 0), Vec3(0, 1, 0)};
  scene.shapes.push_back(mesh), scene.shapes.push_back(floor);
  return scene;
}

TEST(Dressing, TheNearestOfFieldsMeshesAndPlanesIsMet) {
  const FrameScene all = mixture();
  const Tracer tracer(all);
  std::vector<Tracer> single;
  for (size_t i = 0; i < all.shapes.size(); ++i) {
    FrameScene one;
    one.shapes.push_back(all.shapes[i]);
    single.emplace_back(one);
  }
  SolveCounters counters;
  std::array<int, 3> met{};
  for (int i = 0; i < 5000; ++i) {
    Random r(i);
    const Ray ray = ray_between(Vec3(3.0 * r.direction()), random_point(r));
    Hit hit, nearest;
    nearest.t = std::numeric_limits<float>::infinity();
    for (uint32_t s = 0; s < single.size(); ++s)
      if (Hit h; single[s].intersect(ray, counters, h) && h.t < nearest.t) nearest = h, nearest.shape = s;
    ASSERT_EQ(tracer.intersect(ray, counters, hit), std::isfinite(nearest.t));
    ASSERT_EQ(tracer.occluded(ray, counters), std::isfinite(nearest.t));
    if (!std::isfinite(nearest.t)) continue;
    EXPECT_EQ(hit.t, nearest.t);
    EXPECT_EQ(hit.shape, nearest.shape);
    EXPECT_EQ(hit.normal, nearest.normal);
    ++met[hit.shape];
  }
  for (const int n : met) EXPECT_GT(n, 100);
}

// As everywhere: a ray's answer in a packet does not depend on the others.
TEST(Dressing, PacketsAreNoMoreThanTheirRays) {
  const Tracer tracer(mixture());
  SolveCounters counters;
  int hit = 0, missed = 0;
  for (int packet = 0; packet < 300; ++packet) {
    Random r(packet);
    std::vector<Ray> rays;
    for (size_t i = 0; i < k_packet; ++i) rays.push_back(ray_between(Vec3(0, 0, 4) + 0.1f * random_point(r), 0.5f * random_point(r)));
    std::array<Hit, k_packet> hits;
    const uint32_t found = tracer.intersect(rays, counters, hits.data()), dark = tracer.occluded(rays, counters);
    EXPECT_EQ(found, dark);
    for (size_t i = 0; i < k_packet; ++i) {
      Hit lone;
      ASSERT_EQ(tracer.intersect(std::span(&rays[i], 1), counters, &lone), found >> i & 1);
      ++(found >> i & 1 ? hit : missed);
      if (!(found >> i & 1)) continue;
      EXPECT_EQ(lone.t, hits[i].t);
      EXPECT_EQ(lone.position, hits[i].position);
      EXPECT_EQ(lone.normal, hits[i].normal);
      EXPECT_EQ(lone.shape, hits[i].shape);
    }
  }
  EXPECT_GT(hit, 1000);
  EXPECT_GT(missed, 100);
}

// Embree ends the program for a ray that is no number: it must not see one.
TEST(Dressing, RaysThatAreNoneMeetNothing) {
  FrameScene scene = mixture();
  scene.shapes.pop_back(); // a plane is met from any distance
  const Tracer tracer(scene);
  SolveCounters counters;
  Hit hit;
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e19f, -1e30f}) {
    std::vector<Ray> rays(4, ray_between(Vec3(0, 0, 4), Vec3(0, 0.1f, 0)));
    rays[1].origin.y = wrong, rays[2].direction.x = wrong;
    for (const size_t i : {1, 2}) {
      EXPECT_FALSE(tracer.intersect(rays[i], counters, hit));
      EXPECT_FALSE(tracer.occluded(rays[i], counters));
    }
    std::array<Hit, 4> hits;
    ASSERT_TRUE(tracer.intersect(rays[0], counters, hit));
    EXPECT_EQ(tracer.intersect(rays, counters, hits.data()), 9u); // the first and the last, which are good
    EXPECT_EQ(tracer.occluded(rays, counters), 9u);
  }
}

TEST(Dressing, EdgesSharperThanTheCreaseStay) {
  const TriangleMesh<SampledMode> sharp = mesh_of(cube()), smooth = mesh_of(cube(), 100);
  for (size_t t = 0; t < 12; ++t)
    for (size_t c = 0; c < 3; ++c) {
      const Vec3& n = sharp.mesh->normals[t][c];
      EXPECT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1, 1e-6);
      // The mean over a cube's corner is its diagonal, however its faces are cut: angles are the weights.
      const Vec3 p(smooth.mesh->positions[smooth.mesh->triangles[t][c]]);
      EXPECT_LT(glm::length(smooth.mesh->normals[t][c] - glm::normalize(p)), 1e-6f);
    }
  const TriangleMesh<SampledMode> round = mesh_of(ball(24));
  for (size_t t = 0; t < round.mesh->triangles.size(); ++t)
    for (size_t c = 0; c < 3; ++c)
      EXPECT_LT(glm::length(round.mesh->normals[t][c] - Vec3(round.mesh->positions[round.mesh->triangles[t][c]])), 0.02f);
}

// Where the smooth surface sees the sun, the coarse triangles below do not take it away; and from its far side they do.
TEST(Dressing, SmoothMeshesDoNotShadowThemselvesAtTheTerminator) {
  const Tracer tracer(scene_of(mesh_of(ball(6), 180)));
  SolveCounters counters;
  const Vec3 sun = glm::normalize(Vec3(1, 0.5f, 0.2f));
  int lit = 0, lost = 0, unlifted_lost = 0, turned_away = 0;
  for (int i = 0; i < 20000; ++i) {
    Random r(i);
    const Vec3 from = Vec3(3.0 * r.direction());
    const Ray ray = ray_between(from, 0.9f * random_point(r));
    Hit hit;
    if (!tracer.intersect(ray, counters, hit)) continue;
    EXPECT_LE(glm::dot(hit.normal, ray.direction), 0) << "it faces who sees it";
    const float cosine = glm::dot(hit.normal, sun);
    if (cosine < -0.6f) {
      EXPECT_TRUE(tracer.occluded(depart(ray, hit, sun, Side::near), counters));
      ++turned_away;
    }
    if (cosine < 0.1f) continue;
    ++lit;
    lost += tracer.occluded(depart(ray, hit, sun, Side::near), counters);
    hit.lift = Vec3(0);
    unlifted_lost += tracer.occluded(depart(ray, hit, sun, Side::near), counters);
  }
  EXPECT_GT(lit, 2000);
  EXPECT_GT(turned_away, 1000);
  EXPECT_LT(lost, lit / 200);
  EXPECT_GT(unlifted_lost, lit / 100) << "else this would test nothing";
}

// Closed meshes are media like fields: a ball of blobs within a mesh within a field, and a floor.
TEST(Dressing, MeshesAreEnteredAndLeftLikeFields) {
  const auto blob_ball = [](double radius) {
    return scene_of(field_of({Blob{Vec3(0), float(radius / std::sqrt(1 - std::sqrt(0.5))), 2, Falloff::quartic}})).shapes[0];
  };
  FrameScene scene = scene_of(mesh_of(ball(24)));
  scene.shapes.push_back(blob_ball(0.5)), scene.shapes.push_back(blob_ball(2));
  SampledShape floor;
  floor.name = "floor", floor.geometry = Plane<SampledMode>{Vec3(0, -3, 0), Vec3(0, 1, 0)};
  scene.shapes.push_back(floor);
  const Tracer tracer(scene);
  SolveCounters counters;
  Ray ray = ray_between(Vec3(0.03f, 5, 0.02f), Vec3(0.03f, 0, 0.02f));
  struct Crossing {
    uint32_t shape;
    bool is_leaving;
    float y;
  };
  for (const Crossing& c :
       {Crossing{2, false, 2}, {0, false, 1}, {1, false, 0.5f}, {1, true, -0.5f}, {0, true, -1}, {2, true, -2}, {3, false, -3}}) {
    Hit hit;
    ASSERT_TRUE(tracer.intersect(ray, counters, hit));
    EXPECT_EQ(hit.shape, c.shape);
    EXPECT_EQ(hit.is_leaving, c.is_leaving);
    EXPECT_NEAR(hit.position.y, c.y, 0.01);
    ray = depart(ray, hit, ray.direction, Side::far);
    EXPECT_EQ(ray.inside.contains(c.shape), !c.is_leaving);
  }
  Hit hit;
  EXPECT_FALSE(tracer.intersect(ray, counters, hit));
}

// Meshes of any size have normals and are met from where rays leave them.
TEST(Dressing, MeshesMayBeTinyOrHuge) {
  for (const float size : {1e-6f, 1e-3f, 1e6f}) {
    TriangleMesh<SampledMode> kind = mesh_of(ball(12));
    kind.scale = Vec3(size);
    const Tracer tracer(scene_of(kind));
    SolveCounters counters;
    for (int i = 0; i < 300; ++i) {
      Random r(i);
      const Ray ray = ray_between(size * Vec3(3.0 * r.direction()), 0.5f * size * random_point(r));
      Hit hit;
      ASSERT_TRUE(tracer.intersect(ray, counters, hit)) << size << ' ' << i;
      EXPECT_GT(glm::dot(hit.normal, hit.position), 0.9f * size) << size << ' ' << i;
      EXPECT_TRUE(tracer.occluded(depart(ray, hit, ray.direction, Side::far), counters)) << size << ' ' << i;
      EXPECT_FALSE(tracer.occluded(depart(ray, hit, -ray.direction, Side::near), counters)) << size << ' ' << i;
    }
  }
}

TEST(Dressing, IsPlacedByScaleRotationAndPosition) {
  TriangleMesh<SampledMode> kind = mesh_of(cube());
  kind.scale = Vec3(1, 2, 3), kind.axis = Vec3(0, 0, 2), kind.angle = 90, kind.position = Vec3(10, 0, 0);
  const Tracer tracer(scene_of(kind));
  SolveCounters counters;
  // The side x = 1 of the file looks up, at y = 1; the side y = 1 looks to -x, at x = 8.
  Hit hit;
  ASSERT_TRUE(tracer.intersect(ray_between(Vec3(10.5f, 5, 1), Vec3(10.5f, 0, 1)), counters, hit));
  EXPECT_NEAR(hit.t, 4, 1e-5);
  EXPECT_LT(glm::length(hit.normal - Vec3(0, 1, 0)), 1e-5f);
  ASSERT_TRUE(tracer.intersect(ray_between(Vec3(0, 0.2f, 2.5f), Vec3(10, 0.2f, 2.5f)), counters, hit));
  EXPECT_NEAR(hit.t, 8, 1e-5);
  EXPECT_LT(glm::length(hit.normal - Vec3(-1, 0, 0)), 1e-5f);
}

// A mirror turns the corners of triangles round, and what is outside stays so.
TEST(Dressing, AMirroredMeshIsEnteredFromOutside) {
  TriangleMesh<SampledMode> kind = mesh_of(cube());
  kind.scale = Vec3(-1, 1, 1);
  const Tracer tracer(scene_of(kind));
  SolveCounters counters;
  Hit hit;
  ASSERT_TRUE(tracer.intersect(ray_between(Vec3(-0.3f, 5, 0.4f), Vec3(-0.3f, 0, 0.4f)), counters, hit));
  EXPECT_FALSE(hit.is_leaving);
  EXPECT_LT(glm::length(hit.normal - Vec3(0, 1, 0)), 1e-5f);
}

} // namespace
} // namespace kelpie
