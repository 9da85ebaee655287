// What the program says to wrong input: one line a problem, with its position where the fault lies in text,
// the documented exit status, and nothing under the final name.
#include <algorithm>

#include "tests/support/program.h"

namespace kelpie {
namespace {

constexpr const char* k_good = R"({ "kelpie": 1, "film": { "resolution": [16, 16], "spp": 1 },
  "shapes": [ { "name": "ball", "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 2 } } ] })";

/// A tetrahedron, its faces outward.
constexpr const char* k_tetrahedron = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

class WrongInput : public ProgramTest {
protected:
  /// Runs with `arguments`; expects this status, exactly this on stderr, and no file besides those there were.
  void expect(const std::string& arguments, int status, const std::string& err) {
    const size_t files = file_count();
    const Outcome o = kelpie(arguments);
    EXPECT_EQ(o.status, status) << arguments << "\n" << o.err;
    EXPECT_EQ(o.err, err) << arguments;
    EXPECT_EQ(o.out, "") << arguments;
    EXPECT_EQ(file_count(), files) << arguments << " left something";
  }
  /// The same of a scene that is wrong.
  void expect_scene(const std::string& scene, int status, const std::string& err) {
    write("scene.json", scene);
    expect("render scene.json -o 'a.####.exr'", status, err);
    expect("check scene.json", status, err);
  }
};

TEST_F(WrongInput, Scenes) {
  expect_scene(R"({ "kelpie": 1, "shapes": [] })", 65, "error: scene.json:1:26: shapes may not be empty\n");
  expect_scene(R"({ "kelpie": 1, "shapes": [ { "name": "a", "field": { "kind": "blobs", "file": "none.ply" } } ] })", 66,
               "error: scene.json:1:79: file: \"none.ply\" does not exist (" + path("none.ply") + ")\n");
  const auto field = [](const std::string& f) { return "{ \"kelpie\": 1, \"shapes\": [ { \"name\": \"a\", \"field\":\n" + f + " } ] }"; };
  expect_scene(field(R"({ "kind": "generalized_cylinder", "radius": 1, "points": [[0, 0, 0], [1, 0, 0]], "radii": [0.1, -0.2] })"), 65,
               "error: scene.json:2:97: radii must be >= 0, found -0.2\n");
  expect_scene(field(R"({ "kind": "generalized_cylinder", "radius": 1, "points": [[0, 0, 0], [1, 0, 0]], "radii": [1, 2, 3] })"), 65,
               "error: scene.json:2:91: radii: expected one, or as many as there are points (2), found 3\n");
  std::string points;
  for (int i = 0; i < 15; ++i) points += (i ? ", [" : "[") + std::to_string(i % 4) + ", 0, " + std::to_string(i / 4) + "]";
  expect_scene(field("{ \"kind\": \"patch\", \"radius\": 1, \"points\": [" + points + "] }"), 65,
               "error: scene.json:2:43: points: a patch has 16 control points, found 15\n");
  expect_scene(field(R"({ "kind": "revolution", "radius": 1, "profile": [[1, 0, 0.1], [1, 1, -0.1]] })"), 65,
               "error: scene.json:2:49: profile: the thickness of point 2 must be >= 0, found -0.1\n");
  expect_scene(field(R"({ "kind": "revolution", "radius": 1, "curve": "cubic_beziers", "profile": [[1, 0, 0], [1, 1, 0], [2, 1, 0]] })"),
               65, "error: scene.json:2:75: profile: cubic_beziers have 4 points, or 3 more for each further piece (7, 10, …), found 3\n");
  write("pinched.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\n");
  expect_scene(field(R"({ "kind": "subdivision", "radius": 1, "file": "pinched.obj" })"), 65,
               "error: " + path("pinched.obj") + ":4: face 0 has not three different corners or more\n");
  expect_scene("{ \"kelpie\": 1,\n  \"shapes\": [ }\n", 65, "error: scene.json:2:15: expected a value\n");
}

TEST_F(WrongInput, PartsAndIncludedFiles) {
  const std::string shapes = R"("shapes": [ { "name": "a", "field": { "kind": "instance", "of": "drop" } } ] })";
  const auto with_parts = [&](const std::string& parts) { return "{ \"kelpie\": 1, \"parts\": {\n" + parts + " },\n" + shapes; };
  const auto including = [&](const std::string& file) { return "{ \"kelpie\": 1, \"include\": [\"" + file + "\"],\n" + shapes; };
  expect_scene(with_parts(R"("drop": { "kind": "point", "centre": [0, 0, 0], "radius": -1 })"), 65,
               "error: scene.json:2:59: radius must be > 0, found -1\n");
  expect_scene(with_parts(R"("drop": { "kind": "instance", "of": "drip" },
"drip": { "kind": "instance", "of": "drop" })"),
               65, "error: scene.json:2:37: a cycle of parts: \"drip\" > \"drop\" > \"drip\"\n");
  expect_scene(with_parts(R"("dorp": { "kind": "point", "centre": [0, 0, 0], "radius": 1 })"), 65,
               "error: scene.json:3:65: unknown part \"drop\" (did you mean \"dorp\"?)\n");
  expect_scene(including("scene.json"), 65, "error: scene.json:1:28: include: a cycle: scene.json > scene.json\n");
  expect_scene(including("/etc/hostname"), 65,
               "error: scene.json:1:28: include: \"/etc/hostname\" lies outside the scene's folder (--allow-path permits it)\n");
  expect_scene(including("none.json"), 66, "error: scene.json:1:28: include: \"none.json\" does not exist (" + path("none.json") + ")\n");
  // Three problems here and one there, in one go.
  write("parts.json", "{ \"kelpie\": 1,\n  \"parts\": { \"drip\": { \"kind\": \"point\", \"centre\": [0, 0], \"radius\": 1 } } }");
  expect_scene("{ \"kelpie\": 1, \"include\": [\"parts.json\"],\n\"camera\": { \"fov\": 200 }, \"film\": { \"ssp\": 4 },\n" + shapes, 65,
               "error: parts.json:2:51: centre: expected [x, y, z], found 2 values\n"
               "error: scene.json:2:20: fov must be > 0 and < 180, found 200\n"
               "error: scene.json:2:37: unknown key \"ssp\" (did you mean \"spp\"?)\n"
               "error: scene.json:3:65: unknown part \"drop\" (did you mean \"drip\"?)\n");
}

TEST_F(WrongInput, FramesAndOutputs) {
  write("scene.json", k_good);
  const std::string hint = "; write 12, 1-100, 1-100x2 or a list of these: 1-96x2,100\n";
  expect("render scene.json -f '' -o a.exr", 2, "error: frames \"\": there are none" + hint);
  expect("render scene.json -f 1-3 -o a.exr", 2,
         "error: 3 frames cannot all be written to a.exr; put #### where the frame number belongs, as in name.####.exr\n");
  expect("render scene.json -o scene.json/a.exr", 74, "error: scene.json/a.exr: scene.json is a file, not a folder\n");
  expect("render scene.json --res 0x5 -o a.exr", 2,
         "error: --res 0x5: expected WIDTHxHEIGHT (up to 65536) or a percentage, as in 1280x720 or 50%\n");
  expect("render scene.json --crop 20,30,0,5 -o a.exr", 2, "error: --crop 20,30,0,5: no pixel of the 16x16 picture is in it\n");
  expect("rendr scene.json", 2, "error: unknown command \"rendr\" (did you mean \"render\"?)\n");
}

TEST_F(WrongInput, Meshes) {
  write("cut.off", std::string(k_tetrahedron).substr(0, 20));
  write("good.off", k_tetrahedron);
  for (const std::string command :
       {"fit cut.off -o a.ply", "liquid cut.off good.off -o 'a.####.exr'", "liquid good.off cut.off --save-scene s.json"}) {
    const size_t files = file_count();
    const Outcome o = kelpie(command + " --no-cache --blobs 20");
    EXPECT_EQ(o.status, 65) << command;
    EXPECT_NE(o.err.find("error: cut.off:"), std::string::npos) << o.err;
    EXPECT_EQ(file_count(), files) << command;
  }
  expect("fit none.obj -o a.ply", 66, "error: none.obj: cannot read: No such file or directory\n");
}

// Nobody looks for an EXR in a file that is called PNG; and what is wrong is said before there is work.
TEST_F(WrongInput, NamesOfOutputsEndAsTheirFormatsDo) {
  write("scene.json", k_good);
  expect("render scene.json -o 'a.####.png'", 2, "error: --output: exr is written here: \"a.####.png\" must end in .exr\n");
  expect("view none.exr -o a.jpg", 2, "error: --output: png is written here: \"a.jpg\" must end in .png\n");
  expect("sheet none.exr -o a.exr", 2, "error: --output: png is written here: \"a.exr\" must end in .png\n");
  expect("fit none.obj -o a.obj", 2, "error: --output: ply is written here: \"a.obj\" must end in .ply\n");
  expect("liquid none.obj none.obj --save-scene a.ply", 2, "error: --save-scene: json is written here: \"a.ply\" must end in .json\n");
  expect("render scene.json -f 1 -o 'a.####'", 2, "error: --output: exr is written here: \"a.####\" must end in .exr\n");
  EXPECT_EQ(kelpie("render scene.json -f 1 -o a.EXR").status, 0);
}

TEST_F(WrongInput, OfTheMorphIsSaidBeforeTheFit) {
  write("mesh.off", k_tetrahedron);
  expect("liquid mesh.off mesh.off -o a.exr", 2,
         "error: 96 frames cannot all be written to a.exr; put #### where the frame number belongs, as in name.####.exr\n");
  expect("liquid mesh.off mesh.off --res 5 -o 'a.####.exr'", 2,
         "error: --res 5: expected WIDTHxHEIGHT (up to 65536) or a percentage, as in 1280x720 or 50%\n");
}

TEST_F(WrongInput, NumbersAndNamesOfOptionsAreChecked) {
  for (const std::string value : {"nan", "inf", "-1", "wide"})
    for (const std::string command : {"fit a.obj -o a.ply", "liquid a.obj b.obj -o a.exr"})
      expect(command + " --weld " + value, 2, "error: --weld: must be a number >= 0, found " + value + "\n");
  expect("view a.exr -o a.png --exposure nan", 2, "error: --exposure: must be a number from -100 to 100, found nan\n");
  expect("movie a.exr -o a.mp4 --fps 0", 2, "error: --fps: must be a number from 0.1 to 1000, found 0\n");
  expect("render a.json --progress=loud", 2, "error: --progress: must be auto, bar, plain, jsonl or none, found loud\n");
}

// A mesh that can be mended is used, with a warning that says what was done.
TEST_F(WrongInput, AMeshThatCanBeMendedIsUsed) {
  std::string inward = k_tetrahedron;
  for (const auto& [from, to] : {std::pair{"3 0 2 1", "3 0 1 2"}, {"3 0 1 3", "3 0 3 1"}, {"3 0 3 2", "3 0 2 3"}, {"3 1 2 3", "3 1 3 2"}})
    inward.replace(inward.find(from), 7, to);
  write("inward.off", inward);
  const Outcome o = kelpie("fit inward.off -o a.ply --no-cache --blobs 20");
  EXPECT_EQ(o.status, 0) << o.err;
  EXPECT_NE(o.err.find("warning: inward.off: "), std::string::npos) << o.err;
  EXPECT_TRUE(std::filesystem::exists(path("a.ply")));
}

// A shape that nobody will see is allowed, and said once, however many frames there are.
TEST_F(WrongInput, AShapeWithoutASurfaceIsWarnedOf) {
  write("scene.json", R"({ "kelpie": 1, "frames": { "last": 3 }, "film": { "resolution": [16, 16], "spp": 1 }, "shapes": [
  { "name": "ball", "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 1 } } ] })");
  const std::string warning =
      "warning: scene.json:2:3: shape \"ball\" has no surface: its field is at most 1, and its threshold is 1 (raise "
      "\"weight\", or lower \"threshold\")\n";
  for (const char* arguments : {"check scene.json", "render scene.json -o 'a.####.exr' --progress none"}) {
    const Outcome o = kelpie(arguments);
    EXPECT_EQ(o.status, 0);
    EXPECT_EQ(o.err.substr(0, warning.size()), warning) << arguments;
    EXPECT_NE(o.err.find("frame 1 shows nothing: all shapes are missed by every ray: they have no surface, "), o.err.npos) << o.err;
  }
  EXPECT_EQ(kelpie("check scene.json --set shapes.ball.field.weight=2").err, "");
}

TEST_F(WrongInput, ColourConfigsAreNeverReplaced) {
  write("scene.json", k_good);
  const size_t files = file_count();
  EXPECT_EQ(kelpie("render scene.json --ocio none.ocio -o a.exr").status, 66);
  setenv("OCIO", "/none.ocio", 1);
  EXPECT_EQ(kelpie("render scene.json -o a.exr").status, 66);
  unsetenv("OCIO");
  EXPECT_EQ(file_count(), files);
}

// A signal ends the process by that signal, and neither a part file nor a temporary folder is left.
TEST_F(WrongInput, ASignalLeavesNothingHalfWritten) {
  write("scene.json", k_good);
  const size_t files = file_count();
  const std::string command = "cd '" + folder_.string() +
                              "' && timeout --foreground -s TERM 1 '" KELPIE_PROGRAM
                              "' render scene.json --res 2048x2048 --spp 4096 -o a.exr --progress=none; test $? = 124";
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(file_count(), files);
}

} // namespace
} // namespace kelpie
