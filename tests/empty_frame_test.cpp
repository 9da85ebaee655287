// What is said of frames that show nothing, are black or coarse; and that nothing is said of others.
#include <fmt/format.h>

#include "renderer/render_frame.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

constexpr std::string_view k_ball = R"({ "name": "ball", "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 2 } })";
constexpr std::string_view k_floor = R"({ "name": "floor", "geometry": { "kind": "plane", "position": [0, -1, 0] } })";
constexpr std::string_view k_mesh = R"({ "name": "mesh", "geometry": { "kind": "mesh", "file": "mesh.obj", "position": [0, 0, 20] } })";

class EmptyFrames : public testing::Test {
protected:
  /// What is said of a small picture of these shapes, seen from `eye_` towards `look_at` unless `more` says otherwise.
  std::string warning(std::string_view shapes, std::string_view look_at, std::string_view more = "") const {
    const Scene scene = folder_.read(fmt::format(R"({{ "kelpie": 1, "camera": {{ "position": {}, "look_at": {} }},
      "film": {{ "resolution": [32, 18], "spp": 4, "bounces": 2 }}, {} "shapes": [ {} ] }})",
                                                 eye_, look_at, more, shapes));
    EnvironmentCache environments;
    Diagnostics diagnostics;
    const std::function<void(double)> silent = [](double) {};
    render_frame(scene, 1, {0, 0, 32, 18}, {environments, diagnostics, silent});
    EXPECT_LE(diagnostics.warnings().size(), 1u);
    return diagnostics.warnings().empty() ? "" : to_string(diagnostics.warnings()[0]);
  }
  std::string warning_of_lights(std::string_view lights, std::string_view shapes = k_ball) const {
    return warning(shapes, "[0, 0, 0]", fmt::format("\"lights\": [ {} ],", lights));
  }

  SceneFolder folder_;
  std::string eye_ = "[0, 0, 6]";
};

TEST_F(EmptyFrames, SayWhereEverythingIs) {
  const auto both = [](std::string_view a, std::string_view b) { return fmt::format("{}, {}", a, b); };
  EXPECT_EQ(warning(k_ball, "[0, 0, 0]"), "");
  EXPECT_EQ(warning(both(k_ball, k_floor), "[0, 0, 0]"), "");
  EXPECT_EQ(warning(k_floor, "[0, 0, 0]"), "");
  EXPECT_EQ(warning(k_ball, "[0, 0, 9]"), "frame 1 shows nothing: all shapes lie behind the camera");
  EXPECT_EQ(warning(k_ball, "[9, 0, 0]"), "frame 1 shows nothing: all shapes lie outside the picture");
  EXPECT_EQ(warning(k_mesh, "[0, 0, 0]"), "frame 1 shows nothing: all shapes lie behind the camera");
  EXPECT_EQ(warning(k_mesh, "[0, 0, 9]"), "");
  EXPECT_EQ(warning(both(k_ball, k_floor), "[0, 9, 9]"), "frame 1 shows nothing: all shapes but planes lie behind the camera");
  EXPECT_EQ(warning(k_floor, "[0, 9, 0]"), "frame 1 shows nothing: its planes lie outside the picture");
  EXPECT_EQ(warning(R"({ "name": "weak", "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 0.5 } })", "[0, 0, 0]"),
            "frame 1 shows nothing: no shape has a surface");
}

TEST_F(EmptyFrames, SayHowSmallEverythingIs) {
  const auto point_at = [](const char* centre) {
    return fmt::format(R"({{ "name": "far", "field": {{ "kind": "point", "centre": {}, "radius": 1, "weight": 2 }} }})", centre);
  };
  for (const char* centre : {"[0, 3, -999]", "[0, 1, -1e15]"})
    EXPECT_EQ(warning(point_at(centre), "[0, 0, 0]"), "frame 1 shows nothing: all shapes together are smaller than a pixel");
}

TEST_F(EmptyFrames, SayWhyNoLightComes) {
  const std::string_view off = R"({ "kind": "sun", "strength": 0 }, { "kind": "environment", "preset": "white", "strength": 0 })";
  EXPECT_EQ(warning_of_lights(R"({ "kind": "sun" })"), "");
  EXPECT_EQ(warning_of_lights(off), "frame 1 is black: all lights are off (their \"strength\" is 0, or they are black)");
  EXPECT_EQ(warning_of_lights(R"({ "kind": "sun", "colour": [0, 0, 0] })"),
            "frame 1 is black: all lights are off (their \"strength\" is 0, or they are black)");
  EXPECT_EQ(warning_of_lights(R"({ "kind": "sun", "direction": [0, -1, 0] })", k_floor),
            "frame 1 is black: no light reaches what is in view");
  EXPECT_EQ(warning_of_lights(R"({ "kind": "environment", "preset": "white" })",
                              R"({ "name": "b", "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 2 },
                                   "surface": { "kind": "matte", "colour": [0, 0, 0] } })"),
            "frame 1 is black: all surfaces in view are black");
}

// Float places are 0.06 apart a million units from the origin.
TEST_F(EmptyFrames, SayWhereFloatNumbersAreTooCoarse) {
  const auto said_at = [&](int x) {
    eye_ = fmt::format("[{}, 0, 6]", x);
    return warning(fmt::format(R"({{ "name": "ball", "field": {{ "kind": "point", "centre": [{}, 0, 0], "radius": 1 }} }})", x),
                   fmt::format("[{}, 0, 0]", x));
  };
  EXPECT_EQ(said_at(500), "");
  EXPECT_EQ(said_at(1000000).find("frame 1 is coarse: its shapes lie so far from the origin, around (1e+06, "), 0u) << said_at(1000000);
}

} // namespace
} // namespace kelpie
