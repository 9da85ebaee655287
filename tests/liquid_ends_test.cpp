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

  /// The scene's only field at a frame.
  FieldProgram field_at(double frame) const {
    Diagnostics diagnostics;
    const Scene scene = read_scene(path("flow.json"), {}, diagnostics);
    const FrameScene moment = sample(scene, frame);
    return compile(moment.shapes[0].field, moment.shapes[0].threshold);
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
  write("bar.off", "OFF\n8 6 0\n-3 -1 -1\n3 -1 -1\n3 1 -1\n-3 1 -1\n-3 -1 1\n3 -1 1\n3 1 1\n-3 1 1\n"
                   "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 2 3 7 6\n4 1 2 6 5\n4 0 4 7 3\n");
  write("across.off", "OFF\n8 6 0\n-1 -1 -3\n1 -1 -3\n1 1 -3\n-1 1 -3\n-1 -1 3\n1 -1 3\n1 1 3\n-1 1 3\n"
                      "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 2 3 7 6\n4 1 2 6 5\n4 0 4 7 3\n");
  ASSERT_EQ(shell("$KELPIE liquid bar.off across.off --blobs 30 -f 1-96 --progress none --save-scene flow.json 2>/dev/null"), 0);
  const FieldProgram last = field_at(96);
  EXPECT_GT(evaluate(last, last.code, Point3<double>{1.2, 0.4, 0}), last.threshold); // along x, as the first one
  EXPECT_LT(evaluate(last, last.code, Point3<double>{0, 0.4, 1.2}), last.threshold);
  for (const char* turn : {"5x", "nan", "inf", "1e9"})
    EXPECT_EQ(shell(std::string("$KELPIE liquid bar.off bar.off --save-scene a.json 2>/dev/null --turn ") + turn), 2) << turn;
  EXPECT_FALSE(std::filesystem::exists(path("a.json")));
}

} // namespace
} // namespace kelpie
