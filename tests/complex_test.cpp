// Complex primitives: what they become is the solid that they are said to be, within their detail.
#include <gtest/gtest.h>

#include "renderer/program/evaluate.h"
#include "renderer/program/expand.h"
#include "scene/scene.h"
#include "tests/support/random_scene.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

using Tube = GeneralizedCylinder<SampledMode>;
using Turned = Revolution<SampledMode>;

/// From the potential (weight 1, quartic) of a union of pieces to the distance from the solid; the radius where it is 0.
double distance_of(double potential, double radius) { return radius * std::sqrt(std::max(0.0, 1 - std::sqrt(potential))); }

/// The potential of a primitive's pieces.
template <class Kind>
double potential_of_pieces(const Kind& kind, Vec3d p) {
  if constexpr (requires { kind.parent_from_pieces(); }) p = inverse(kind.parent_from_pieces())(p);
  double most = 0;
  kind.for_each_piece(kind.divisions(), [&](const auto& piece) { most = std::max(most, potential(piece, Point3<double>{p.x, p.y, p.z})); });
  return most;
}

template <class Kind>
size_t piece_count(const Kind& kind) {
  size_t n = 0;
  kind.for_each_piece(kind.divisions(), [&](const auto&) { ++n; });
  return n;
}

/// Points of a curve with widths, close together.
std::vector<WidePoint> fine_curve(SplineKind kind, const std::vector<WidePoint>& points) {
  const auto spline = Spline<WidePoint>::make(kind, points);
  std::vector<WidePoint> fine;
  constexpr int k_count = 4000;
  for (int i = 0; i <= k_count; ++i) fine.push_back(spline(double(i) / k_count));
  return fine;
}

Tube random_tube(Random& r) {
  Tube tube = random_kind<GeneralizedCylinder>(r);
  tube.points.resize(2 + r.below(5), Vec3(0.3f));
  for (Vec3& p : tube.points) p = random_point(r);
  tube.radii.resize(tube.points.size());
  for (float& x : tube.radii) x = float(r.uniform(0, 0.4));
  tube.detail = float(r.log_uniform(1e-3, 0.05)), tube.radius = 4, tube.weight = 1, tube.falloff = Falloff::quartic;
  return tube;
}

// No crack, no bulge: anywhere the distance is that from the exact solid, within the detail.
TEST(GeneralizedCylinder, IsABallOnItsWayAlongTheCurve) {
  for (unsigned trial = 0; trial < 60 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    const Tube tube = random_tube(r);
    std::vector<WidePoint> points;
    for (size_t i = 0; i < tube.points.size(); ++i) points.emplace_back(Vec3d(tube.points[i]), tube.radii[i]);
    const std::vector<WidePoint> fine = fine_curve(tube.curve, points);
    for (int i = 0; i < 40; ++i) {
      const Vec3d p = r.in(Box3d{Vec3d(-1.5), Vec3d(1.5)});
      double exact = 1e9;
      for (const WidePoint& c : fine) exact = std::min(exact, glm::distance(p, Vec3d(c)) - std::max(0.0, c.w));
      EXPECT_NEAR(distance_of(potential_of_pieces(tube, p), tube.radius), std::max(0.0, exact), tube.detail * 1.02 + 1e-4);
    }
  }
}

TEST(Revolution, IsADiscThatIsTurnedAboutTheAxis) {
  for (unsigned trial = 0; trial < 60 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    Turned turned = random_kind<Revolution>(r);
    turned.profile.resize(2 + r.below(5));
    std::vector<WidePoint> points;
    for (Vec3& p : turned.profile) {
      // Level parts and points on the axis are what vases are made of.
      p = Vec3(r.below(5) ? r.uniform(0, 1) : 0, r.below(4) ? r.uniform(-1, 1) : 0.5, r.uniform(0, 0.4));
      points.emplace_back(p.x, p.y, 0, 0.5 * p.z);
    }
    turned.detail = float(r.log_uniform(1e-3, 0.05)), turned.radius = 4, turned.weight = 1, turned.falloff = Falloff::quartic;
    const std::vector<WidePoint> fine = fine_curve(turned.curve, points);
    const Vec3d centre(turned.centre), e = glm::normalize(Vec3d(turned.axis));
    for (int i = 0; i < 40; ++i) {
      const Vec3d p = r.in(Box3d{centre - 1.5, centre + 1.5});
      const double height = glm::dot(p - centre, e);
      const Vec2d q(glm::length(p - centre - e * height), height);
      double exact = 1e9;
      for (const WidePoint& c : fine) exact = std::min(exact, glm::distance(q, Vec2d(std::max(0.0, c.x), c.y)) - std::max(0.0, c.w));
      EXPECT_NEAR(distance_of(potential_of_pieces(turned, p), turned.radius), std::max(0.0, exact), turned.detail * 1.02 + 1e-4);
    }
  }
}

/// Gently curved, and neither flat nor even.
Patch<SampledMode> wavy_patch(Random& r) {
  Patch<SampledMode> patch;
  for (int i = 0; i < 16; ++i) {
    patch.points.emplace_back(i % 4, r.uniform(-0.5, 0.5), i / 4);
    patch.thickness.push_back(float(r.uniform(0.05, 0.3)));
  }
  patch.detail = 0.003f, patch.radius = 3, patch.weight = 1, patch.falloff = Falloff::quartic;
  return patch;
}

TEST(Patch, WithoutThicknessIsTheSurface) {
  for (unsigned trial = 0; trial < 10 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    Patch<SampledMode> patch = wavy_patch(r);
    std::array<glm::dvec4, 16> control;
    for (size_t i = 0; i < 16; ++i) control[i] = glm::dvec4(Vec3d(patch.points[i]), 0);
    const BezierPatch exact_patch{control};
    patch.thickness.clear(), patch.detail = 0.02f;
    for (int i = 0; i < 5; ++i) {
      const Vec3d p = r.in(Box3d{Vec3d(-0.5, -1, -0.5), Vec3d(3.5, 1, 3.5)});
      double exact = 1e9;
      for (int j = 0; j <= 200; ++j)
        for (int k = 0; k <= 200; ++k) exact = std::min(exact, glm::distance(p, exact_patch.at(j / 200.0, k / 200.0).at));
      EXPECT_NEAR(distance_of(potential_of_pieces(patch, p), patch.radius), exact, patch.detail + 0.01);
    }
  }
}

// Across the surface, in the middle of faces, at their borders and past them.
TEST(Patch, IsAsThickAsItIsSaidToBe) {
  for (unsigned trial = 0; trial < 10 && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    const Patch<SampledMode> patch = wavy_patch(r);
    std::array<glm::dvec4, 16> control;
    for (size_t i = 0; i < 16; ++i) control[i] = glm::dvec4(Vec3d(patch.points[i]), 0.5 * double(patch.thickness[i]));
    const BezierPatch exact{control};
    for (int i = 0; i < 10; ++i) {
      const SurfacePoint s = exact.at(r.uniform(0.1, 0.9), r.uniform(0.1, 0.9));
      EXPECT_EQ(potential_of_pieces(patch, s.at + s.normal * (s.half - 0.01)), 1);
      EXPECT_EQ(potential_of_pieces(patch, s.at - s.normal * (s.half - 0.01)), 1);
      // The faces on both sides slant by as much as the thickness changes: the distance is a little less than along the normal.
      const double beyond = distance_of(potential_of_pieces(patch, s.at + s.normal * (s.half + 0.1)), patch.radius);
      EXPECT_LT(beyond, 0.1 + 0.006);
      EXPECT_GT(beyond, 0.1 * 0.97 - 0.006);
      const SurfacePoint edge = exact.at(0, r.uniform(0, 1));
      const Vec3d inward = glm::normalize(exact.at(0.01, 0.5).at - exact.at(0, 0.5).at);
      EXPECT_EQ(potential_of_pieces(patch, edge.at - inward * (edge.half - 0.02)), 1) << "the border is round";
    }
  }
}

/// Two patches side by side, the second of them higher by `step` on its far side.
Patch<SampledMode> two_patches(float step) {
  Patch<SampledMode> patch;
  for (int p = 0; p < 2; ++p)
    for (int i = 0; i < 16; ++i) patch.points.emplace_back(3 * p + i % 4, p * (i % 4) * step, i / 4);
  patch.thickness = {0.2f};
  return patch;
}

TEST(Patch, IsRoundAtBordersAndCreasesOnly) {
  const auto borders = [](const Patch<SampledMode>& patch) {
    int n = 0;
    patch.for_each_piece(patch.divisions(), [&]<class Piece>(const Piece&) { n += std::is_same_v<Piece, ConeSphere<SampledMode>>; });
    return n;
  };
  EXPECT_EQ(borders(two_patches(0)), 6);
  EXPECT_EQ(borders(two_patches(0.5f)), 8);
}

TEST(Detail, LessOfItNeedsFewerPieces) {
  Random r(1);
  Tube tube = random_tube(r);
  tube.curve = SplineKind::b_spline;
  size_t last = 1u << 20;
  for (const double detail : {1e-4, 1e-3, 1e-2, 0.1, 10.0}) {
    tube.detail = float(detail);
    const size_t count = piece_count(tube);
    EXPECT_LT(count, last);
    last = count;
  }
  EXPECT_EQ(last, size_t(std::max(1, int(tube.points.size()) - 3))); // a piece for each polynomial
  for (Vec3& p : tube.points) p.y = p.z = 0;                         // straight
  for (size_t i = 0; i < tube.points.size(); ++i) tube.points[i].x = float(i), tube.radii[i] = 0.5f;
  tube.detail = 1e-6f, tube.curve = SplineKind::catmull_rom;
  EXPECT_EQ(piece_count(tube), tube.points.size() - 1);
}

TEST(Detail, BecomesTheSimplestSkeletonThatServes) {
  Tube tube;
  tube.points = {Vec3(0), Vec3(1, 0, 0), Vec3(1, 1, 0)};
  int segments = 0, cone_spheres = 0;
  const auto count = [&]<class Piece>(const Piece&) {
    segments += std::is_same_v<Piece, Segment<SampledMode>>, cone_spheres += std::is_same_v<Piece, ConeSphere<SampledMode>>;
  };
  tube.for_each_piece(tube.divisions(), count);
  EXPECT_GT(segments, 2);
  EXPECT_EQ(cone_spheres, 0);
  tube.radii = {0, 0, 0.1f};
  segments = 0;
  tube.for_each_piece(tube.divisions(), count);
  EXPECT_EQ(segments, 0);
  EXPECT_GT(cone_spheres, 2);
}

/// The pieces of the only shape of a scene, at a frame.
size_t pieces_of_scene(const Scene& scene, double frame = 1) {
  std::vector<SampledField> moments{sample(scene, frame).shapes[0].field};
  expand(moments);
  return moments[0].piece_count;
}

constexpr const char* k_vine = R"({ "kind": "generalized_cylinder", "radius": 0.1, "radii": 0.05,
  "points": [[-1, 0, 0], [0, 1, 0], [1, 0, 0], [2, 1, 0]], "detail_pixels": 0.5 })";

TEST(Detail, InPixelsIsThatOfTheCamera) {
  const SceneFolder folder;
  const std::string text = scene_with_field(k_vine);
  const auto pieces = [&](std::vector<std::string> set) { return pieces_of_scene(folder.read(text, {set, {}})); };
  const size_t usual = pieces({});
  EXPECT_GT(pieces({"film.resolution=[2560,1440]"}), usual);
  EXPECT_GT(pieces({"camera.fov=10"}), usual);
  EXPECT_LT(pieces({"camera.position=[0,0,90]"}), usual);
  EXPECT_LT(pieces({"shapes.a.field.detail_pixels=5"}), usual);
}

// What is larger and as much farther away looks the same.
TEST(Detail, InPixelsGoesThroughWarps) {
  const SceneFolder folder;
  const auto pieces = [&](const std::string& field, const std::string& camera) {
    return pieces_of_scene(folder.read(scene_with_field(field), {{"camera.position=" + camera}, {}}));
  };
  const std::string below = std::string(R"({ "kind": "rotate", "axis": [1, 2, 3], "angle": 50, "child": )") + k_vine + "}";
  const size_t near = pieces(below, "[3,4,20]");
  EXPECT_EQ(pieces(R"({ "kind": "scale", "by": 10, "child": )" + below + "}", "[30,40,200]"), near);
  EXPECT_EQ(pieces(R"({ "kind": "translate", "by": [1, 2, 3], "child": )" + below + "}", "[4,6,23]"), near);
  EXPECT_LT(pieces(below, "[30,40,200]"), near);
}

/// A scene of a subdivision surface of radius 1 and weight 1.
FieldProgram subdivided(const SceneFolder& folder, const std::string& more) {
  const Scene scene =
      folder.read(scene_with_field(R"({ "kind": "subdivision", "radius": 1, "weight": 1, "falloff": "quartic", )" + more + " }"));
  const SampledShape shape = sample(scene, 1).shapes[0];
  return compile(shape.field, shape.threshold);
}
double distance_at(const FieldProgram& program, const Vec3d& p) {
  return distance_of(evaluate(program, program.code, Point3<double>{p.x, p.y, p.z}), 1);
}

TEST(Subdivision, OfAFlatSquareIsASlabWithRoundBorders) {
  const SceneFolder folder;
  folder.write("square.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\n");
  const FieldProgram slab = subdivided(folder, R"("file": "square.obj", "thickness": 0.2, "detail": 0.01)");
  EXPECT_EQ(slab.element_count(), 4u + 8u); // one level does: faces, and edges of the border
  EXPECT_EQ(distance_at(slab, {0.3, 0.09, 0.6}), 0);
  EXPECT_NEAR(distance_at(slab, {0.3, 0.3, 0.6}), 0.2, 1e-6);
  EXPECT_NEAR(distance_at(slab, {-0.3, 0, 0.6}), 0.2, 1e-6);
  EXPECT_NEAR(distance_at(slab, {-0.3, 0.4, 0.6}), 0.5 - 0.1, 1e-6);
  const FieldProgram thin = subdivided(folder, R"("file": "square.obj", "detail": 0.01)");
  EXPECT_NEAR(distance_at(thin, {0.3, 0.3, 0.6}), 0.3, 1e-6);
  folder.write("wedge.ply", "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                            "property float thickness\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                            "0 0 0 0\n1 0 0 1\n1 0 1 1\n0 0 1 0\n4 0 1 2 3\n");
  const FieldProgram wedge = subdivided(folder, R"("file": "wedge.ply", "thickness": 0.2, "detail": 0.01)");
  EXPECT_NEAR(distance_at(wedge, {0, 0.3, 0.5}), 0.3, 0.02);
  EXPECT_NEAR(distance_at(wedge, {1, 0.3, 0.5}), 0.2, 0.02);
}

// Against the limit itself, as the finest level has it.
TEST(Subdivision, IsWithinItsDetail) {
  const SceneFolder folder;
  folder.write("cube.obj", "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
                           "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n");
  Diagnostics diagnostics;
  const SubdivisionMesh exact = load_subdivision_mesh(folder.path("cube.obj"), 6, diagnostics);
  ASSERT_EQ(exact.levels.size(), 6u);
  EXPECT_TRUE(exact.levels[5].borders.empty());
  size_t last = 0;
  for (const double detail : {0.2, 0.05, 0.01, 0.002}) {
    const FieldProgram program = subdivided(folder, fmt::format(R"("file": "cube.obj", "levels": 6, "detail": {})", detail));
    EXPECT_GT(program.element_count(), last);
    last = program.element_count();
    for (size_t i = 0; i < exact.levels[5].positions.size(); i += 97)
      EXPECT_LT(distance_at(program, Vec3d(exact.levels[5].positions[i])), 1.1 * detail + 1e-3);
  }
}

// Moments of one field get the same pieces, as fine as the finest wants.
TEST(Expand, MakesOneStructureOfAllMoments) {
  Tube straight, curved;
  straight.points = {Vec3(0), Vec3(0, 1, 0), Vec3(0, 2, 0)}, curved.points = {Vec3(0), Vec3(1, 1, 0), Vec3(0, 2, 0)};
  curved.radii = {0.1f};
  straight.detail = curved.detail = 0.01f;
  std::vector<SampledField> fields(2);
  fields[0].nodes.emplace_back(straight), fields[1].nodes.emplace_back(curved);
  EXPECT_LT(piece_count(straight), piece_count(curved));
  const std::vector<double> thresholds{0.5, 0.5};
  const std::vector<FieldProgram> programs = compile(fields, thresholds);
  ASSERT_EQ(programs[0].field.nodes.size(), programs[1].field.nodes.size());
  for (size_t i = 0; i < programs[0].field.nodes.size(); ++i)
    EXPECT_EQ(programs[0].field.nodes[i].index(), programs[1].field.nodes[i].index());
  EXPECT_EQ(programs[0].element_count(), piece_count(curved));
  EXPECT_TRUE(is_equal(programs[0].field, fields[0])); // so that cells are kept from frame to frame
  EXPECT_FALSE(is_equal(programs[0].field, fields[1]));
  for (const double x : {-0.3, 0.0, 0.4})
    EXPECT_NEAR(evaluate(programs[0], programs[0].code, Point3<double>{x, 1, 0.2}), potential_of_pieces(straight, {x, 1, 0.2}), 1e-6);
}

// Below a blend a union of many pieces leaves nothing of those that do not reach a cell.
TEST(Expand, CellsHoldTheirOwnPiecesOnly) {
  Tube tube;
  for (int i = 0; i < 40; ++i) tube.points.emplace_back(std::cos(0.5 * i), 0.1 * i, std::sin(0.5 * i));
  tube.radii = {0.05f}, tube.radius = 0.1f, tube.weight = 2, tube.detail = 1e-3f;
  SampledField field;
  Blend<SampledMode> blend;
  blend.children = {add(field, tube), add(field, Point<SampledMode>{})};
  add(field, blend);
  const ShapeCells cells = build_cells(compile(field, 1), {});
  ASSERT_GT(cells.program.element_count(), 300u);
  EXPECT_GT(cells.cells.size(), 100u);
  for (const Cell& cell : cells.cells) EXPECT_LE(cell.tree ? cell.tree->leaf_count : 0u, 32u);
}

} // namespace
} // namespace kelpie
