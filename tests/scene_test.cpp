// Scene files into scenes: what is refused, and in which words; what is read.
#include "scene/parameter_text.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

/// Each fragment stands for a shape, a light, the camera or the film of a scene in one line.
struct WrongInput {
  std::string_view text;
  std::string_view errors;
};

void expect_errors(std::span<const WrongInput> cases, const std::string& before, const std::string& behind) {
  const SceneFolder folder;
  for (const WrongInput& c : cases) EXPECT_EQ(folder.errors(before + "\n" + std::string(c.text) + behind), c.errors) << c.text;
}

TEST(Reader, RefusesWrongFields) {
  const std::string known = fmt::format("{}", fmt::join(kind_names<SceneFieldKinds>(), ", "));
  const std::string unknown_kind = "scene.json:2:9: unknown kind of field \"lattice\"; known: " + known,
                    missing_kind = "scene.json:2:1: field: missing key \"kind\"; known: " + known;
  const WrongInput cases[] = {
      {R"({"kind":"pont"})", "scene.json:2:9: unknown kind of field \"pont\" (did you mean \"point\"?)"},
      {R"({"kind":"metaball"})", "scene.json:2:9: unknown kind of field \"metaball\" (did you mean \"point\"?)"},
      {R"({"kind":"sphere"})", "scene.json:2:9: unknown kind of field \"sphere\" (did you mean \"sdf_sphere\" or \"point\"?)"},
      {R"({"kind":"lattice"})", unknown_kind},
      {R"({"kind":"axial","child":{"kind":"point","centre":[0,0,0],"radius":1},"axes":[{"rest":[[0,0,0]],"deformed":[[0,0,0],[0,1,0]],"radius":1}]})",
       "scene.json:2:86: rest: expected at least 2 values, found one value"},
      {R"({"kind":"axial","child":{"kind":"point","centre":[0,0,0],"radius":1},"axes":[{"rest":[[0,0,0],[0,2,0],[0,3,0]],"deformed":[[0,0,0],[0,1,0]],"radius":1}]})",
       "scene.json:2:123: deformed: expected as many points as rest has, 3, found 2"},
      {R"({"kind":"axial","child":{"kind":"point","centre":[0,0,0],"radius":1},"axes":[{"rest":[[0,0,0],[0,2,0]],"deformed":[[0,0,0],[0,1e99,0]],"radius":1}]})",
       "scene.json:2:127: deformed: 1e+99 is too large"},
      {R"({"kind":"axial","child":{"kind":"point","centre":[0,0,0],"radius":1},"axes":[{"rest":[[0,0,0],[0,2,0]],"deformed":[[0,0,0],[0,1,0]],"radius":-1}]})",
       "scene.json:2:142: radius must be > 0, found -1"},
      {R"({"kind":"axial","child":{"kind":"point","centre":[0,0,0],"radius":1},"axes":[{"rest":[[0,0,0],[0,2,0]],"deformed":[[0,0,0],[0,1,0]],"radius":1,"frames":[{"at":1.5,"angle":90}]}]})",
       "scene.json:2:160: at must be >= 0 and <= 1, found 1.5"},
      {R"({"kind":"axial","child":{"kind":"point","centre":[0,0,0],"radius":1},"axes":[{"rest":[[0,0,0],[0,2,0]],"deformed":[[0,0,0],[0,1,0]],"radius":1,"degree":4}]})",
       "scene.json:2:153: degree must be >= 1 and <= 3, found 4"},
      {R"({"kind":1})", "scene.json:2:9: kind: expected a string, found a number"},
      {R"({"centre":[0,0,0]})", missing_kind},
      {R"([])", "scene.json:2:1: field: expected a field (an object with a \"kind\"), found a list"},
      {R"({"kind":"point","centre":[0,0,0],"radius":1,"raduis":1})", "scene.json:2:45: unknown key \"raduis\" (did you mean \"radius\"?)"},
      {R"({"kind":"point","centre":[0,0,0],"radius":1,"colour":1})",
       "scene.json:2:45: unknown key \"colour\"; known: kind, material, name, centre, radius, surface_radius, weight, falloff"},
      {R"({"kind":"point"})",
       "scene.json:2:1: missing key \"centre\" of point\nscene.json:2:1: missing key \"radius\" or \"surface_radius\" of point"},
      {R"({"kind":"point","centre":[0,0,0],"radius":"1"})", "scene.json:2:43: radius: expected a number, found a string"},
      {R"({"kind":"point","centre":[0,0,0],"radius":-1})", "scene.json:2:43: radius must be > 0, found -1"},
      {R"({"kind":"point","centre":[0,0,0],"radius":1e-60})", "scene.json:2:43: radius must be > 0, found 1e-60"},
      {R"({"kind":"point","centre":[0,0,0],"radius":1e60})", "scene.json:2:43: radius: 1e+60 is too large"},
      {R"({"kind":"point","centre":1,"radius":1})", "scene.json:2:26: centre: expected [x, y, z], found a number"},
      {R"({"kind":"point","centre":[0,1],"radius":1})", "scene.json:2:26: centre: expected [x, y, z], found 2 values"},
      {R"({"kind":"point","centre":[0,null,0],"radius":1})", "scene.json:2:29: centre: expected a number, found null"},
      {R"({"kind":"point","centre":[0,0,0],"radius":1,"falloff":"quartik"})",
       "scene.json:2:55: falloff: unknown value \"quartik\" (did you mean \"quartic\"?)"},
      {R"({"kind":"point","centre":[0,0,0],"radius":1,"falloff":2})",
       "scene.json:2:55: falloff: expected one of quartic, cubic, wyvill, found a number"},
      {R"({"kind":"blend","children":[]})", "scene.json:2:28: children may not be empty"},
      {R"({"kind":"blend","children":{}})", "scene.json:2:28: children: expected a list, found an object"},
      {R"({"kind":"blend","children":[{"kind":"point","centre":[0,0,0],"radius":0},1]})",
       "scene.json:2:71: radius must be > 0, found 0\n"
       "scene.json:2:74: children: expected a field (an object with a \"kind\"), found a number"},
      {R"({"kind":"rotate","angle":1,"axis":[0,0,0],"child":{"kind":"point","centre":[0,0,0],"radius":1}})",
       "scene.json:2:35: axis may not be the zero vector"},
      {R"({"kind":"scale","by":[1,0,1],"child":{"kind":"point","centre":[0,0,0],"radius":1}})",
       "scene.json:2:25: by must be other than 0, found 0"},
      {R"({"kind":"scale","by":"x","child":{"kind":"point","centre":[0,0,0],"radius":1}})",
       "scene.json:2:22: by: expected [x, y, z] or a number for all three, found a string"},
      {R"({"kind":"liquid","from":"cloud.ply","to":"cloud.ply","progress":2})", "scene.json:2:65: progress must be >= 0 and <= 1, found 2"},
      {R"({"kind":"liquid","from":"cloud.ply","to":"cloud.ply","progress":0,"through":"cloud.ply"})",
       "scene.json:2:77: through: expected a list, found a string"},
      {R"({"kind":"liquid","from":"cloud.ply","to":"cloud.ply","progress":0,"through":["cloud.ply",3]})",
       "scene.json:2:90: through: expected a path, found a number"},
      {R"({"kind":"liquid","from":"cloud.ply","to":"cloud.ply","progress":0,"through":["cloud.ply","no.ply"]})",
       "scene.json:2:90: through: \"no.ply\" does not exist (no.ply)"},
      {R"({"kind":"liquid","from":"cloud.ply","to":"cloud.ply","progress":0,"correspondence":"hierarchical"})",
       "scene.json:2:84: correspondence: \"hierarchical\" is known but not built yet"},
  };
  expect_errors(cases, R"({"kelpie":1,"shapes":[{"name":"a","field":)", "}]}");
}

TEST(Reader, RefusesWrongCurves) {
  const WrongInput cases[] = {
      {R"({"keys":[[2,1],[1,1]]})", "scene.json:2:16: keys must ascend: frame 1 follows frame 2"},
      {R"({"keys":[[1,1],[1,1]]})", "scene.json:2:16: keys must ascend: frame 1 follows frame 1"},
      {R"({"keys":[]})", "scene.json:2:9: keys may not be empty"},
      {R"({"keys":1})", "scene.json:2:9: keys: expected a list, found a number"},
      {R"({"keys":[1]})", "scene.json:2:10: threshold: expected [frame, value] or [frame, value, derivative, …], found a number"},
      {R"({"keys":[[1]]})", "scene.json:2:10: threshold: expected [frame, value] or [frame, value, derivative, …], found one value"},
      {R"({"keys":[["1",1]]})", "scene.json:2:11: frame: expected a number, found a string"},
      {R"({"keys":[[1e300,1]]})", "scene.json:2:11: frame must be >= -1000000000 and <= 1000000000, found 1e+300"},
      {R"({"keys":[[1,0]]})", "scene.json:2:13: threshold must be > 0, found 0"},
      {R"({"keys":[[1,1,1]]})", "scene.json:2:15: threshold: derivatives need \"interpolation\": \"hermite\""},
      {R"({"keys":[[1,1,1,1,1,1,1]],"interpolation":"hermite"})", "scene.json:2:10: threshold: more than 4 derivatives"},
      {R"({"keys":[[1,1,true]],"interpolation":"hermite"})", "scene.json:2:15: threshold: expected a number, found true"},
      {R"({"keys":[[1,1,{"before":1}]],"interpolation":"hermite"})",
       "scene.json:2:25: before: expected a list of derivatives, found a number"},
      {R"({"keys":[[1,1,{"befor":[1]}]],"interpolation":"hermite"})", "scene.json:2:16: unknown key \"befor\" (did you mean \"before\"?)"},
      {R"({"keys":[[1,1,{"after":[1]},2]],"interpolation":"hermite"})",
       "scene.json:2:29: threshold: nothing follows the derivatives of both sides"},
      {R"({"keys":[[1,0.1,-9],[2,0.1,9]],"interpolation":"hermite"})",
       "scene.json:2:1: threshold must be > 0: the curve leaves that between its keys, at frame 1.125"},
      {R"({"keys":[[1,1]],"interpolation":"bezier"})",
       "scene.json:2:33: interpolation: unknown value \"bezier\"; known: linear, step, hermite, smooth, spline"},
      {R"({"keys":[[1,1]],"after":"repeat"})",
       "scene.json:2:25: after: unknown value \"repeat\"; known: hold, cycle, cycle_offset, ping_pong, continue"},
      {R"({"keys":[[1,5],[2,0.1],[3,0.1],[4,5]],"interpolation":"spline"})",
       "scene.json:2:1: threshold must be > 0: the curve leaves that between its keys, at frame 2.125"},
      {R"({"keys":[[1,1]],"interpolate":"step"})", "scene.json:2:17: unknown key \"interpolate\" (did you mean \"interpolation\"?)"},
      {R"({"interpolation":"step"})", "scene.json:2:1: threshold: missing key \"keys\""},
      {R"({})", "scene.json:2:1: threshold: missing key \"keys\""},
  };
  expect_errors(cases, R"({"kelpie":1,"shapes":[{"name":"a","field":{"kind":"point","centre":[0,0,0],"radius":1},"threshold":)", "}]}");
}

TEST(Reader, RefusesWrongSurfaces) {
  const WrongInput cases[] = {
      {R"({"kind":"matte","colour":"red"})",
       "scene.json:2:26: colour: expected [r, g, b], \"#rrggbb\" or {\"space\": …, \"rgb\": [r, g, b]}, found \"red\""},
      {R"({"kind":"matte","colour":"#-12345"})",
       "scene.json:2:26: colour: expected [r, g, b], \"#rrggbb\" or {\"space\": …, \"rgb\": [r, g, b]}, found \"#-12345\""},
      {R"({"kind":"matte","colour":3})",
       "scene.json:2:26: colour: expected [r, g, b], \"#rrggbb\" or {\"space\": …, \"rgb\": [r, g, b]}, found a number"},
      {R"({"kind":"matte","colour":[0,0,2]})", "scene.json:2:31: colour must be >= 0 and <= 1, found 2"},
      {R"({"kind":"matte","colour":{"rgb":[1,1,1]}})", "scene.json:2:26: colour: missing key \"space\" of the colour"},
      {R"({"kind":"matte","colour":{"space":"sRGB","rbg":[1,1,1],"rgb":[1,1]}})",
       "scene.json:2:42: unknown key \"rbg\" (did you mean \"rgb\"?)\nscene.json:2:62: rgb: expected [r, g, b], found 2 values"},
      {R"({"kind":"matte","colour":{"space":"scene_linear","rgb":[0,0,9]}})",
       "scene.json:2:26: colour must be >= 0 and <= 1, found 9 in scene_linear"},
      {R"({"kind":"metal","roughness":{"keys":[[1,0],[2,1.5]]}})", "scene.json:2:47: roughness must be >= 0 and <= 1, found 1.5"},
  };
  expect_errors(cases, R"({"kelpie":1,"shapes":[{"name":"a","field":{"kind":"point","centre":[0,0,0],"radius":1},"surface":)", "}]}");
}

TEST(Reader, RefusesWrongScenes) {
  const WrongInput cases[] = {
      {R"(})", "scene.json:1:1: missing key \"kelpie\" of scene"},
      {R"(,"kelpie":2})", "scene.json:2:11: kelpie must be 1, found 2"},
      {R"(,"kelpie":1,"camra":{}})", "scene.json:2:13: unknown key \"camra\" (did you mean \"camera\"?)"},
      {R"(,"kelpie":1,"frames":{"first":5,"last":4}})", "scene.json:2:40: last must be >= first, found 4 and 5"},
      {R"(,"kelpie":1,"frames":{"first":1.5}})", "scene.json:2:31: first: expected a whole number, found 1.5"},
      {R"(,"kelpie":1,"frames":{"last":1e10}})", "scene.json:2:30: last: 10000000000 is too large"},
      {R"(,"kelpie":1,"camera":{"shutter":-0.5}})", "scene.json:2:33: shutter must be >= 0, found -0.5"},
      {R"(,"kelpie":1,"camera":{"fov":180}})", "scene.json:2:29: fov must be > 0 and < 180, found 180"},
      {R"(,"kelpie":1,"camera":{"position":[1,1,1],"look_at":[1,1,1]}})", "scene.json:2:52: look_at must differ from position"},
      {R"(,"kelpie":1,"camera":{"position":[0,6,0]}})", "scene.json:2:34: up is parallel to the direction of view"},
      {R"(,"kelpie":1,"camera":{"position":{"keys":[[1,[0,1,6]],[9,[0,6,0]]]}}})",
       "scene.json:2:34: up is parallel to the direction of view at frame 9"},
      {R"(,"kelpie":1,"film":{"resolution":[0,10.5]}})", "scene.json:2:35: resolution must be >= 1 and <= 65536, found 0\n"
                                                         "scene.json:2:37: resolution: expected a whole number, found 10.5"},
      {R"(,"kelpie":1,"film":{"aovs":["Z","cryptomatte","Z"]}})", "scene.json:2:33: aovs: \"cryptomatte\" is known but not built yet"},
      {R"(,"kelpie":1,"film":{"aovs":["Z","N","Z"]}})", "scene.json:2:37: aovs: \"Z\" is listed twice"},
      {R"(,"kelpie":1,"film":{"background":"sky"}})",
       "scene.json:2:34: background: expected \"environment\", \"transparent\" or a colour, found \"sky\""},
      {R"(,"kelpie":1,"lights":[{"kind":"environment","file":"cloud.ply","preset":"sky"}]})",
       "scene.json:2:45: \"file\" and \"preset\" exclude each other"},
      {R"(,"kelpie":1,"lights":{}})", "scene.json:2:22: lights: expected a list, found an object"},
  };
  expect_errors(cases, R"({"shapes":[{"name":"a","field":{"kind":"point","centre":[0,0,0],"radius":1}}])", "");
}

TEST(Reader, RefusesWrongShapes) {
  const WrongInput cases[] = {
      {R"([])", "scene.json:2:1: shapes may not be empty"},
      {R"([{}])", "scene.json:2:2: missing key \"name\" of shape\nscene.json:2:2: missing key \"field\" or \"geometry\" of shape"},
      {R"([{"name":"","geometry":{"kind":"plane"}}])", "scene.json:2:10: name may not be empty"},
      {R"([{"name":"a","geometry":{"kind":"plane"}},{"name":"a","geometry":{"kind":"plane"}}])",
       "scene.json:2:51: two shapes are called \"a\" (the other: scene.json:2:10)"},
      {R"([{"name":"a","geometry":{"kind":"plane"},"field":{"kind":"point","centre":[0,0,0],"radius":1}}])",
       "scene.json:2:42: \"field\" and \"geometry\" exclude each other"},
      {R"([{"name":"a","geometry":{"kind":"plane","normal":[0,0,0]}}])", "scene.json:2:50: normal may not be the zero vector"},
  };
  expect_errors(cases, R"({"kelpie":1,"shapes":)", "}");
}

TEST(Reader, RefusesWhatIsNoScene) {
  const SceneFolder folder;
  EXPECT_EQ(folder.errors("[]"), "scene.json:1:1: the scene: expected an object, found a list");
  Diagnostics diagnostics;
  for (const std::string& path : {folder.path("none.json"), folder.path("")}) {
    try {
      read_scene(path, {}, diagnostics);
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.status, ExitStatus::missing_input);
      EXPECT_EQ(std::string(e.what()).find(path + ": cannot read the scene: "), 0u);
    }
  }
}

TEST(Reader, ShowsNoControlCharacters) {
  EXPECT_EQ(SceneFolder().errors(R"({"kelpie":1,"shapes":[{"name":"a","geometry":{"kind":"plane\u001b[31m"}}]})"),
            "scene.json:1:54: unknown kind of geometry \"plane?[31m\"; known: plane, mesh");
}

TEST(Assets, AreConfinedToTheScenesFolder) {
  const SceneFolder folder, other;
  const auto with = [](const std::string& file) { return scene_with_field("{\"kind\":\"blobs\",\"file\":\"" + file + "\"}"); };
  folder.write("sub/inner.ply", "");
  std::filesystem::copy_file(folder.path("cloud.ply"), folder.path("sub/inner.ply"), std::filesystem::copy_options::overwrite_existing);
  std::filesystem::create_symlink(other.path("cloud.ply"), folder.path("link.ply"));
  std::filesystem::create_symlink("loop.ply", folder.path("loop.ply"));

  EXPECT_EQ(folder.errors(with("cloud.ply")), "");
  EXPECT_EQ(folder.errors(with("sub/../sub/inner.ply")), "");
  const std::string outside = "scene.json:1:66: file: \"{}\" lies outside the scene's folder (--allow-path permits it)";
  for (const std::string& path : {std::string("../x.ply"), other.path("cloud.ply"), std::string("link.ply"), std::string("/dev/zero")}) {
    EXPECT_EQ(folder.status(with(path)), ExitStatus::bad_data);
    EXPECT_NE(folder.errors(with(path)).find("lies outside the scene's folder (--allow-path permits it)"), std::string::npos) << path;
  }
  EXPECT_EQ(folder.errors(with(other.path("cloud.ply")), {{}, {other.path("")}}), "");
  EXPECT_EQ(folder.errors(with("link.ply"), {{}, {other.path("cloud.ply")}}), "");
  EXPECT_NE(folder.errors(with("link.ply"), {{}, {other.path("cloud")}}), ""); // not every path that begins alike
  // The command line may name what it likes.
  EXPECT_EQ(folder.errors(with("cloud.ply"), {{"shapes.a.field.file=" + other.path("cloud.ply")}, {}}), "");
}

TEST(Assets, AreReportedWithTheRest) {
  const SceneFolder folder;
  folder.write("bad.ply", "ply\n");
  EXPECT_EQ(folder.errors(scene_with_field(R"({"kind":"blobs","file":"none.ply"})")),
            "scene.json:1:66: file: \"none.ply\" does not exist (none.ply)");
  EXPECT_EQ(folder.status(scene_with_field(R"({"kind":"blobs","file":"none.ply"})")), ExitStatus::missing_input);
  EXPECT_EQ(folder.errors(scene_with_field(R"({"kind":"blobs","file":"."})")), "scene.json:1:66: file: \".\" is no file");
  const std::string mixed = R"({"kind":"blend","children":[{"kind":"blobs","file":"none.ply"},{"kind":"blobs","file":"bad.ply"},1]})";
  EXPECT_EQ(folder.status(scene_with_field(mixed)), ExitStatus::bad_data);
  const std::string errors = folder.errors(scene_with_field(mixed));
  for (const char* part : {"bad.ply:", "\"none.ply\" does not exist", "found a number"})
    EXPECT_NE(errors.find(part), std::string::npos) << errors;
}

TEST(Reader, OverridesAreCheckedLikeText) {
  const SceneFolder folder;
  const std::string text = scene_with_field(R"({"kind":"point","centre":[0,0,0],"radius":1})");
  EXPECT_EQ(folder.read(text, {{"shapes.a.threshold=1.25", "film.spp=9", "film.background=transparent"}, {}}).film.spp, 9);
  EXPECT_EQ(folder.errors(text, {{"shapes.a.field.radius=-1"}, {}}), "--set shapes.a.field.radius=-1: radius must be > 0, found -1");
  EXPECT_EQ(folder.errors(text, {{"shapes.a.thershold=1"}, {}}),
            "--set shapes.a.thershold=1: unknown key \"thershold\" (did you mean \"threshold\"?)");
  EXPECT_EQ(folder.errors(text, {{"film.filter=bxo", "kelpie=one"}, {}}),
            "--set film.filter=bxo: filter: unknown value \"bxo\" (did you mean \"box\"?)\n"
            "--set kelpie=one: kelpie: expected a whole number, found a string");
}

TEST(Reader, HashSeesWhatPicturesDependOn) {
  const SceneFolder folder;
  const std::string hash = folder.read(R"({"kelpie":1,"shapes":[{"name":"a","field":{"kind":"blobs","file":"cloud.ply"}}]})").hash;
  const std::string text = R"({ "shapes": [{"field": {"file": "cloud.ply", "kind": "blobs"}, "name": "a"}], /* x */ "kelpie": 1.0 })";
  EXPECT_EQ(hash.size(), 32u);
  EXPECT_EQ(folder.read(text).hash, hash);
  EXPECT_NE(folder.read(text, {{"shapes.a.threshold=1.1"}, {}}).hash, hash);
  EXPECT_EQ(folder.read(text, {{"shapes.a.field.file=cloud.ply"}, {}}).hash, hash);
  std::ofstream(folder.path("cloud.ply"), std::ios::app) << " "; // one byte more
  EXPECT_NE(folder.read(text).hash, hash);
}

TEST(Reader, ReadsColoursOfEverySpace) {
  const SceneFolder folder;
  const auto colour = [&](const std::string& json) {
    const Scene s = folder.read(scene_with_field(R"({"kind":"point","centre":[0,0,0],"radius":1})"),
                                {{R"(shapes.a.surface={"kind":"metal"})", "shapes.a.surface.colour=" + json}, {}});
    return std::get<Metal<AnimatedMode>>(s.shapes[0].surface->kind).colour.at(0).rgb;
  };
  EXPECT_EQ(colour("[0.25,0.5,1]"), Vec3(0.25f, 0.5f, 1.f));
  EXPECT_EQ(colour(R"({"space":"scene_linear","rgb":[0.25,0.5,1]})"), Vec3(0.25f, 0.5f, 1.f));
  EXPECT_LT(glm::length(colour("#ffffff") - Vec3(1)), 1e-4f);
  // sRGB 0x80 is 0.2158605 in linear light; greys stay grey.
  EXPECT_LT(glm::length(colour("#808080") - Vec3(0.2158605f)), 1e-4f);
  EXPECT_EQ(colour(R"({"space":"sRGB","rgb":[0.5,0.1,1]})"), colour(R"({"space":"color_picking","rgb":[0.5,0.1,1]})"));
  EXPECT_EQ(colour(R"({"keys":[[0,"#000000"],[2,[1,1,1]]]})"), Vec3(0));
}

TEST(Reader, SamplesWhatItRead) {
  const Scene scene = SceneFolder().read(R"({ "kelpie": 1,
    "camera": { "fov": { "keys": [[1, 20], [3, 40]], "interpolation": "step" } },
    "lights": [{ "kind": "sun", "colour": { "keys": [[0, [0, 0, 0]], [4, [1, 0.5, 0]]] } }],
    "shapes": [{ "name": "a", "threshold": { "keys": [[0, 1], [2, 3]] },
      "field": { "kind": "scale", "by": { "keys": [[0, 1], [2, [2, 3, 4]]] }, "child": { "kind": "point", "radius": 1,
        "centre": { "keys": [[0, [0, 0, 0], [0, 0, 0]], [2, [2, 0, 0], [0, 0, 0]]], "interpolation": "hermite" } } },
      "surface": { "kind": "metal", "roughness": 0.5 } }] })");
  const FrameScene f = sample(scene, 1);
  EXPECT_EQ(f.shapes[0].threshold, 2);
  ASSERT_EQ(f.shapes[0].field.nodes.size(), 2u);
  EXPECT_EQ(std::get<Point<SampledMode>>(f.shapes[0].field.nodes[0]).centre, Vec3(1, 0, 0));
  EXPECT_EQ(std::get<Scale<SampledMode>>(f.shapes[0].field.nodes[1]).by, Vec3(1.5f, 2, 2.5f));
  EXPECT_EQ(std::get<Metal<SampledMode>>(f.materials[f.shapes[0].surface.index]).roughness, 0.5f);
  EXPECT_EQ(std::get<SunLight<SampledMode>>(f.lights[0]).colour.rgb, Vec3(0.25f, 0.125f, 0));
  EXPECT_EQ(sample(scene, 2.9).camera.fov, 20);
  EXPECT_EQ(sample(scene, 3).camera.fov, 40);
  // Half way up a smooth curve; a quarter of the way it has gone less than a quarter.
  EXPECT_NEAR(std::get<Point<SampledMode>>(sample(scene, 0.5).shapes[0].field.nodes[0]).centre.x, 0.3125f, 1e-6f);
}

TEST(Reader, LoadsCloudsOnce) {
  const Scene scene = SceneFolder().read(scene_with_field(
      R"({"kind":"blend","children":[{"kind":"blobs","file":"cloud.ply"},{"kind":"blobs","file":"./cloud.ply","falloff":"cubic"},
          {"kind":"liquid","from":"cloud.ply","to":"cloud.ply","progress":0.5}]})"));
  const auto& children = std::get<Blend<AnimatedMode>>(scene.shapes[0].field->kind).children;
  const auto &a = std::get<Blobs<AnimatedMode>>(children[0]->kind), &b = std::get<Blobs<AnimatedMode>>(children[1]->kind);
  ASSERT_TRUE(a.cloud);
  EXPECT_EQ(a.cloud, b.cloud);
  EXPECT_EQ(a.cloud->at(0).weight, 1.5f);
  EXPECT_TRUE(std::get<Liquid<AnimatedMode>>(children[2]->kind).morph);
}

TEST(Reader, LetsALiquidFlowThroughClouds) {
  const Scene scene = SceneFolder().read(
      scene_with_field(R"({"kind":"liquid","from":"cloud.ply","through":["./cloud.ply","cloud.ply"],"to":"cloud.ply","progress":0.5})"));
  const auto& liquid = std::get<Liquid<AnimatedMode>>(scene.shapes[0].field->kind);
  ASSERT_TRUE(liquid.morph);
  EXPECT_EQ(liquid.morph->passages().size(), 3u);
}

TEST(Reader, IsNeverDark) {
  const std::string text = scene_with_field(R"({"kind":"point","centre":[0,0,0],"radius":1})");
  for (const std::vector<std::string>& set : {std::vector<std::string>{}, {"lights=[]"}}) {
    const Scene scene = SceneFolder().read(text, {set, {}});
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(std::get<EnvironmentLight<AnimatedMode>>(scene.lights[0]).preset, EnvironmentPreset::studio);
  }
}

TEST(Reader, ReadsEveryExample) {
  int examples = 0;
  for (const auto& entry : std::filesystem::directory_iterator(KELPIE_EXAMPLES)) {
    if (entry.path().extension() != ".json") continue;
    ++examples;
    Diagnostics diagnostics;
    sample(read_scene(entry.path().string(), {}, diagnostics), 1);
    EXPECT_TRUE(diagnostics.warnings().empty()) << entry.path();
  }
  EXPECT_GT(examples, 3);
}

// The examples are read as they are; every byte of them that is damaged yields an error or a scene,
// never anything else.
TEST(Reader, SurvivesDamagedText) {
  const SceneFolder folder;
  const auto text_of = [](const std::string& name) {
    std::ifstream file(std::string(KELPIE_EXAMPLES) + "/" + name, std::ios::binary);
    return std::string((std::istreambuf_iterator<char>(file)), {});
  };
  folder.write("parts/metals.json", text_of("parts/metals.json"));
  for (const char* name : {"blob.json", "boolean.json", "creature.json", "braid.json"}) {
    const std::string text = text_of(name);
    ASSERT_EQ(folder.errors(text), "") << name;
    std::uint32_t random = 1;
    int refused = 0;
    for (size_t i = 0; i < 100; ++i) {
      std::string damaged = text;
      for (int n = 0; n < 3; ++n) {
        random = random * 1664525u + 1013904223u;
        damaged[(random >> 8) % damaged.size()] = "\"{}[]:,0-.e#/\\\n\xff"[(random >> 4) % 16];
      }
      refused += folder.errors(damaged) != "";
      refused += folder.errors(damaged.substr(0, (random >> 5) % damaged.size())) != "";
    }
    EXPECT_GT(refused, 150);
  }
}

} // namespace
} // namespace kelpie
