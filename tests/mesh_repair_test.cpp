// Meshes that are nearly whole: seams, open parts, parts that face the wrong way.
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "field/distances/mesh.h"
#include "field/mesh/repair.h"
#include "field/mesh/surface.h"
#include "field/mesh/weld.h"

namespace kelpie {
namespace {

constexpr double k_pi = std::numbers::pi;

/// Positions and triangles as a file has them.
struct Part {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles;

  Part& add(const Part& p) {
    const auto first = static_cast<uint32_t>(positions.size());
    positions.insert(positions.end(), p.positions.begin(), p.positions.end());
    for (const Triangle& t : p.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return *this;
  }
  Part turned() const {
    Part p = *this;
    for (Triangle& t : p.triangles) std::swap(t[1], t[2]);
    return p;
  }
};

/// One of the six sides of a cube, of `cells` by `cells`, blown up to a ball.
Part side_of_ball(int side, int cells, double radius = 1) {
  Part p;
  const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double sign = side % 2 ? 1 : -1;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      Vec3d at(0);
      at[axis] = sign, at[u] = std::tan(k_pi / 4 * (2.0 * i / cells - 1)), at[v] = std::tan(k_pi / 4 * (2.0 * j / cells - 1));
      p.positions.push_back(radius * glm::normalize(at));
    }
  const auto index = [&](int i, int j) { return static_cast<uint32_t>(j * (cells + 1) + i); };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      p.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      p.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  return sign > 0 ? p : p.turned();
}

/// Six sides; each has as many cells as `cells` says in turn, so borders need not match.
Part ball(const std::array<int, 6>& cells, double radius = 1) {
  Part p;
  for (int side = 0; side < 6; ++side) p.add(side_of_ball(side, cells[size_t(side)], radius));
  return p;
}
Part ball(int cells, double radius = 1) { return ball({cells, cells, cells, cells, cells, cells}, radius); }

/// Every position moved by up to `by` along each axis.
Part shaken(Part p, double by) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> offset(-by, by);
  for (Vec3d& at : p.positions) at += Vec3d(offset(random), offset(random), offset(random));
  return p;
}

/// Every triangle with vertices of its own.
Part soup_of(const Part& p) {
  Part soup;
  for (const Triangle& t : p.triangles) {
    const auto n = static_cast<uint32_t>(soup.positions.size());
    for (const uint32_t v : t) soup.positions.push_back(p.positions[v]);
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  return soup;
}

Part moved(Part p, const Vec3d& by) {
  for (Vec3d& at : p.positions) at += by;
  return p;
}

Mesh mend(const Part& p, const MeshOptions& options = {}, std::string* said = nullptr) {
  Diagnostics diagnostics;
  Mesh mesh = repair_mesh(p.positions, p.triangles, options, "test", diagnostics);
  if (said)
    for (const Problem& w : diagnostics.warnings()) *said += w.message + "\n";
  return mesh;
}

/// Of an sdf_mesh; negative inside.
double distance(const Part& p, const Vec3d& at) {
  const Mesh mesh = mend(p, {0, false});
  const double voxel = bounding_box(mesh).extent().x / 40;
  const Vec3d q = at;
  return make_distance_grid(mesh, voxel, 4 * voxel).at(Point3<double>{q.x, q.y, q.z}).value;
}

TEST(Weld, SeamsAndSoupsBecomeWholeAtAnyScale) {
  for (const double radius : {1e-3, 1.0, 1e4})
    for (const double noise : {1e-7, 1e-6, 1e-5}) {
      const Part whole = ball(12, radius);
      for (const Part& p : {shaken(whole, noise * radius), shaken(soup_of(whole), noise * radius)}) {
        std::string said;
        const Mesh mesh = mend(p, {}, &said);
        EXPECT_TRUE(is_closed(mesh)) << radius << " " << noise;
        EXPECT_EQ(mesh.positions.size(), 6u * 12 * 12 + 2);
        EXPECT_NEAR(signed_volume(mesh) / std::pow(radius, 3), 4.157, 1e-3);
        EXPECT_NE(said.find("vertices on open borders welded"), std::string::npos) << said;
      }
    }
}

TEST(Weld, LeavesAloneWhatIsApart) {
  // Coarse and fine at once: no edge of the fine half vanishes.
  Part p = side_of_ball(1, 4);
  p.add(moved(side_of_ball(1, 8, 1e-5), Vec3d(3, 0, 0)));
  std::vector<Triangle> triangles = p.triangles;
  EXPECT_EQ(weld_borders(p.positions, triangles, 0).vertices, 0u);
  // A closed thin plate has no border.
  const Part plate = [] {
    Part c = ball(1);
    for (Vec3d& at : c.positions) at.y *= 1e-7;
    return c;
  }();
  EXPECT_TRUE(is_closed(mend(plate)));
  EXPECT_EQ(mend(plate).positions.size(), 8u);
}

TEST(Weld, ToleranceIsAsSaid) {
  const Part p = shaken(ball(12), 1e-3);
  EXPECT_FALSE(is_closed(mend(p)));
  EXPECT_TRUE(is_closed(mend(p, {0.01})));
  const Part near = shaken(ball(12), 1e-6);
  EXPECT_FALSE(is_closed(mend(near, {1e-9, false})));
}

// Sides whose borders do not match cannot be welded: the winding number of all knows the inside, and no side gets a lid.
TEST(Repair, PartsThatCannotBeWeldedAreOneSolid) {
  const Part p = ball({6, 7, 8, 9, 10, 11});
  std::string said;
  const Mesh mesh = mend(p, {}, &said);
  EXPECT_EQ(mesh.triangles.size(), p.triangles.size());
  EXPECT_EQ(said.find("holes that were closed"), std::string::npos) << said;
  EXPECT_NEAR(distance(p, Vec3d(0.9, 0, 0)), -0.1, 0.03);
  EXPECT_LT(distance(p, Vec3d(0, 0.2, 0)), -0.1);
  EXPECT_NEAR(distance(p, Vec3d(0, 0, 1.1)), 0.1, 0.03);
}

TEST(Repair, HolesAreClosedAndPartsInsideStayAsTheyWere) {
  Part open; // without its top
  for (const int side : {0, 1, 2, 4, 5}) open.add(side_of_ball(side, 6));
  for (const Part& p : {open, open.turned()}) {
    std::string said;
    const Mesh mesh = mend(p, {}, &said);
    EXPECT_TRUE(is_closed(mesh));
    EXPECT_GT(signed_volume(mesh), 3);
    EXPECT_NE(said.find("holes that were closed: 1"), std::string::npos) << said;
    EXPECT_LT(distance(p, Vec3d(0, 0.5, 0)), 0);
    EXPECT_GT(distance(p, Vec3d(0, 0.95, 0)), 0);
  }
}

TEST(Repair, CavitiesAndBodiesWithinAreAsTheTrianglesSay) {
  const double outer = 4.0 / 3 * k_pi, inner = outer / 8;
  const Part shell = ball(16), core = ball(16, 0.5);
  const auto volume = [](const Part& a, const Part& b) { return signed_volume(mend(Part(a).add(b))); };
  EXPECT_NEAR(volume(shell, core.turned()), outer - inner, 0.05);
  EXPECT_NEAR(volume(shell.turned(), core), outer - inner, 0.05);
  EXPECT_NEAR(volume(shell, core), outer + inner, 0.05);
  EXPECT_NEAR(volume(shell.turned(), moved(core, Vec3d(3, 0, 0))), outer + inner, 0.05);
}

// A bowl of two open skins, one in the other: the inner one faces inward, and stays so.
TEST(Repair, OpenPartsAreNotTurnedByAVolumeThatTheyDoNotHave) {
  Part bowl, outer, inner;
  for (const int side : {0, 1, 2, 4, 5}) outer.add(side_of_ball(side, 6)), inner.add(side_of_ball(side, 6, 0.85).turned());
  bowl.add(outer).add(inner);
  std::string said;
  const Mesh mesh = mend(bowl, {}, &said);
  EXPECT_EQ(mesh.triangles.size(), bowl.triangles.size());
  EXPECT_EQ(said.find("faced the wrong way"), std::string::npos) << said;
  EXPECT_LT(distance(bowl, Vec3d(0, -0.925, 0)), -0.04);
  EXPECT_GT(distance(bowl, Vec3d(0, -0.7, 0)), 0.05);
  const Mesh upright = mend(bowl.turned(), {}, &said); // all inside out: turned as a whole
  EXPECT_NEAR(signed_volume(upright), signed_volume(mesh), 1e-12);
}

TEST(Repair, FilesWithSeams) {
  for (const auto& [file, vertices, volume] : {std::tuple{"cadball_noise.obj", 866u, 4.15747}, {"soup.obj", 642u, 5.61952}}) {
    Diagnostics diagnostics;
    const Mesh mesh = load_mesh(std::string(KELPIE_CASES "/") + file, diagnostics);
    EXPECT_TRUE(is_closed(mesh)) << file;
    EXPECT_EQ(mesh.positions.size(), vertices) << file;
    EXPECT_NEAR(signed_volume(mesh), volume, 1e-4) << file;
    ASSERT_EQ(diagnostics.warnings().size(), 1u) << file;
    EXPECT_NE(diagnostics.warnings()[0].message.find("vertices on open borders welded to others, up to "), std::string::npos);
  }
}

TEST(Weld, ShadesSeamsSmoothly) {
  const Part p = shaken(soup_of(ball(16)), 1e-6);
  Diagnostics diagnostics;
  const SurfaceMesh mesh = make_surface_mesh(p.positions, p.triangles, {}, "test", diagnostics);
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (size_t k = 0; k < 3; ++k)
      EXPECT_GT(glm::dot(Vec3d(mesh.normals[t][k]), glm::normalize(mesh.positions[mesh.triangles[t][k]] + mesh.origin)), 0.999);
}

} // namespace
} // namespace kelpie
