// Signed distances: what the analytic ones are, and how near to a mesh's own distance its lattice comes.
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "field/mesh/curved.h"
#include "field/mesh/triangle_tree.h"
#include "renderer/program/evaluate.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

Point3<double> point(const Vec3d& p) { return {p.x, p.y, p.z}; }

/// Calls test(kind, random) for every analytic distance, with random parameters.
template <class Test>
void for_each_distance(Test&& test) {
  FieldKinds::for_each([&]<template <class> class Kind>() {
    using K = Kind<SampledMode>;
    if constexpr (SignedDistance<K> && !requires(K k) { k.grid; })
      for (unsigned trial = 0; trial < 100 && !testing::Test::HasFailure(); ++trial) {
        SCOPED_TRACE(fmt::format("{} {}", K::k_name, trial));
        Random r(trial);
        K kind = random_kind<Kind>(r);
        if constexpr (requires { kind.minor_radius; }) kind.minor_radius = std::min(kind.minor_radius, kind.major_radius);
        test(kind, r);
      }
  });
}

// From any place the way along the gradient, as long as the distance says, ends on the surface.
TEST(SignedDistances, AreExact) {
  int compared = 0;
  for_each_distance([&](const auto& kind, Random& r) {
    using ValueAndSlopes = Dual<double, 3>;
    for (int i = 0; i < 20; ++i) {
      const Vec3d p = r.in(Box3d{Vec3d(-3), Vec3d(3)});
      const ValueAndSlopes d = kind.signed_distance(
          Point3<ValueAndSlopes>{ValueAndSlopes::variable(p.x, 0), ValueAndSlopes::variable(p.y, 1), ValueAndSlopes::variable(p.z, 2)});
      const Vec3d slope(d.d[0], d.d[1], d.d[2]);
      EXPECT_LT(glm::length(slope), 1 + 1e-9);
      if (glm::length(slope) < 1 - 1e-9) continue; // as far from one side as from another
      EXPECT_NEAR(kind.signed_distance(point(p - d.value * slope)), 0, 1e-9);
      ++compared;
    }
  });
  EXPECT_GT(compared, 10000);
}

// With weight 1 the field is the threshold on the surface, whatever the radius, and from 0 to 2 of it about.
TEST(SignedDistances, PutTheSurfaceWhereTheDistanceIsZero) {
  for_each_distance([&](auto kind, Random& r) {
    kind.weight = 1, kind.falloff = DistanceFalloff::distance;
    for (int i = 0; i < 20; ++i) {
      const Vec3d p = r.in(Box3d{Vec3d(-3), Vec3d(3)});
      const double d = kind.signed_distance(point(p)), f = kind.potential(point(p));
      EXPECT_TRUE(std::abs(d) < 1e-9 || (f > 1) == (d < 0));
      EXPECT_NEAR(f, std::clamp(1 - d / kind.reach(), 0.0, 2.0), 1e-12);
    }
  });
}

TEST(SignedDistances, CountInThresholds) {
  SampledField field;
  SdfSphere<SampledMode> ball;
  ball.radius = 0.5f;
  add(field, ball);
  const FieldProgram program = compile(std::move(field), 0.7);
  const auto at = [&](double x) { return evaluate(program, program.code, point({x, 0, 0})); };
  EXPECT_NEAR(at(1), 0.7, 1e-12);
  EXPECT_NEAR(at(1.25), 0.35, 1e-12);
  EXPECT_EQ(at(1.5), 0);
  EXPECT_NEAR(at(0), 1.4, 1e-12);
}

// --- what has no end ---

const std::string k_plane = R"({"kind":"sdf_plane","point":[0,0,0]})",
                  k_ball = R"({"kind":"sdf_sphere","centre":[0,0,0],"sphere_radius":1})";

std::string joined(const std::string& kind, const std::string& a, const std::string& b) {
  return R"({"kind":")" + kind + R"(","children":[)" + a + "," + b + "]}";
}

TEST(Planes, AreRefusedWhereNothingEndsThem) {
  const SceneFolder folder;
  for (const std::string& field : {k_plane, joined("union", k_ball, k_plane), joined("blend", k_plane, k_ball),
                                   joined("difference", k_plane, k_ball), R"({"kind":"translate","by":[0,0,1],"child":)" + k_plane + "}"}) {
    const std::string errors = folder.errors(scene_with_field(field));
    EXPECT_NE(errors.find("shape \"a\" has no end: intersect the sdf_plane with something that has one"), std::string::npos) << errors;
    EXPECT_NE(errors.find(fmt::format(":1:{}:", scene_with_field(field).find("{\"kind\":\"sdf_plane\"") + 1)), std::string::npos) << errors;
  }
  for (const std::string& field : {joined("intersection", k_plane, k_ball), joined("difference", k_ball, k_plane),
                                   joined("intersection", k_ball, joined("blend", k_plane, k_ball))})
    EXPECT_EQ(folder.errors(scene_with_field(field)), "");
}

TEST(Planes, EndWhereTheyAreCut) {
  SampledField field;
  SdfPlane<SampledMode> plane;
  SdfSphere<SampledMode> ball;
  Intersection<SampledMode> both;
  Rotate<SampledMode> turned;
  turned.child = add(field, plane), turned.axis = Vec3(1, 2, 3), turned.angle = 30;
  both.children = {add(field, turned), add(field, ball)};
  add(field, both);
  EXPECT_LT(compile(std::move(field), 1).support.diagonal(), 8);
}

// --- meshes ---

/// A ball of radius 1 around `centre`; of its rows of faces only some are there, if so asked.
Mesh globe(int rows, const Vec3d& centre, int first_row = 0) {
  Mesh mesh;
  const int columns = 2 * rows;
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double tilt = std::numbers::pi * i / rows, turn = 2 * std::numbers::pi * j / columns;
      mesh.positions.push_back(Vec3d(std::sin(tilt) * std::cos(turn), std::cos(tilt), std::sin(tilt) * std::sin(turn)) + centre);
    }
  for (int i = first_row; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const auto at = [&](int y, int x) { return uint32_t(y * columns + (y == 0 || y == rows ? 0 : x % columns)); };
      if (i > 0) mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
      if (i + 1 < rows) mesh.triangles.push_back({at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
    }
  return mesh;
}

TEST(TriangleTrees, KnowDistancesAndWindings) {
  const Mesh whole = globe(24, Vec3d(0.2)), bowl = globe(24, Vec3d(0.2), 8);
  const TriangleTree closed(whole), open(bowl);
  EXPECT_GT(signed_volume(whole), 4);
  Random r(1);
  double most = 0;
  int compared = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d p = r.in(Box3d{Vec3d(-1.5), Vec3d(1.9)});
    const double from_centre = glm::distance(p, Vec3d(0.2));
    if (from_centre > 0.99 && from_centre < 1.001) continue; // between the ball and its triangles
    ++compared;
    most = std::max(most, std::abs(closed.winding(p) - (from_centre < 1)));
    EXPECT_NEAR(closed.distance(p, 10), std::abs(from_centre - 1), 0.009);
    EXPECT_LE(open.distance(p, 0.3), 0.3);
    // The solid angle of all triangles, one by one.
    double angle = 0;
    for (const Triangle& t : bowl.triangles) {
      Mesh one;
      one.positions = {bowl.positions[t[0]], bowl.positions[t[1]], bowl.positions[t[2]]}, one.triangles = {{0, 1, 2}};
      if (i < 100) angle += TriangleTree(one).winding(p);
    }
    EXPECT_TRUE(i >= 100 || std::abs(open.winding(p) - angle) < 0.05);
  }
  EXPECT_LT(most, 0.05);
  EXPECT_GT(compared, 1950);
}

// The lattice's distance differs from a smooth mesh's own by a twentieth of a voxel at most (measured: 0.03).
TEST(MeshDistances, AreNearTheMeshsOwn) {
  const Mesh mesh = globe(48, Vec3d(3, -1, 2));
  const double voxel = 2.0 / 40;
  const DistanceGrid grid = make_distance_grid(mesh, voxel, 4 * voxel);
  const TriangleTree tree(mesh);
  Random r(3);
  double most = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d p = Vec3d(3, -1, 2) + r.direction() * r.uniform(1 - 3 * voxel, 1 + 3 * voxel);
    const double d = tree.distance(p, 1) * (tree.winding(p) > 0.5 ? -1 : 1);
    most = std::max(most, std::abs(grid.at(point(p)).value - d));
  }
  RecordProperty("most_in_voxels", std::to_string(most / voxel));
  EXPECT_LT(most, 0.05 * voxel);
  EXPECT_EQ(grid.at(point({3, -1, 2})).value, -grid.band());
  EXPECT_EQ(grid.at(point({3, 1, 2})).value, grid.band());
  EXPECT_EQ(grid.at(point({30, 1, 2})).value, grid.band());
}

// Facets of 12 degrees are one smooth surface, whose normals are those of the ball; a cube keeps its edges.
TEST(MeshDistances, AreSmoothUpToACrease) {
  const auto worst_normal = [](const Mesh& mesh) {
    const DistanceGrid grid = make_distance_grid(mesh, 2.0 / 64, 4 * 2.0 / 64);
    Random r(5);
    double most = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3d out = r.direction();
      const GridValue<double> at = grid.at(point(out));
      most = std::max(
          most, glm::degrees(std::acos(std::min(1.0, glm::dot(out, glm::normalize(Vec3d(at.slopes[0], at.slopes[1], at.slopes[2])))))));
    }
    return most;
  };
  const Mesh ball = globe(15, Vec3d(0)), curved = curved_mesh(ball, 30, 0.05, "ball");
  EXPECT_TRUE(is_closed(curved));
  EXPECT_GT(worst_normal(ball), 5);
  EXPECT_LT(worst_normal(curved), 1.5);
  EXPECT_GT(worst_normal(curved_mesh(ball, 5, 0.05, "ball")), 5); // all its edges are sharper

  Mesh cube;
  for (int i = 0; i < 8; ++i) cube.positions.push_back({i & 4 ? 1 : -1, i & 2 ? 1 : -1, i & 1 ? 1 : -1});
  const uint32_t sides[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  for (const auto& s : sides) cube.triangles.push_back({s[0], s[1], s[2]}), cube.triangles.push_back({s[0], s[2], s[3]});
  const Mesh same = curved_mesh(cube, 40, 0.3, "cube");
  EXPECT_TRUE(is_closed(same));
  EXPECT_NEAR(std::abs(signed_volume(same)), 8, 1e-9);
}

/// The largest jump of a grid between neighbouring places, across all borders of bricks and voxels that lines happen on.
double largest_jump(const DistanceGrid& grid) {
  Random r(4);
  double most = 0;
  for (int i = 0; i < 200000; ++i) {
    Vec3d p = r.in(grid.box().padded(grid.voxel()));
    const int axis = r.below(3);
    p[axis] = grid.box().lower[axis] + grid.voxel() * std::round((p[axis] - grid.box().lower[axis]) / grid.voxel());
    Vec3d h(0);
    h[axis] = 1e-9 * grid.voxel();
    most = std::max(most, std::abs(grid.at(point(p + h)).value - grid.at(point(p - h)).value));
  }
  return most;
}

// A bowl is closed by the surface on which it winds by a half; a lattice of it is continuous all the same.
TEST(MeshDistances, CloseHoles) {
  const Mesh bowl = globe(24, Vec3d(0), 8);
  const DistanceGrid grid = make_distance_grid(bowl, 0.05, 0.2);
  EXPECT_LT(largest_jump(grid), 1e-6);
  for (const double y : {-0.9, -0.5, 0.0, 0.3}) EXPECT_LT(grid.at(point({0, y, 0})).value, 0) << y;
  for (const double y : {-1.1, 0.9, 1.2}) EXPECT_GT(grid.at(point({0, y, 0})).value, 0) << y;
}

// Files as bad as users have: whatever the field is, it is one that the renderer can bound.
TEST(MeshDistances, BrokenMeshesAreFieldsToo) {
  const char* data = std::getenv("KELPIE_DATA");
  if (!data) GTEST_SKIP() << "KELPIE_DATA names no folder of meshes";
  int loaded = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(data) / "bad")) {
    const std::string name = entry.path().filename().string(), extension = entry.path().extension().string();
    if (!entry.is_regular_file()) continue;
    if (extension != ".obj" && extension != ".off" && extension != ".ply" && extension != ".stl") continue;
    SCOPED_TRACE(name);
    std::shared_ptr<const DistanceGrid> grid;
    Diagnostics quiet;
    try {
      const Mesh mesh = load_mesh(entry.path().string(), quiet);
      const double longest = std::max({bounding_box(mesh).extent().x, bounding_box(mesh).extent().y, bounding_box(mesh).extent().z});
      grid = load_distance_grid(entry.path().string(), {longest / 16}, false, quiet);
    } catch (const Error& e) {
      EXPECT_EQ(e.status, ExitStatus::bad_data);
      continue;
    }
    ++loaded;
    EXPECT_LE(largest_jump(*grid), 1e-6 * grid->band());
  }
  EXPECT_GT(loaded, 10);
}

} // namespace
} // namespace kelpie
