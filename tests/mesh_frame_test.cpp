// Meshes of fields, judged by CGAL, by the fields themselves and by what is known of shapes.
#include "renderer/mesh/mesh_frame.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "field/mesh/triangle_tree.h"
#include "renderer/measure/measure_morph.h"
#include "renderer/mesh/survey.h"
#include "renderer/program/surface_search.h"
#include "tests/reference/examine_mesh.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

std::string faults_of(const Mesh& mesh) {
  std::vector<std::array<double, 3>> positions;
  for (const Vec3d& p : mesh.positions) positions.push_back({p.x, p.y, p.z});
  return reference::faults_of_mesh(positions, mesh.triangles);
}

std::vector<size_t> shapes_with_fields(const FrameScene& frame) {
  std::vector<size_t> out;
  for (size_t i = 0; i < frame.shapes.size(); ++i)
    if (!frame.shapes[i].geometry) out.push_back(i);
  return out;
}

/// How far vertices of a uniform mesh of the field are from this one, at most.
double farthest_from_mesh(const Mesh& mesh, const FieldProgram& program, double scale) {
  const Lattice lattice = Lattice::around(surface_bounds(program), 100);
  const Isosurface surface = extract_surface({program, program, program}, lattice);
  const TriangleTree tree(mesh);
  double farthest = 0;
  for (const Vec3d& p : surface.mesh.positions) farthest = std::max(farthest, tree.distance(scale * p, 1e9));
  return farthest;
}

class MeshFrame : public testing::Test {
protected:
  MeshedFrame mesh(const Scene& scene, MeshFrameOptions options = {}, double frame = 1) {
    const FrameScene at = sample(scene, frame);
    return mesh_frame(at, shapes_with_fields(at), options);
  }
  /// Of a scene of one field, in millimetres as the scene has units.
  Mesh mesh_of_field(std::string_view field, double tolerance, size_t most_triangles = 100'000'000) {
    MeshFrameOptions options;
    options.units = 0.001, options.tolerance = tolerance, options.most_triangles = most_triangles;
    return mesh(folder_.read(scene_with_field(field)), options).objects[0].mesh;
  }

  SceneFolder folder_;
};

TEST_F(MeshFrame, Sphere) {
  const Mesh m = mesh_of_field(R"({"kind":"sdf_sphere","centre":[3,1,-2],"sphere_radius":50})", 0.2);
  EXPECT_EQ(faults_of(m), "");
  for (const Vec3d& p : m.positions) EXPECT_NEAR(glm::distance(p, Vec3d(3, 1, -2)), 50, 0.02);
  EXPECT_NEAR(signed_volume(m), 4.18879e0 * 125'000, 0.005 * 523'599);
  EXPECT_LT(m.triangles.size(), 5000u);
}

TEST_F(MeshFrame, FlatFacesNeedFewTriangles) {
  const Mesh m = mesh_of_field(R"({"kind":"sdf_box","centre":[0,0,0],"size":[100,60,40]})", 0.5);
  EXPECT_EQ(faults_of(m), "");
  EXPECT_LT(m.triangles.size(), 100u) << "edges cost, faces do not";
  EXPECT_NEAR(signed_volume(m), 240'000, 0.25 * 24'800) << "half the tolerance times the area";
  const TriangleTree tree(m);
  for (const double x : {-50, 50})
    for (const double y : {-30, 30})
      for (const double z : {-20, 20}) EXPECT_LT(tree.distance({x, y, z}, 1e9), 0.5) << "corners";
}

// A sheet of a hundredth of its width, and a ball of a hundredth far away from it.
TEST_F(MeshFrame, ThinAndSmallPartsAreFound) {
  const Mesh m = mesh_of_field(R"({"kind":"union","children":[{"kind":"sdf_box","centre":[0,0,0],"size":[100,1,100]},
      {"kind":"sdf_sphere","centre":[90,40,30],"sphere_radius":0.5}]})",
                               0.5);
  EXPECT_EQ(faults_of(m), "");
  const Survey s = survey(m);
  EXPECT_EQ(s.pieces.size(), 2u);
  EXPECT_NEAR(s.thinnest, 1, 0.5);
}

TEST_F(MeshFrame, CavitiesFaceInward) {
  const Mesh m = mesh_of_field(R"({"kind":"difference","children":[{"kind":"sdf_sphere","centre":[0,0,0],"sphere_radius":20},
      {"kind":"sdf_sphere","centre":[0,0,0],"sphere_radius":15}]})",
                               0.1);
  EXPECT_EQ(faults_of(m), "");
  const Survey s = survey(m);
  EXPECT_EQ(s.pieces.size(), 1u);
  EXPECT_EQ(s.cavities.size(), 1u);
  EXPECT_NEAR(s.thinnest, 5, 0.1);
  EXPECT_NEAR(s.volume, 4.18879 * (8000 - 3375), 80);
}

TEST_F(MeshFrame, ABudgetIsKept) {
  const Mesh m = mesh_of_field(R"({"kind":"sdf_torus","centre":[0,0,0],"major_radius":40,"minor_radius":12})", 0.2, 1000);
  EXPECT_EQ(faults_of(m), "");
  EXPECT_LE(m.triangles.size(), 1000u);
  EXPECT_GT(m.triangles.size(), 900u);
}

TEST_F(MeshFrame, SizeScalesTheLongestSide) {
  MeshFrameOptions options;
  options.size = 200, options.up = UpAxis::z;
  const MeshedFrame m = mesh(folder_.read(scene_with_field(R"({"kind":"union","children":[
      {"kind":"sdf_sphere","centre":[1,2,3],"sphere_radius":0.5},{"kind":"sdf_sphere","centre":[1,3,3],"sphere_radius":0.5}]})")),
                             options);
  const Box3d box = bounding_box(m.objects[0].mesh);
  EXPECT_NEAR(box.upper.z, 200, 0.1) << "up";
  EXPECT_NEAR(box.upper.x, 100, 0.2);
  EXPECT_NEAR(box.upper.y, 100, 0.2);
  EXPECT_NEAR(glm::length(box.lower), 0, 0.2);
  EXPECT_NEAR(m.tolerance, 0.2, 0.01) << "a thousandth";
}

TEST_F(MeshFrame, ColoursAreThoseOfMaterials) {
  const Scene scene = folder_.read(R"({"kelpie":1,"units":0.001,"shapes":[{"name":"a","field":{"kind":"union","children":[
      {"kind":"sdf_sphere","centre":[0,0,0],"sphere_radius":1,"material":{"kind":"matte","colour":"#ff0000"}},
      {"kind":"sdf_sphere","centre":[3,0,0],"sphere_radius":1}]},"surface":{"kind":"matte","colour":"#0080ff"}}]})");
  MeshFrameOptions options;
  options.units = 0.001;
  const MeshedFrame m = mesh(scene, options);
  const MeshObject& o = m.objects[0];
  ASSERT_EQ(o.colours.size(), o.mesh.positions.size());
  for (size_t i = 0; i < o.colours.size(); ++i) {
    const bool is_red = o.mesh.positions[i].x < 1.5;
    const std::array<int, 3> wanted = is_red ? std::array{255, 0, 0} : std::array{0, 128, 255};
    for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(o.colours[i][c], wanted[c], 2) << i;
  }
}

// One of the chairs that are bred, in millimetres.
TEST_F(MeshFrame, AChildOfSevenChairs) {
  Diagnostics diagnostics;
  ReadOptions how;
  how.recipe = "throne";
  const Scene scene = read_scene(KELPIE_SOURCE "/examples/chairs/breed.json", how, diagnostics);
  MeshFrameOptions options;
  options.size = 200, options.tolerance = 1;
  const FrameScene frame = sample(scene, 1);
  const MeshedFrame m = mesh_frame(frame, shapes_with_fields(frame), options);
  ASSERT_EQ(m.objects.size(), 1u);
  EXPECT_EQ(faults_of(m.objects[0].mesh), "");
  EXPECT_NEAR(bounding_box(m.objects[0].mesh).extent().y, 200, 0.5);
  const FieldProgram program = compile(frame.shapes[0].field, frame.shapes[0].threshold);
  EXPECT_LT(farthest_from_mesh(m.objects[0].mesh, program, 200 / surface_bounds(program, 400).extent().y), 1.5);
}

/// Each example at a size of 200 mm.
class Examples : public MeshFrame, public testing::WithParamInterface<const char*> {};

TEST_P(Examples, AreSolidsWithinTheTolerance) {
  const std::string path = fmt::format("{}/examples/{}.json", KELPIE_SOURCE, GetParam());
  Diagnostics diagnostics;
  const Scene scene = read_scene(path, {}, diagnostics);
  const FrameScene frame = sample(scene, scene.frames.first);
  for (const size_t shape : shapes_with_fields(frame)) {
    SCOPED_TRACE(frame.shapes[shape].name);
    const FieldProgram program = compile(frame.shapes[shape].field, frame.shapes[shape].threshold);
    const Vec3d extent = surface_bounds(program).extent();
    const double scale = 200 / std::max({extent.x, extent.y, extent.z});
    MeshFrameOptions options;
    options.units = scale / 1000, options.tolerance = 0.5;
    const Mesh m = mesh_frame(frame, std::array{shape}, options).objects[0].mesh;
    EXPECT_EQ(faults_of(m), "");
    EXPECT_TRUE(is_closed(m) && has_single_rings(m));
    EXPECT_LT(farthest_from_mesh(m, program, scale), 0.5);
    MorphMeasurer measurer(scene, shape, {scene.frames.first}, 128);
    EXPECT_NEAR(signed_volume(m) / std::pow(scale, 3), measurer.measure_next().volume, 0.03 * signed_volume(m) / std::pow(scale, 3));
  }
}

INSTANTIATE_TEST_SUITE_P(Mesh, Examples, testing::Values("dolphin", "boolean"), [](const auto& test) { return std::string(test.param); });

Mesh two_triangles(const std::array<Vec3d, 3>& a, const std::array<Vec3d, 3>& b) {
  Mesh m;
  for (const auto& t : {a, b}) {
    Triangle& triangle = m.triangles.emplace_back();
    for (size_t i = 0; i < 3; ++i) {
      const auto at = std::find(m.positions.begin(), m.positions.end(), t[i]);
      triangle[i] = static_cast<uint32_t>(at - m.positions.begin());
      if (at == m.positions.end()) m.positions.push_back(t[i]);
    }
  }
  return m;
}

TEST(SelfIntersections, OfTwoTriangles) {
  const std::array<Vec3d, 3> base{Vec3d(0, 0, 0), Vec3d(8, 0, 0), Vec3d(0, 8, 0)};
  const ExactLattice lattice({Vec3d(-16), Vec3d(16)});
  const auto meet = [&](Vec3d a, Vec3d b, Vec3d c) { return !self_intersections(two_triangles(base, {a, b, c}), lattice).empty(); };
  EXPECT_TRUE(meet({2, 2, -1}, {2, 2, 1}, {9, 9, 0})) << "through the middle";
  EXPECT_TRUE(meet({2, 2, 0}, {2, 2, 1}, {9, 9, 1})) << "a corner on it";
  EXPECT_TRUE(meet({4, -1, 0}, {4, 0, 0}, {5, -1, 0})) << "a corner on its side, in one plane";
  EXPECT_TRUE(meet({1, 1, 0}, {2, 1, 0}, {1, 2, 0})) << "within it";
  EXPECT_FALSE(meet({1, 1, 1}, {2, 1, 1}, {1, 2, 1})) << "above it";
  EXPECT_FALSE(meet({9, 9, -1}, {9, 9, 1}, {9, 8, 0})) << "beside it";
  EXPECT_FALSE(meet({8, 0, 0}, {9, 1, -1}, {9, 1, 1})) << "a shared corner";
  EXPECT_TRUE(meet({0, 0, 0}, {9, 9, -1}, {9, 9, 1})) << "a shared corner, and through it";
  EXPECT_FALSE(meet({8, 0, 0}, {0, 0, 0}, {0, -8, 0})) << "a shared side";
  EXPECT_FALSE(meet({8, 0, 0}, {0, 0, 0}, {0, 8, 1})) << "a shared side, folded a little less than all";
  EXPECT_TRUE(meet({8, 0, 0}, {0, 0, 0}, {1, 8, 0})) << "folded";
  EXPECT_TRUE(meet({0, 8, 0}, {8, 0, 0}, {0, 0, 0})) << "the same";
  EXPECT_TRUE(meet({9, 9, 0}, {10, 10, 0}, {11, 11, 0})) << "without an area";
}

} // namespace
} // namespace kelpie
