// What `kelpie liquid` writes: at both ends the field is that of the mesh itself.
#include <cmath>
#include <numbers>

#include "base/file_bytes.h"
#include "renderer/program/evaluate.h"
#include "scene/reader.h"
#include "tests/support/program.h"
#include "tests/support/random_kind.h"

namespace kelpie {
namespace {

class LiquidEnds : public ProgramTest {
protected:
  LiquidEnds() {
    write("cube.off", "OFF\n8 6 0\n-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n"
                      "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 2 3 7 6\n4 1 2 6 5\n4 0 4 7 3\n");
    setenv("XDG_CACHE_HOME", path("cache").c_str(), 1);
  }

  Scene scene() const {
    Diagnostics diagnostics;
    return read_scene(path("flow.json"), {}, diagnostics);
  }

  /// The scene's only field at a frame.
  static FieldProgram field_at(const Scene& scene, double frame) {
    const FrameScene moment = sample(scene, frame);
    return compile(moment.shapes[0].field, moment.shapes[0].threshold);
  }
  FieldProgram field_at(double frame) const { return field_at(scene(), frame); }

  /// Two boxes that are long along x and along z.
  void write_bars() const {
    write("bar.off", "OFF\n8 6 0\n-3 -1 -1\n3 -1 -1\n3 1 -1\n-3 1 -1\n-3 -1 1\n3 -1 1\n3 1 1\n-3 1 1\n"
                     "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 2 3 7 6\n4 1 2 6 5\n4 0 4 7 3\n");
    write("across.off", "OFF\n8 6 0\n-1 -1 -3\n1 -1 -3\n1 1 -3\n-1 1 -3\n-1 -1 3\n1 -1 3\n1 1 3\n-1 1 3\n"
                        "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 2 3 7 6\n4 1 2 6 5\n4 0 4 7 3\n");
  }

  /// The most that two fields differ, at places all over the shot.
  static double most_difference(const FieldProgram& a, const FieldProgram& b) {
    Random r(2);
    double most = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3d p = r.in(Box3d{Vec3d(-1.5, -0.2, -1.5), Vec3d(1.5, 2.2, 1.5)});
      const Point3<double> q{p.x, p.y, p.z};
      most = std::max(most, std::abs(evaluate(a, a.code, q) - evaluate(b, b.code, q)));
    }
    return most;
  }

  /// Half the side of a cube that comes into one scene with one that is turned by 30 degrees: the box of that one has a diagonal of 3.
  static double half_side() { return 3 / std::hypot(2 * std::sqrt(2.0) * (std::cos(std::numbers::pi / 6) + 0.5), 2.0); }

  /// How many of some thousand places, none of them within `margin` of the surface, are on the wrong side of that of a cube which stands
  /// on the floor, turned about the vertical.
  static int wrong_places(const FieldProgram& field, double degrees, double margin) {
    const double half = half_side(), c = std::cos(glm::radians(degrees)), s = std::sin(glm::radians(degrees));
    Random r(1);
    int wrong = 0, judged = 0;
    for (int i = 0; i < 5000; ++i) {
      const Vec3d p = r.in(Box3d{Vec3d(-1.5, -0.2, -1.5), Vec3d(1.5, 2.2, 1.5)});
      const Vec3d q = glm::abs(Vec3d(c * p.x - s * p.z, p.y - half, s * p.x + c * p.z));
      const double outside = std::max({q.x, q.y, q.z}) - half;
      if (std::abs(outside) < margin) continue;
      ++judged;
      wrong += (evaluate(field, field.code, Point3<double>{p.x, p.y, p.z}) > field.threshold) != (outside < 0);
    }
    EXPECT_GT(judged, 4500);
    return wrong;
  }
};

TEST_F(LiquidEnds, AreTheMeshesInTheirPlaces) {
  ASSERT_EQ(shell("$KELPIE liquid cube.off cube.off --blobs 20 --turn 30 -f 1-96 --progress none --save-scene flow.json 2>/dev/null"), 0);
  const double voxel = 2 * half_side() / 192;
  EXPECT_EQ(wrong_places(field_at(1), 0, 2 * voxel), 0);
  EXPECT_EQ(wrong_places(field_at(96), 30, 2 * voxel), 0);
  EXPECT_GT(wrong_places(field_at(96), 0, 2 * voxel), 100);
  EXPECT_GT(wrong_places(field_at(30), 0, 2 * voxel), 20); // molten: twenty blobs are no cube
}

TEST_F(LiquidEnds, MayBeTheFits) {
  ASSERT_EQ(shell("$KELPIE liquid cube.off cube.off --ends fit --blobs 20 -f 1-96 --progress none --save-scene flow.json 2>/dev/null"), 0);
  EXPECT_FALSE(std::filesystem::exists(path("flow_from_mesh.off")));
  EXPECT_GT(wrong_places(field_at(1), 0, 0.02), 20);
}

// The ends are joined as the fits were.
TEST_F(LiquidEnds, AreWeldedAlike) {
  ASSERT_EQ(shell("$KELPIE liquid cube.off cube.off --weld 0.001 --blobs 20 --progress none --save-scene flow.json 2>/dev/null"), 0);
  const std::string scene = read_file_bytes(path("flow.json"));
  const std::string_view weld = "\"weld\": 0.001";
  const size_t first = scene.find(weld);
  ASSERT_NE(first, std::string::npos) << scene;
  EXPECT_NE(scene.find(weld, first + 1), std::string::npos);
}

TEST_F(LiquidEnds, OfWhichASpeckMakesADotAreTold) {
  write("speck.off", "OFF\n12 10 0\n-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n"
                     "50 0 0\n50.01 0 0\n50 0.01 0\n50 0 0.01\n"
                     "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 2 3 7 6\n4 1 2 6 5\n4 0 4 7 3\n3 8 10 9\n3 8 9 11\n3 8 11 10\n3 9 10 11\n");
  const Outcome dot = kelpie("liquid cube.off speck.off --blobs 20 --progress none --save-scene flow.json");
  EXPECT_EQ(dot.status, 0) << dot.err;
  EXPECT_NE(dot.err.find("warning: nearly all of the second mesh"), std::string::npos) << dot.err;
  EXPECT_EQ(dot.err.find("first mesh"), std::string::npos) << dot.err;
}

TEST_F(LiquidEnds, AreTurnedToLieInOneAnother) {
  write_bars();
  ASSERT_EQ(shell("$KELPIE liquid bar.off across.off --blobs 30 -f 1-96 --progress none --save-scene flow.json 2>/dev/null"), 0);
  const FieldProgram last = field_at(96);
  EXPECT_GT(evaluate(last, last.code, Point3<double>{1.2, 0.4, 0}), last.threshold); // along x, as the first one
  EXPECT_LT(evaluate(last, last.code, Point3<double>{0, 0.4, 1.2}), last.threshold);
  for (const char* turn : {"5x", "nan", "inf", "1e9"})
    EXPECT_EQ(shell(std::string("$KELPIE liquid bar.off bar.off --save-scene a.json 2>/dev/null --turn ") + turn), 2) << turn;
  EXPECT_FALSE(std::filesystem::exists(path("a.json")));
}

// Each has the same share of the time.
TEST_F(LiquidEnds, MayBeMany) {
  write_bars();
  ASSERT_EQ(shell("$KELPIE liquid bar.off cube.off across.off bar.off --turn 0 --blobs 30 -f 1-91 --progress none --save-scene flow.json "
                  "2>/dev/null"),
            0);
  EXPECT_TRUE(std::filesystem::exists(path("flow_4_mesh.off")));
  const Scene all = scene();
  const auto is_inside = [](const FieldProgram& field, const Vec3d& p) {
    return evaluate(field, field.code, Point3<double>{p.x, p.y, p.z}) > field.threshold;
  };
  const Vec3d along(1.2, 0.4, 0), beside(0, 0.4, 1.2);
  for (const auto& [frame, is_along, is_beside] :
       {std::tuple(1, true, false), std::tuple(31, false, false), std::tuple(61, false, true), std::tuple(91, true, false)}) {
    const FieldProgram field = field_at(all, frame);
    EXPECT_EQ(is_inside(field, along), is_along) << frame;
    EXPECT_EQ(is_inside(field, beside), is_beside) << frame;
    EXPECT_TRUE(is_inside(field, Vec3d(0, 0.4, 0)));
  }
  EXPECT_LT(most_difference(field_at(all, 1), field_at(all, 91)), 1e-5); // bar and bar, each for itself
}

// The frame after the last is the first, whatever a shutter sees on both sides of it.
TEST_F(LiquidEnds, CloseInALoop) {
  write_bars();
  for (const std::string ends : {"mesh", "fit"}) {
    ASSERT_EQ(shell("$KELPIE liquid bar.off cube.off across.off --loop --blobs 30 -f 1-60 --progress none --save-scene flow.json --ends " +
                    ends + " 2>/dev/null"),
              0);
    const Scene all = scene();
    EXPECT_EQ(all.frames.last, 60);
    for (const double frame : {0.75, 1.0, 1.25, 15.0, 44.0}) {
      EXPECT_LT(most_difference(field_at(all, frame), field_at(all, frame + 60)), 1e-5) << ends << " " << frame;
      EXPECT_LT(glm::distance(all.camera.position.at(frame), all.camera.position.at(frame + 60)), 1e-5f) << frame;
      EXPECT_LT(glm::distance(all.camera.look_at.at(frame), all.camera.look_at.at(frame + 60)), 1e-5f) << frame;
    }
    EXPECT_GT(most_difference(field_at(all, 1), field_at(all, 21)), 0.1);
    EXPECT_GT(glm::distance(all.camera.position.at(1), all.camera.position.at(31)), 0.5f);
    // Where nothing is held there is no jump either.
    ASSERT_EQ(shell("$KELPIE liquid bar.off cube.off across.off --loop --blobs 30 -f 1-6 --progress none --save-scene flow.json --ends " +
                    ends + " 2>/dev/null"),
              0);
    const Scene fast = scene();
    EXPECT_LT(most_difference(field_at(fast, 0.999), field_at(fast, 1.001)), 0.05) << ends;
    EXPECT_LT(most_difference(field_at(fast, 0.8), field_at(fast, 6.8)), 1e-4) << ends;
  }
}

TEST_F(LiquidEnds, AreWhatTheyShould) {
  write_bars();
  const auto expect = [&](const std::string& arguments, const std::string& error) {
    const Outcome o = kelpie("liquid " + arguments + " --save-scene a.json");
    EXPECT_EQ(o.status, 2) << arguments;
    EXPECT_NE(o.err.find(error), std::string::npos) << o.err;
  };
  expect("bar.off cube.off bar.off --to-up +z", "error: --from-up and --to-up are of two meshes, not of 3: say --up once for each");
  expect("bar.off cube.off --up +z --to-up +z", "error: --from-up and --to-up say what --up says: use one or the other");
  expect("bar.off cube.off bar.off --up +z --up +x", "error: --up: say it once for all, or once for each of the 3 meshes; found 2");
  expect("bar.off cube.off bar.off -f 1-2", "error: 3 meshes take at least 3 frames: -f says 1 to 2");
  expect("bar.off cube.off bar.off --loop -f 1-2", "error: 3 meshes in a loop take at least 3 frames: -f says 1 to 2");
  expect("bar.off", "MESH");
  EXPECT_FALSE(std::filesystem::exists(path("a.json")));
  // One says it for all.
  ASSERT_EQ(shell("$KELPIE liquid bar.off bar.off --turn 0 --up +x --blobs 20 --progress none --save-scene flow.json 2>/dev/null"), 0);
  const FieldProgram last = field_at(96);
  EXPECT_GT(evaluate(last, last.code, Point3<double>{0, 2, 0}), last.threshold);
  ASSERT_EQ(shell("$KELPIE liquid bar.off bar.off --turn 0 --up +y --up=-x --blobs 20 --progress none --save-scene flow.json 2>/dev/null"),
            0);
  const FieldProgram first = field_at(1);
  EXPECT_LT(evaluate(first, first.code, Point3<double>{0, 2, 0}), first.threshold);
}

TEST_F(LiquidEnds, MayBeShapesOfScenes) {
  write("shapes.json", R"({ "kelpie": 1, "frames": { "first": 3, "last": 4, "fps": 24 }, "shapes": [
  { "name": "box", "field": { "kind": "sdf_box", "centre": [0, 0, 0], "size": [2, 2, 2], "radius": 0.5 } },
  { "name": "ball", "field": { "kind": "point", "centre": { "keys": [[3, [0, 0, 0]], [4, [9, 0, 0]]] }, "radius": 1 } },
  { "name": "nothing", "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 0.5 } },
  { "name": "floor", "geometry": { "kind": "plane" } } ] })");
  const Outcome fit = kelpie("fit shapes.json:ball -o ball.ply --blobs 8");
  EXPECT_EQ(fit.status, 0) << fit.err;
  EXPECT_NE(fit.err.find("shapes.json:ball: meshed with "), std::string::npos) << fit.err;
  EXPECT_NE(fit.err.find(" blobs, off by"), std::string::npos) << fit.err;
  ASSERT_EQ(shell("$KELPIE liquid shapes.json:box shapes.json:ball --turn 0 --blobs 20 --progress none --save-scene flow.json 2>/dev/null"),
            0);
  EXPECT_TRUE(std::filesystem::exists(path("flow_from_mesh.ply")));
  const auto refusal = [&](const std::string& shape, int status) {
    const Outcome o = kelpie("fit " + shape + " -o none.ply");
    EXPECT_EQ(o.status, status) << shape;
    return o.err;
  };
  EXPECT_EQ(refusal("shapes.json:bal", 2), "error: shapes.json: no shape is called \"bal\" (did you mean \"ball\"?)\n");
  EXPECT_EQ(refusal("shapes.json:floor", 2),
            "error: shapes.json: \"floor\" is ordinary geometry: of all shapes only box, ball, nothing have a field\n");
  EXPECT_EQ(refusal("shapes.json", 2), "error: which shape of shapes.json? shapes.json:SHAPE, one of box, ball, nothing\n");
  const std::string empty = refusal("shapes.json:nothing", 65);
  EXPECT_NE(empty.find("error: shapes.json: \"nothing\" has no surface in frame 3\n"), std::string::npos) << empty;
  EXPECT_NE(refusal("none.json:ball", 66).find("none.json"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(path("none.ply")));
}

} // namespace
} // namespace kelpie
