// What a scene says in place of numbers that it could say: where a surface lies, what is mirrored, what else is to be known.
#include <fmt/format.h>

#include "renderer/program/evaluate.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

/// The field of the only shape of a scene, compiled for a frame.
FieldProgram program_of(const Scene& scene, double frame) {
  const SampledShape shape = sample(scene, frame).shapes[0];
  return compile(shape.field, shape.threshold);
}
double value_at(const FieldProgram& program, double x, double y, double z) {
  return evaluate(program, program.code, Point3<double>{x, y, z});
}

std::string shape_of(const std::string& field, const std::string& rest = "") {
  return R"({"kelpie":1,"frames":{"first":1,"last":9},"shapes":[{"name":"a",)" + rest + "\"field\":\n" + field + "}]}";
}

TEST(SurfaceRadius, IsHowFarTheSurfaceOfALoneSkeletonLies) {
  const SceneFolder folder;
  struct Case {
    std::string_view skeleton;
    Vec3d on_surface; ///< 0.3 from it
  };
  for (const Case& c :
       {Case{R"("kind":"point","centre":[0,0,0])", {0, 0.3, 0}}, Case{R"("kind":"segment","from":[0,0,0],"to":[1,0,0])", {0.5, 0.3, 0}},
        Case{R"("kind":"box","centre":[0,0,0],"size":2)", {0.2, 1.3, 0.1}},
        Case{R"("kind":"generalized_cylinder","points":[[0,0,0],[1,0,0]],"radii":0.1)", {0.5, 0.4, 0}}})
    for (const auto& [falloff, value] : EnumNames<Falloff>::values)
      for (const double threshold : {0.2, 1.0, 1.9}) {
        const std::string field = fmt::format(R"({{{},"surface_radius":0.3,"weight":2,"falloff":"{}"}})", c.skeleton, falloff);
        const FieldProgram program = program_of(folder.read(shape_of(field, fmt::format("\"threshold\":{},", threshold))), 1);
        EXPECT_NEAR(value_at(program, c.on_surface.x, c.on_surface.y, c.on_surface.z), threshold, 1e-5) << field;
      }
}

TEST(SurfaceRadius, FollowsCurves) {
  const SceneFolder folder;
  const Scene scene = folder.read(shape_of(R"({"kind":"point","centre":[0,0,0],"surface_radius":{"keys":[[1,0.2],[9,1]]},
    "weight":{"keys":[[1,2],[9,3]]}})"));
  EXPECT_NEAR(value_at(program_of(scene, 1), 0.2, 0, 0), 1, 1e-5);
  EXPECT_NEAR(value_at(program_of(scene, 5), 0.6, 0, 0), 1, 1e-5);
  EXPECT_NEAR(value_at(program_of(scene, 9), 1, 0, 0), 1, 1e-5);
}

TEST(SurfaceRadius, IsRefusedWhereThereIsNoSurface) {
  const SceneFolder folder;
  const auto errors = [&](const std::string& weight, const std::string& rest = "") {
    return folder.errors(shape_of(R"({"kind":"point","centre":[0,0,0],"surface_radius":1,"weight":)" + weight + "}", rest));
  };
  const auto said = [](std::string_view frame, std::string_view weight, std::string_view threshold) {
    return fmt::format(
        "scene.json:2:1: surface_radius: the weight must be above the threshold; at frame {} this point has {}, and shape \"a\" "
        "has {}",
        frame, weight, threshold);
  };
  EXPECT_EQ(errors("1.001"), "");
  EXPECT_EQ(errors("1"), said("1", "1", "1"));
  EXPECT_EQ(errors("-2"), said("1", "-2", "1"));
  EXPECT_EQ(errors("2", "\"threshold\":3,"), said("1", "2", "3"));
  EXPECT_EQ(errors(R"({"keys":[[1,2],[4,0.5],[9,2]]})"), said("4", "0.5", "1"));
  EXPECT_EQ(errors("2", R"("threshold":{"keys":[[1,1],[7,2]]},)"), said("7", "2", "2"));
  EXPECT_EQ(folder.errors(shape_of(R"({"kind":"point","centre":[0,0,0],"surface_radius":1,"radius":1})")),
            "scene.json:2:53: \"radius\" and \"surface_radius\" exclude each other");
}

TEST(Mirrors, ShowWhatLiesAtTheOtherSide) {
  const SceneFolder folder;
  const std::string child = R"({"kind":"cone_sphere","from":[0.2,0,0],"to":[1,0.5,0.1],"from_radius":0.3,"to_radius":0.1,"radius":1})";
  const FieldProgram plain = program_of(folder.read(shape_of(child)), 1);
  const FieldProgram scaled = program_of(folder.read(shape_of(R"({"kind":"scale","by":[-1,1,1],"child":)" + child + "}")), 1);
  const std::string scene =
      R"({"kelpie":1,"parts":{"p":)" + child + R"(},"shapes":[{"name":"a","field":{"kind":"instance","of":"p","scale":[2,2,-2]}}]})";
  const FieldProgram placed = program_of(folder.read(scene), 1);
  const Vec3d p(0.7, 0.9, 0.3);
  const double value = value_at(plain, p.x, p.y, p.z);
  ASSERT_GT(value, 0.1);
  EXPECT_NEAR(value_at(scaled, -p.x, p.y, p.z), value, 1e-6);
  EXPECT_NEAR(value_at(placed, 2 * p.x, 2 * p.y, -2 * p.z), value, 1e-6);
}

TEST(Mirrors, DoNotTurnWhileTheyMove) {
  const SceneFolder folder;
  const auto errors = [&](const std::string& by) {
    return folder.errors(shape_of("{\"kind\":\"scale\",\"by\":" + by + R"(,"child":{"kind":"point","centre":[0,0,0],"radius":1}})"));
  };
  EXPECT_EQ(errors(R"({"keys":[[1,-1],[5,-2]]})"), "");
  EXPECT_EQ(errors(R"({"keys":[[1,1],[5,-1]],"interpolation":"step"})"), "");
  EXPECT_NE(errors(R"({"keys":[[1,[1,1,1]],[5,[1,-1,1]]]})").find("by must be other than 0: the curve leaves that between its keys"),
            std::string::npos);
  EXPECT_EQ(errors("[1,0,1]"), "scene.json:2:25: by must be other than 0, found 0");
}

TEST(Meta, IsAnyObject) {
  const SceneFolder folder;
  const auto scene = [](const std::string& meta) {
    return "{\"kelpie\":1,\n\"meta\":" + meta + R"(,"shapes":[{"name":"a","field":{"kind":"point","centre":[0,0,0],"radius":1}}]})";
  };
  EXPECT_EQ(folder.read(scene(R"({ "shot": "a\"7\n", "take": [3, true, null], "by": { "x": 0.5 } })")).meta.text,
            R"({"by":{"x":0.5},"shot":"a\"7\u000a","take":[3,true,null]})");
  EXPECT_EQ(folder.read(scene("{}")).meta.text, "{}");
  EXPECT_EQ(folder.errors(scene("3")), "scene.json:2:8: meta: expected an object, found a number");
}

} // namespace
} // namespace kelpie
