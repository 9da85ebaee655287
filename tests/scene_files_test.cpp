// Parts, surfaces by name, and what comes from other files: what is refused, and in which words; what is read.
#include <chrono>

#include <fmt/format.h>

#include "scene/document.h"
#include "scene/manual.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

const std::string k_a_point = R"({"kind":"point","centre":[0,0,0],"radius":1})";

std::string instance_of(const std::string& name, const std::string& more = "") {
  return "{\"kind\":\"instance\",\"of\":\"" + name + "\"" + more + "}";
}
std::string blend_of(const std::string& fields) { return "{\"kind\":\"blend\",\"children\":[" + fields + "]}"; }

/// One more element of a list as text.
void append(std::string& list, const std::string& element) {
  if (!list.empty()) list += ',';
  list += element;
}

/// A scene in two lines: its parts, and the field of its only shape.
std::string scene_of_parts(const std::string& parts, const std::string& field) {
  return "{\"kelpie\":1,\"parts\":{" + parts + "},\n\"shapes\":[{\"name\":\"a\",\"field\":" + field + "}]}";
}

const Instance<AnimatedMode>& as_instance(const FieldPtr& field) { return std::get<Instance<AnimatedMode>>(field->kind); }

TEST(Parts, AreSharedByTheirInstances) {
  const SceneFolder folder;
  const Scene scene =
      folder.read(scene_of_parts(R"("pair":)" + blend_of(instance_of("drop") + "," + instance_of("drop")) + ",\"drop\":" + k_a_point,
                                 blend_of(instance_of("pair") + "," + instance_of("drop"))));
  const FieldPtr drop = scene.parts.at("drop");
  const auto& of_shape = std::get<Blend<AnimatedMode>>(scene.shapes[0].field->kind).children;
  const auto& of_pair = std::get<Blend<AnimatedMode>>(scene.parts.at("pair")->kind).children;
  EXPECT_EQ(as_instance(of_shape[0]).child.target, scene.parts.at("pair"));
  for (const FieldPtr& instance : {of_shape[1], of_pair[0], of_pair[1]}) EXPECT_EQ(as_instance(instance).child.target, drop);
  // At one moment, too: a point, its two instances in the pair, their blend, its instance, one more of the point, the root.
  EXPECT_EQ(sample(scene, 1).shapes[0].field.nodes.size(), 7u);
}

// Each key of a scene once more at its end, with nothing in it: what was read first is gone, and nobody looks for it.
TEST(Files, AreFoundWhereTheyWereReadWhateverStandsTwice) {
  const SceneFolder folder;
  const std::string shapes = R"([{"name":"a","geometry":{"kind":"mesh","file":"mesh.obj"}},{"name":"b","field":{"kind":"blobs",)"
                             R"("file":"cloud.ply"}}])",
                    other = R"([{"name":"c","geometry":{"kind":"mesh","file":"mesh.obj"}}])";
  const std::string begin = "{\"kelpie\":1,\n";
  for (const auto& [first, second] :
       {std::pair{shapes, other}, {other, shapes}, {std::string("[]"), shapes}, {shapes, std::string("[]")}}) {
    const std::string errors = folder.errors(begin + "\"shapes\":" + first + ",\n\"shapes\":" + second + "}");
    EXPECT_NE(errors.find("scene.json:3:1: duplicate key \"shapes\" (also in line 2)"), std::string::npos) << errors;
  }
  for (const std::string list : {"geometry", "file"}) {
    const std::string value = list == "file" ? "\"none.obj\"" : R"({"kind":"plane"})",
                      kept = list == "file" ? "\"mesh.obj\"" : R"({"kind":"mesh","file":"mesh.obj"})";
    const std::string twice = "\"" + list + "\":" + value + ",\"" + list + "\":" + kept;
    const std::string shape = list == "file" ? R"({"name":"a","geometry":{"kind":"mesh",)" + twice + "}}" : R"({"name":"a",)" + twice + "}";
    EXPECT_NE(folder.errors(begin + "\"shapes\":[" + shape + "]}").find("duplicate key \"" + list + "\""), std::string::npos);
  }
}

TEST(Files, AreBlamedWhereTheyAreNamedFirst) {
  const SceneFolder folder;
  folder.write("bad.obj", "v 0 0\n");
  const std::string mesh = R"({"kind":"mesh","file":"bad.obj"})";
  const std::string errors = folder.errors("{\"kelpie\":1,\"shapes\":[\n{\"name\":\"a\",\"geometry\":" + mesh +
                                           "},\n{\"name\":\"b\",\"geometry\":" + mesh + "}]}");
  EXPECT_EQ(errors.find('\n'), std::string::npos) << errors;
  EXPECT_EQ(errors.find("bad.obj:1:"), 0u) << errors;
}

TEST(Parts, RefuseWhatLeadsNowhere) {
  const SceneFolder folder;
  const auto expect = [&](const std::string& parts, const std::string& field, const std::string& errors) {
    EXPECT_EQ(folder.errors(scene_of_parts(parts, field)), errors) << parts << "\n" << field;
  };
  const std::string at = "scene.json:2:55: ", drop = "\"drop\":" + k_a_point;
  expect(drop, instance_of("drpo"), at + "unknown part \"drpo\" (did you mean \"drop\"?)");
  expect(drop, instance_of("xyz"), at + "unknown part \"xyz\"; known: drop");
  expect("", instance_of("drop"), at + "unknown part \"drop\": the scene has no parts");
  expect(drop, R"({"kind":"instance"})", "scene.json:2:31: missing key \"of\" of instance");
  expect(drop, R"({"kind":"instance","of":7})", at + "of: expected the name of a part, found a number");
  expect(drop, R"({"kind":"instance","of":"drop","scale":[1,0,1]})", "scene.json:2:73: scale must be other than 0, found 0");
  expect("\"\":" + k_a_point, k_a_point, "scene.json:1:22: parts: a name may not be empty");
  expect("\"drop\":" + k_a_point + ",\"drop\":" + k_a_point, k_a_point, "scene.json:1:74: duplicate key \"drop\" (also in line 1)");
  // Parts are checked whether or not anything uses them.
  expect(R"("drop":{"kind":"point","centre":[0,0,0],"radius":-1})", k_a_point, "scene.json:1:71: radius must be > 0, found -1");
  EXPECT_EQ(folder.errors(R"({"kelpie":1,"parts":[],"shapes":[{"name":"a","field":)" + k_a_point + "}]}"),
            "scene.json:1:21: parts: expected an object, found a list");
}

TEST(Parts, RefuseCycles) {
  const SceneFolder folder;
  EXPECT_EQ(folder.errors(scene_of_parts("\"a\":" + instance_of("a"), instance_of("a"))),
            "scene.json:1:50: a cycle of parts: \"a\" > \"a\"");
  EXPECT_EQ(
      folder.errors(scene_of_parts("\"a\":" + instance_of("b") + ",\"b\":" + instance_of("c") + ",\"c\":" + instance_of("b"), k_a_point)),
      "scene.json:1:116: a cycle of parts: \"b\" > \"c\" > \"b\"");
  // All problems in one go: a cycle, a reference to nothing, a negative radius.
  EXPECT_EQ(folder.errors(scene_of_parts("\"a\":" + instance_of("a") + ",\"b\":" + instance_of("c"),
                                         R"({"kind":"point","centre":[0,0,0],"radius":-2})")),
            "scene.json:1:50: a cycle of parts: \"a\" > \"a\"\n"
            "scene.json:1:83: unknown part \"c\" (did you mean \"a\"?)\n"
            "scene.json:2:73: radius must be > 0, found -2");
  // A long one is found without a deep stack, and its line stays short.
  std::string chain;
  for (int i = 0; i < 100'000; ++i) chain += fmt::format("\"p{}\":{},", i, instance_of(fmt::format("p{}", (i + 1) % 100'000)));
  chain.pop_back();
  const std::string error = folder.errors(scene_of_parts(chain, k_a_point));
  EXPECT_NE(error.find("a cycle of parts: "), std::string::npos);
  EXPECT_LT(error.size(), 200u);
}

TEST(Parts, KeepToTheDepthOfFields) {
  const SceneFolder folder;
  // A point below n instances.
  const auto chain = [](int n) {
    std::string parts = "\"p0\":" + k_a_point;
    for (int i = 1; i < n; ++i) parts += fmt::format(",\"p{}\":{}", i, instance_of(fmt::format("p{}", i - 1)));
    return scene_of_parts(parts, instance_of(fmt::format("p{}", n - 1)));
  };
  EXPECT_EQ(folder.errors(chain(63)), "");
  EXPECT_EQ(folder.errors(chain(64)), "scene.json:2:55: more than 64 fields in one another");
  EXPECT_NE(folder.errors(chain(100'000)).find("more than 64 fields in one another"), std::string::npos);
}

// Each part uses the one before it ten times: ten to the 9th of points, in a file of some lines.
TEST(Parts, KeepToTheNumberOfElements) {
  const SceneFolder folder;
  const auto tower = [](int height, int width) {
    std::string parts = "\"p0\":" + k_a_point;
    for (int i = 1; i <= height; ++i) {
      std::string users;
      for (int j = 0; j < width; ++j) append(users, instance_of(fmt::format("p{}", i - 1)));
      parts += fmt::format(",\"p{}\":{}", i, blend_of(users));
    }
    return scene_of_parts(parts, instance_of(fmt::format("p{}", height)));
  };
  EXPECT_EQ(folder.errors(tower(3, 10)), "");
  const auto before = std::chrono::steady_clock::now();
  EXPECT_EQ(folder.errors(tower(9, 10)), "scene.json:2:31: with this field the scene has 2.22e+09 elements, more than 10000000");
  EXPECT_EQ(folder.errors(tower(20, 1000)).find("scene.json:2:31: with this field the scene has "), 0u);
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(5));
  // A cloud's blobs count as often as it is used.
  std::string cloud = "ply\nformat ascii 1.0\nelement vertex 20000\nproperty float x\nproperty float y\nproperty float z\n"
                      "property float radius\nproperty float weight\nend_header\n";
  for (int i = 0; i < 20000; ++i) cloud += "0 0 0 1 1\n";
  folder.write("large.ply", cloud);
  std::string users;
  for (int j = 0; j < 600; ++j) append(users, instance_of("large"));
  EXPECT_NE(folder.errors(scene_of_parts(R"("large":{"kind":"blobs","file":"large.ply"})", blend_of(users))).find("1.2e+07 elements"),
            std::string::npos);
}

TEST(Parts, MoveAtTheirOwnTime) {
  const SceneFolder folder;
  const std::string moving = R"({"kind":"point","centre":{"keys":[[1,[0,0,0]],[3,[2,0,0]]]},"radius":1})";
  const Scene scene =
      folder.read(scene_of_parts("\"drop\":" + moving + ",\"late\":" + instance_of("drop", R"(,"time_offset":2)"),
                                 instance_of("late", R"(,"time_offset":0.5,"position":{"keys":[[1,[0,0,0]],[2,[0,1,0]]]})")));
  for (const auto& [frame, x] : {std::pair{1.0, 0.0}, {3.5, 0.0}, {4.5, 1.0}, {5.5, 2.0}, {9.0, 2.0}}) {
    const SampledField field = sample(scene, frame).shapes[0].field;
    EXPECT_EQ(std::get<Point<SampledMode>>(field.nodes[0]).centre.x, float(x)) << frame;
  }
  // The instance itself moves by the clock of what it stands in.
  EXPECT_EQ(std::get<Instance<SampledMode>>(sample(scene, 1.5).shapes[0].field.nodes.back()).position.y, 0.5f);
  for (const double at : {1.0, 2.0, 3.5, 5.5}) EXPECT_EQ(sample(scene, at).breaks, std::vector<double>{at}); // those that the shutter sees
  EXPECT_TRUE(sample(scene, 1).moment);
}

// Its 48 frames are a loop, for all that is late in it.
TEST(Parts, OfTheBraidLoop) {
  Diagnostics diagnostics;
  const Scene scene = read_scene(std::string(KELPIE_EXAMPLES) + "/braid.json", {}, diagnostics);
  const FrameScene a = sample(scene, scene.frames.first), b = sample(scene, scene.frames.last + 1);
  int moving = 0;
  for (size_t s = 0; s < a.shapes.size(); ++s)
    for (size_t i = 0; i < a.shapes[s].field.nodes.size(); ++i) {
      const auto &before = a.shapes[s].field.nodes[i], &after = b.shapes[s].field.nodes[i];
      if (const auto* point = std::get_if<Point<SampledMode>>(&before)) {
        EXPECT_NEAR(point->radius, std::get<Point<SampledMode>>(after).radius, 1e-5f);
      }
      if (const auto* turned = std::get_if<Rotate<SampledMode>>(&before)) {
        EXPECT_NEAR(std::get<Rotate<SampledMode>>(after).angle - turned->angle, 360, 1e-3);
        ++moving;
      }
    }
  EXPECT_EQ(moving, 3 * 24); // of each strand 72 beads, which have 24 different delays
}

TEST(Materials, MayHaveNames) {
  const SceneFolder folder;
  const auto scene = [](const std::string& materials, const std::string& used) {
    return R"({"kelpie":1,"shapes":[{"name":"a","field":)" + k_a_point + ",\n\"surface\":" + used + "}],\"materials\":{" + materials + "}}";
  };
  const std::string gold = R"("gold":{"kind":"metal","colour":[1,0.77,0.34]})";
  const Scene s = folder.read(scene(gold, "\"gold\""));
  EXPECT_EQ(std::get<Metal<AnimatedMode>>(s.shapes[0].surface->kind).colour.at(0).rgb, Vec3(1, 0.77f, 0.34f));
  EXPECT_EQ(folder.errors(scene(gold, "\"glod\"")), "scene.json:2:11: unknown material \"glod\" (did you mean \"gold\"?)");
  EXPECT_EQ(folder.errors(scene("", "\"silvre\"")), "scene.json:2:11: unknown material \"silvre\" (did you mean \"silver\"?)");
  EXPECT_EQ(folder.errors(scene("", "\"silver\"")), "");
  EXPECT_EQ(folder.errors(scene(gold, "7")), "scene.json:2:11: surface: expected a material (an object with a \"kind\"), found a number");
  EXPECT_EQ(folder.errors(scene("", R"({"kind":"marble","stops":[]})")), "scene.json:2:36: stops may not be empty");
  EXPECT_EQ(folder.errors(scene("", R"({"kind":"transition","from":"marble","to":"wood"})")), "");
  EXPECT_EQ(folder.errors(scene("", R"({"kind":"transition","way":"phase","from":"marble","to":"granite"})")),
            "scene.json:2:67: to: expected a pattern with a phase (marble, wood, strata, stripes), found granite");
  EXPECT_EQ(folder.errors(scene("", R"({"kind":"transition","way":"growth","from":"chrome","to":"gold"})")),
            "scene.json:2:68: to: expected a pattern, found openpbr");
  EXPECT_EQ(folder.errors(scene("", "\"transition\"")).find("scene.json:2:11: unknown material \"transition\"; known: "), 0u);
  // One may be another by name, whichever comes first; but not itself.
  const Scene other = folder.read(scene("\"other\":\"gold\"," + gold, "\"other\""));
  EXPECT_EQ(other.shapes[0].surface, other.materials.at("gold"));
  EXPECT_EQ(folder.errors(scene("\"a\":\"b\",\"b\":\"a\"", "\"a\"")), "scene.json:2:34: material \"a\" is made of itself");
  EXPECT_EQ(folder.read(scene(gold, "\"gold\""), {{"materials.gold.kind=matte"}, {}}).shapes[0].surface->kind.index(), 0u);
}

TEST(Units, AreMetres) {
  const SceneFolder folder;
  const std::string text = R"({"kelpie":1,"units":0.001,"shapes":[{"name":"a","field":)" + k_a_point + "}]}";
  EXPECT_EQ(folder.read(text).units, 0.001);
  EXPECT_EQ(folder.read(scene_with_field(k_a_point)).units, 1);
  EXPECT_EQ(folder.errors(text, {{"units=0"}, {}}), "--set units=0: units must be > 0, found 0");
  EXPECT_EQ(folder.errors(text, {{"units=mm"}, {}}), "--set units=mm: units: expected a number, found a string");
}

/// A scene that includes these, with a shape made of the part `drop`.
std::string including(const std::string& files, const std::string& more = "") {
  return "{\"kelpie\":1,\"include\":[" + files + "],\n" + more + "\"shapes\":[{\"name\":\"a\",\"field\":" + instance_of("drop") + "}]}";
}

TEST(Include, BringsPartsAndSurfaces) {
  const SceneFolder folder;
  folder.write("lib/drops.json", R"({"kelpie":1, "include": ["deeper/more.json", "../metals.json"],
    "parts": {"drop": )" + blend_of(instance_of("cloud") + "," + instance_of("own")) +
                                     "}}");
  folder.write("lib/deeper/more.json",
               R"({"kelpie":1, "include": ["../../metals.json"], "parts": {"cloud": {"kind":"blobs","file":"c.ply"}}})");
  folder.write("metals.json", R"({"kelpie":1, "materials": {"gold": {"kind":"metal"}}})");
  std::filesystem::copy_file(folder.path("cloud.ply"), folder.path("lib/deeper/c.ply"));
  const std::string text = including("\"lib/drops.json\"", "\"parts\":{\"own\":" + k_a_point + "},");
  const Scene scene = folder.read(text);
  EXPECT_EQ(scene.parts.size(), 3u);
  EXPECT_EQ(scene.materials.size(), 1u);
  EXPECT_TRUE(std::get<Blobs<AnimatedMode>>(scene.parts.at("cloud")->kind).cloud); // relative to the file that names it
  // --set reaches it, and may include as well.
  const Scene set = folder.read(text, {{"parts.own.radius=3", "shapes.a.surface=gold"}, {}});
  EXPECT_EQ(std::get<Point<AnimatedMode>>(set.parts.at("own")->kind).radius.at(0), 3);
  EXPECT_EQ(set.shapes[0].surface->kind.index(), 1u);
  EXPECT_EQ(folder.errors(including(""), {{"include=[\"lib/drops.json\"]", "parts.own=" + k_a_point}, {}}), "");
}

TEST(Include, TheHashSeesAllFiles) {
  const SceneFolder folder;
  const auto hash = [&](const std::string& inner) {
    folder.write("lib/inner.json", inner);
    folder.write("lib/outer.json", R"({"kelpie":1, "include": ["inner.json"]})");
    return folder.read(including("\"lib/outer.json\"")).hash;
  };
  const std::string one = R"({"kelpie":1,"parts":{"drop":{"kind":"point","centre":[0,0,0],"radius":1}}})";
  EXPECT_EQ(hash(one), hash("/* the same */ " + one));
  EXPECT_NE(hash(one), hash(R"({"kelpie":1,"parts":{"drop":{"kind":"point","centre":[0,0,0],"radius":2}}})"));
  std::filesystem::copy_file(folder.path("cloud.ply"), folder.path("lib/c.ply"));
  const std::string cloud = R"({"kelpie":1,"parts":{"drop":{"kind":"blobs","file":"c.ply"}}})", before = hash(cloud);
  std::ofstream(folder.path("lib/c.ply"), std::ios::app) << " "; // one byte more
  EXPECT_NE(hash(cloud), before);
}

TEST(Include, RefusesCyclesAndWhatIsOutside) {
  const SceneFolder folder, other;
  folder.write("lib/a.json", "{\"kelpie\":1,\n\"include\":[\"b.json\"]}");
  folder.write("lib/b.json", "{\"kelpie\":1,\n\"include\":[\"../lib/a.json\"]}");
  other.write("o.json", "{\"kelpie\":1}");
  std::filesystem::create_symlink(other.path("o.json"), folder.path("link.json"));
  const auto errors = [&](const std::string& file) { return folder.errors(including("\"" + file + "\"")); };
  EXPECT_EQ(errors("scene.json"), "scene.json:1:24: include: a cycle: scene.json > scene.json");
  EXPECT_EQ(errors("lib/a.json"), "lib/b.json:2:12: include: a cycle: lib/a.json > lib/b.json > lib/a.json");
  for (const std::string& path : {std::string("../o.json"), other.path("o.json"), std::string("link.json"), std::string("/dev/zero")}) {
    const std::string text = including("\"" + path + "\"");
    EXPECT_EQ(folder.errors(text).find("scene.json:1:24: include: "), 0u);
    EXPECT_NE(folder.errors(text).find("lies outside the scene's folder (--allow-path permits it)"), std::string::npos) << path;
    EXPECT_EQ(folder.status(text), ExitStatus::bad_data);
  }
  other.write("o.json", "{\"kelpie\":1,\"parts\":{\"drop\":" + k_a_point + "}}");
  EXPECT_EQ(folder.errors(including("\"link.json\""), {{}, {other.path("")}}), "");
  // A file within a library is confined to the scene's folder, not to the library's.
  folder.write("lib/a.json", R"({"kelpie":1,"parts":{"drop":{"kind":"blobs","file":"../cloud.ply"}}})");
  EXPECT_EQ(errors("lib/a.json"), "");
  folder.write("lib/a.json", R"({"kelpie":1,"parts":{"drop":{"kind":"blobs","file":"../../cloud.ply"}}})");
  EXPECT_EQ(errors("lib/a.json"), "lib/a.json:1:52: file: \"../../cloud.ply\" lies outside the scene's folder (--allow-path permits it)");
}

TEST(Include, ReportsProblemsOfAllFilesInOneGo) {
  const SceneFolder folder;
  folder.write("lib/parts.json", "{\"kelpie\":1,\n \"parts\":{\"drop\":{\"kind\":\"point\",\"centre\":[0,0,0],\"radius\":-1}}}");
  EXPECT_EQ(folder.errors("{\"kelpie\":1,\"include\":[\"lib/parts.json\"],\n\"camra\":{},\n\"film\":{\"spp\":0},\n"
                          "\"shapes\":[{\"name\":\"a\",\"field\":" +
                          instance_of("dorp") + "}]}"),
            "lib/parts.json:2:60: radius must be > 0, found -1\n"
            "scene.json:2:1: unknown key \"camra\" (did you mean \"camera\"?)\n"
            "scene.json:3:15: spp must be >= 1 and <= 1048576, found 0\n"
            "scene.json:4:55: unknown part \"dorp\" (did you mean \"drop\"?)");
}

TEST(Include, RefusesWhatIsNoLibrary) {
  const SceneFolder folder;
  const auto errors = [&](const std::string& library, const std::string& more = "") {
    folder.write("lib.json", library);
    return folder.errors(including("\"lib.json\"", more));
  };
  const std::string drop = "\"parts\":{\"drop\":" + k_a_point + "}";
  EXPECT_EQ(errors("{\"kelpie\":1," + drop + "}"), "");
  EXPECT_EQ(errors("{" + drop + "}"), "lib.json:1:1: missing key \"kelpie\" of library");
  EXPECT_EQ(errors("{\"kelpie\":1,\"shapes\":[]," + drop + "}"),
            "lib.json:1:13: unknown key \"shapes\"; known: kelpie, $schema, units, include, variables, materials, parts, recipes");
  EXPECT_EQ(errors("{\"kelpie\":1,\"units\":0.01," + drop + "}"), "lib.json:1:21: units are 0.01 here, but 1 in the scene");
  EXPECT_EQ(errors("{\"kelpie\":1,\"units\":0.01," + drop + "}", "\"units\":0.01,"), "");
  EXPECT_EQ(errors("{\"kelpie\":1,\"materials\":7," + drop + "}"), "lib.json:1:25: materials: expected an object, found a number");
  EXPECT_EQ(errors("{\"kelpie\":1," + drop + "}", drop + ","), "lib.json:1:22: two parts are called \"drop\" (the other: scene.json:2:10)");
  EXPECT_EQ(errors("{\"kelpie\":1,\"include\":7," + drop + "}"), "lib.json:1:23: include: expected a list, found a number");
  // Where a file is not read, nothing is said about the names that it might have brought.
  EXPECT_EQ(errors("{\"kelpie\":1,\n"), "lib.json:2:1: the text ends where the '{' of line 1 is not closed yet");
  EXPECT_EQ(folder.errors(including("\"none.json\"")), "scene.json:1:24: include: \"none.json\" does not exist (none.json)");
  EXPECT_EQ(folder.status(including("\"none.json\"")), ExitStatus::missing_input);
  EXPECT_EQ(folder.errors(including("\"lib\"")), "scene.json:1:24: include: \"lib\" does not exist (lib)");
  EXPECT_EQ(folder.errors(including("7")), "scene.json:1:24: include: expected a string, found a number\n"
                                           "scene.json:2:55: unknown part \"drop\": the scene has no parts");
}

TEST(Include, KeepsToItsLimits) {
  const SceneFolder folder;
  for (int i = 0; i < 40; ++i) folder.write(fmt::format("l{}.json", i), fmt::format("{{\"kelpie\":1,\"include\":[\"l{}.json\"]}}", i + 1));
  const std::string errors = folder.errors(including("\"l0.json\""));
  EXPECT_EQ(errors.find("l15.json:1:24: include: more than 16 files include one another"), 0u) << errors;
}

TEST(Schema, KnowsPartsAndLibraries) {
  ProblemList problems;
  const JsonValue root = parse_document(json_schema(), "schema", problems).root;
  for (const char* key : {"units", "include", "materials", "parts"}) {
    EXPECT_TRUE(root.find("properties")->find(key)) << key;
    EXPECT_TRUE(root.find("$defs")->find("library")->find("properties")->find(key)) << key;
  }
  EXPECT_EQ(*root.find("properties")->find("parts")->find("additionalProperties")->find("$ref")->string(), "#/$defs/field");
  const JsonValue& surface = *root.find("$defs")->find("shape")->find("properties")->find("surface");
  EXPECT_EQ(surface.find("anyOf")->array()->size(), 2u);
  EXPECT_NE(manual_page("shape").find("material or the name of one of the scene's `materials`"), std::string::npos);
  EXPECT_NE(manual_page("library").find("include"), std::string::npos);
}

} // namespace
} // namespace kelpie
