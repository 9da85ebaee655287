// `kelpie match` as a user runs it.
#include <algorithm>
#include <set>

#include <nlohmann/json.hpp>

#include "base/file_bytes.h"
#include "tests/support/program.h"

namespace kelpie {
namespace {

using Json = nlohmann::json;

/// A foot becomes two claws, and a wing comes out of nothing; a hand stands below a warp.
constexpr const char* k_creature = R"({ "name": "creature", "field": {
  "kind": "animorphosis", "progress": { "keys": [[1, 0], [9, 1]] },
  "from": { "kind": "blend", "children": [
    { "kind": "point", "name": "head", "centre": [0, 1, 0], "radius": 1 },
    { "kind": "point", "name": "foot", "centre": [0, -1, 0], "radius": 1 },
    { "kind": "translate", "name": "arm", "by": { "keys": [[1, [2, 0, 0]], [9, [2, 8, 0]]] },
      "child": { "kind": "point", "name": "hand", "centre": [0, 0, 0], "radius": 0.5 } } ] },
  "to": { "kind": "blend", "children": [
    { "kind": "point", "name": "left claw", "centre": [0, -1, 1], "radius": 0.5 },
    { "kind": "point", "name": "right claw", "centre": [0, -1, -1], "radius": 0.5 },
    { "kind": "point", "name": "skull", "centre": [0, 1.2, 0], "radius": 1 },
    { "kind": "translate", "name": "leg", "by": [2, 0, 0], "child": { "kind": "box", "name": "paw", "centre": [0, 0, 0], "size": [0.4, 0.2, 0.3], "radius": 0.5 } },
    { "kind": "blend", "name": "wing", "children": [
      { "kind": "point", "centre": [0, 0, 2], "radius": 0.5 }, { "kind": "point", "centre": [0, 0, 3], "radius": 0.5 } ] } ] },
  "pairs": [{ "from": "foot", "to": "left claw" }, { "from": "foot", "to": "right claw" }, { "from": "hand", "to": "paw" }] } })";

/// Two things that have nothing in common, and inside the one another animorphosis.
constexpr const char* k_stone = R"({ "name": "stone", "field": {
  "kind": "animorphosis", "progress": 0.5,
  "from": { "kind": "intersection", "children": [
    { "kind": "point", "centre": [0, 0, 0], "radius": 1 },
    { "kind": "animorphosis", "progress": 0.2, "from": { "kind": "point", "centre": [0, 0, 0], "radius": 1 },
      "to": { "kind": "box", "centre": [0, 0, 0], "size": [1, 1, 1], "radius": 1 } } ] },
  "to": { "kind": "intersection", "children": [
    { "kind": "point", "centre": [0, 0, 0], "radius": 1 }, { "kind": "point", "centre": [0, 1, 0], "radius": 1 },
    { "kind": "point", "centre": [0, 2, 0], "radius": 1 } ] } } })";

constexpr const char* k_drop = R"({ "name": "drop", "field": {
  "kind": "liquid", "from": "a.ply", "to": "b.ply", "volume": "free", "progress": 0.5 } })";

constexpr const char* k_floor = R"({ "name": "floor", "geometry": { "kind": "plane" } })";

class Match : public ProgramTest {
protected:
  void write_scene(const std::string& shapes) const {
    write("scene.json", R"({ "kelpie": 1, "frames": { "first": 1, "last": 9 }, "shapes": [
)" + shapes + " ] }");
  }
  /// What it says of one shape.
  Json match(const std::string& arguments) const {
    const Outcome o = kelpie("match scene.json " + arguments + " -o out.json");
    EXPECT_EQ(o.status, 0) << o.err;
    EXPECT_EQ(o.err, "");
    return Json::parse(read_file_bytes(path("out.json")))["matches"];
  }
  std::string refusal(const std::string& arguments, int status) const {
    const Outcome o = kelpie("match " + arguments);
    EXPECT_EQ(o.status, status) << o.err;
    EXPECT_EQ(file_count(), 1u) << "nothing but the scene";
    return o.err;
  }
};

/// The parts of a match in which a side has a name.
std::vector<Json> parts_called(const Json& match, const char* side, const std::string& name) {
  std::vector<Json> found;
  for (const Json& part : match["parts"])
    if (part.contains(side) && part[side]["name"] == name) found.push_back(part);
  return found;
}

TEST_F(Match, SaysWhatIsForcedAndWhatIsFound) {
  write_scene(k_creature);
  const Json creature = match("")[0];
  EXPECT_EQ(creature["where"], "scene.json:2:32");
  EXPECT_EQ(creature["compared_at"], 5);
  const Json hand = parts_called(creature, "from", "hand").at(0), arm = parts_called(creature, "from", "arm").at(0);
  EXPECT_EQ(hand["by"], "pair");
  EXPECT_EQ(hand["to"]["name"], "paw");
  EXPECT_EQ(hand["level"], 2);
  EXPECT_EQ(creature["parts"].at(hand["within"].get<size_t>()), arm);
  EXPECT_EQ(arm["by"], "pair") << "what stands above a pair is forced, too";
  EXPECT_EQ(arm["to"]["name"], "leg");
  const Json head = parts_called(creature, "from", "head").at(0);
  EXPECT_EQ(head["to"]["name"], "skull");
  EXPECT_EQ(head["by"], "difference");
  EXPECT_GT(head["difference"], 0);
  EXPECT_EQ(head["from"]["kind"], "point");
  EXPECT_EQ(head["from"]["where"], "scene.json:5:5");
  const Json& roots = creature["parts"][0];
  EXPECT_EQ(roots["by"], "place");
  EXPECT_EQ(roots["within"], nullptr);
  EXPECT_EQ(roots["from"]["leaves"], 3);
}

TEST_F(Match, SharesOfWhatIsDividedSumToOne) {
  write_scene(k_creature);
  double sum = 0;
  std::set<std::string> names;
  for (const Json& foot : parts_called(match("")[0], "from", "foot")) {
    sum += foot["from"]["share"].get<double>();
    names.insert(foot["to"]["name"]);
    EXPECT_EQ(foot["to"]["share"], 1);
    EXPECT_EQ(foot["from"]["node"], 2) << "the same node, after the two roots' and the head's";
  }
  EXPECT_DOUBLE_EQ(sum, 1);
  EXPECT_EQ(names, (std::set<std::string>{"left claw", "right claw"}));
}

TEST_F(Match, SaysWhatGrowsAndFromWhere) {
  write_scene(k_creature);
  const Json wing = parts_called(match("")[0], "to", "wing").at(0);
  EXPECT_EQ(wing["fate"], "grows");
  EXPECT_FALSE(wing.contains("from"));
  EXPECT_EQ(wing["place"], (Json{0, -0.5, 1.5})) << "where it is nearest to the left claw";
}

TEST_F(Match, ShowsPlacesAtAFrameAndThroughWarps) {
  write_scene(k_creature);
  EXPECT_EQ(parts_called(match("")[0], "from", "hand").at(0)["from"]["centre"], (Json{2, 4, 0}));
  EXPECT_EQ(parts_called(match("-f 9")[0], "from", "hand").at(0)["from"]["centre"], (Json{2, 8, 0}));
}

TEST_F(Match, SaysWhatIsExchangedAndFindsNestedOnes) {
  write_scene(std::string(k_creature) + ",\n" + k_stone);
  const Json stones = match("stone");
  ASSERT_EQ(stones.size(), 2u);
  EXPECT_EQ(stones[0]["where"], "scene.json:21:5") << "the inner one";
  EXPECT_EQ(stones[0]["parts"][0]["to"]["kind"], "box");
  EXPECT_EQ(stones[1]["parts"].size(), 1u);
  EXPECT_EQ(stones[1]["parts"][0]["fate"], "exchanged");
  EXPECT_EQ(match("creature").size(), 1u);
}

TEST_F(Match, SavesTheMorphAsAnOrdinaryScene) {
  write_scene(std::string(k_creature) + ",\n" + k_stone);
  const Outcome o = kelpie("match scene.json creature --save-scene keyed.json");
  EXPECT_EQ(o.status, 0) << o.err;
  EXPECT_NE(o.out.find("keyed.json: 2 trees for its animorphoses, with "), std::string::npos) << o.out;
  const std::string saved = read_file_bytes(path("keyed.json"));
  EXPECT_EQ(saved.find("animorphosis"), std::string::npos);
  EXPECT_EQ(kelpie("check keyed.json").status, 0);
  const Json field = Json::parse(saved)["shapes"][0]["field"];
  EXPECT_EQ(field["kind"], "blend");
  const auto moves = [](const Json& child) { return child.dump().find("\"keys\"") != std::string::npos; };
  EXPECT_TRUE(std::any_of(field["children"].begin(), field["children"].end(), moves));
}

TEST_F(Match, RefusesToSaveWhatItCannot) {
  write_scene(k_creature);
  EXPECT_EQ(refusal("scene.json", 2), "error: say -o OUT.json, -o OUT.svg, or --save-scene OUT.json\n");
  EXPECT_EQ(refusal("scene.json --save-scene k.json -o k.json", 2), "error: -o and --save-scene: both are to be k.json\n");
  EXPECT_NE(refusal("scene.json --save-scene k.svg", 2).find("\"k.svg\" must end in .json"), std::string::npos);
  EXPECT_EQ(refusal("scene.json --save-scene scene.json", 2), "error: --save-scene: that is the scene itself\n");
  EXPECT_EQ(refusal("scene.json --save-scene k.json --set frames.last=5", 2),
            "error: --save-scene writes what the file says: it goes with neither --set nor --recipe\n");
  EXPECT_NE(refusal("scene.json --save-scene /tmp/k.json", 2).find("it names files relative to"), std::string::npos);
}

TEST_F(Match, SaysHowMuchOfALiquidFlowsWhere) {
  write_scene(k_drop);
  const auto cloud = [](const std::string& count, const std::string& blobs) {
    return "ply\nformat ascii 1.0\nelement vertex " + count +
           "\nproperty float x\nproperty float y\nproperty float z\nproperty float radius\nproperty float weight\nend_header\n" + blobs;
  };
  write("a.ply", cloud("1", "0 0 0 1 2\n"));
  write("b.ply", cloud("2", "1 0 0 0.8 2\n-1 0 0 0.8 2\n"));
  const Json drop = match("")[0];
  EXPECT_EQ(drop["kind"], "liquid");
  ASSERT_EQ(drop["parts"].size(), 2u);
  double sum = 0;
  for (const Json& part : drop["parts"]) {
    sum += part["amount"].get<double>();
    EXPECT_EQ(part["from"]["centre"], (Json{0, 0, 0}));
    EXPECT_EQ(std::abs(part["to"]["centre"][0].get<double>()), 1);
    EXPECT_FLOAT_EQ(part["to"]["radius"].get<float>(), 0.8f);
  }
  EXPECT_NEAR(sum, 1, 1e-9);
  ASSERT_EQ(kelpie("match scene.json -o out.svg").status, 0);
  EXPECT_NE(read_file_bytes(path("out.svg")).find("scene.json:2:28: liquid of drop"), std::string::npos);
  // Each passage by itself.
  const Outcome o =
      kelpie("match scene.json -o out.json --set 'shapes.drop.field.through=[\"b.ply\"]' --set 'shapes.drop.field.to=\"a.ply\"'");
  EXPECT_NE(o.out.find("liquid of drop, passage 2 of 2: 2 parts\n"), std::string::npos) << o.out << o.err;
  const Json both = Json::parse(read_file_bytes(path("out.json")))["matches"];
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[1]["passage"], 2);
  EXPECT_EQ(both[1]["parts"][0]["to"]["centre"], (Json{0, 0, 0}));
}

TEST_F(Match, DrawsBothEnds) {
  write_scene(k_creature);
  const Outcome o = kelpie("match scene.json -o out.svg");
  ASSERT_EQ(o.status, 0) << o.err;
  EXPECT_EQ(o.out, "scene.json:2:32: animorphosis of creature: 4 forced, 1 found, 0 by division, 1 by their places; 0 shrink, 1 grow, 0 "
                   "exchanged\n");
  const std::string svg = read_file_bytes(path("out.svg"));
  EXPECT_EQ(svg.substr(0, 5), "<svg ");
  for (const char* text : {">foot</text>", ">left claw</text>", ">wing</text>", "foot (1 of 2) to right claw, forced, difference",
                           "<title>wing grows</title>", "class=\"way\"", "class=\"link\""})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
}

TEST_F(Match, SaysWhatIsWrong) {
  write_scene(std::string(k_creature) + ",\n" + k_stone + ",\n" + k_floor);
  EXPECT_EQ(refusal("scene.json -o a.json", 2), "error: which shape? One of creature, stone\n");
  EXPECT_EQ(refusal("scene.json ston -o a.json", 2), "error: no shape is called \"ston\" (did you mean \"stone\"?)\n");
  EXPECT_EQ(refusal("scene.json floor -o a.json", 2),
            "error: \"floor\" has no animorphosis or liquid: of all shapes only creature, stone\n");
  EXPECT_EQ(refusal("scene.json stone -f 10 -o a.json", 2), "error: -f: frame 10 is not one of the scene's, which are 1 to 9\n");
  EXPECT_EQ(refusal("scene.json stone -o a.png", 2), "error: --output: \"a.png\" must end in .json or .svg\n");
  EXPECT_EQ(refusal("none.json stone -o a.svg", 66).substr(0, 16), "error: none.json");
  EXPECT_EQ(refusal("scene.json stone -o /proc/none/a.svg", 74).substr(0, 6), "error:");
  write_scene(k_floor);
  EXPECT_EQ(refusal("scene.json -o a.json", 65), "error: scene.json: no shape has an animorphosis or a liquid\n");
}

} // namespace
} // namespace kelpie
