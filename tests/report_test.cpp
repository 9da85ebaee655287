// `kelpie report` as a user runs it.
#include <nlohmann/json.hpp>

#include "base/file_bytes.h"
#include "tests/support/program.h"

namespace kelpie {
namespace {

constexpr const char* k_scene = R"({ "kelpie": 1, "frames": { "first": 1, "last": 9 },
  "film": { "resolution": [96, 64], "spp": 1 },
  "shapes": [
    { "name": "drops", "field": { "kind": "blend", "children": [
      { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 3, "falloff": "quartic" },
      { "kind": "point", "radius": 0.8, "weight": 2, "falloff": "quartic", "centre": { "keys": [[1, [1.4, 0.4, 0]], [9, [0.6, 0.4, 0]]] } }] } },
    { "name": "stone", "field": { "kind": "sdf_box", "centre": [0, -1, 0], "size": [1, 1, 1] } },
    { "name": "floor", "geometry": { "kind": "plane", "position": [0, -2, 0] } }] })";

class Report : public ProgramTest {
protected:
  Report() { write("scene.json", k_scene); }
  std::string refusal(const std::string& arguments, int status) const {
    const Outcome o = kelpie("report " + arguments);
    EXPECT_EQ(o.status, status) << o.err;
    return o.err;
  }
};

TEST_F(Report, WritesAPageAndNumbers) {
  const Outcome o = kelpie("report scene.json --subject drops --resolution 24 -o a.html --json a.json --progress none");
  ASSERT_EQ(o.status, 0) << o.err;
  EXPECT_EQ(o.err, "");
  EXPECT_NE(o.out.find("vanishes: it merges with a larger one, at (1.3"), std::string::npos) << o.out;
  const std::string page = read_file_bytes(path("a.html"));
  for (const char* part : {"<!DOCTYPE html>", "drops of scene.json", "<polyline", "data:image/png;base64,iVBORw0KGgo", "it merges"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_EQ(page.find("http"), std::string::npos) << "nothing is fetched from elsewhere";
  const auto numbers = nlohmann::json::parse(read_file_bytes(path("a.json")));
  ASSERT_EQ(numbers["frames"].size(), 9u);
  EXPECT_EQ(numbers["subject"], "drops");
  EXPECT_EQ(numbers["frames"][0]["components"], 2);
  EXPECT_EQ(numbers["frames"][8]["components"], 1);
  EXPECT_EQ(numbers["frames"][8]["genus"], 0);
  EXPECT_EQ(numbers["frames"][0]["to_first"]["largest"], 0);
  EXPECT_EQ(file_count(), 3u); // nothing else is left
}

TEST_F(Report, DoesNotDependOnThreads) {
  for (const std::string threads : {"1", "3"})
    ASSERT_EQ(kelpie("report scene.json --subject drops -f 4-6 --resolution 24 --json t" + threads + ".json -j " + threads).status, 0);
  EXPECT_EQ(read_file_bytes(path("t1.json")), read_file_bytes(path("t3.json")));
}

// Bumps are measured of the surface, however the camera blurs it.
TEST_F(Report, SeesTheSurfaceSharp) {
  const auto bumps = [&](const char* name, const std::string& more) {
    EXPECT_EQ(kelpie(std::string("report scene.json --subject drops -f 4 --resolution 24 --json ") + name + more).status, 0);
    return nlohmann::json::parse(read_file_bytes(path(name)))["frames"][0]["bumps"];
  };
  EXPECT_EQ(bumps("sharp.json", ""), bumps("blurred.json", " --set camera.aperture=0.5 --set camera.focus=2 --set camera.shutter=1"));
}

TEST_F(Report, SaysWhatIsWrong) {
  EXPECT_EQ(refusal("scene.json", 2), "error: which shape? --subject names one of drops, stone\n");
  EXPECT_EQ(refusal("scene.json --subject drop", 2), "error: no shape with a field is called \"drop\" (did you mean \"drops\"?)\n");
  EXPECT_EQ(refusal("scene.json --subject floor", 2), "error: no shape with a field is called \"floor\"; known: drops, stone\n");
  EXPECT_EQ(refusal("scene.json --subject drops -f 5-12", 2), "error: -f: frame 10 is not one of the scene's, which are 1 to 9\n");
  EXPECT_EQ(refusal("none.json", 66).substr(0, 16), "error: none.json");
  write("bare.json", R"({"kelpie":1,"shapes":[{"name":"floor","geometry":{"kind":"plane"}}]})");
  EXPECT_EQ(refusal("bare.json", 65), "error: bare.json: no shape has a field that could be measured\n");
  EXPECT_EQ(refusal("scene.json --subject drops -o /proc/none/a.html", 74).substr(0, 6), "error:");
  EXPECT_EQ(file_count(), 2u);
}

TEST_F(Report, WritesBothFilesOrNone) {
  ASSERT_EQ(shell("mkdir taken.json"), 0);
  EXPECT_EQ(kelpie("report scene.json --subject drops -f 1 --resolution 8 -o a.html --json taken.json").status, 74);
  EXPECT_FALSE(std::filesystem::exists(path("a.html")));
}

} // namespace
} // namespace kelpie
