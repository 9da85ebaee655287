// Recipes: named variations of a scene, and the sheets that show them.
#include "scene/reader.h"
#include "tests/support/program.h"

namespace kelpie {
namespace {

class Recipes : public ProgramTest {
protected:
  static std::string scene(const std::string& recipes) {
    return R"({ "kelpie": 1, "film": { "resolution": [16, 8], "spp": 1 },
  "shapes": [ { "name": "ball", "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1 } } ])" +
           recipes + " }";
  }
  Scene read(const ReadOptions& options) const {
    Diagnostics diagnostics;
    return read_scene(path("scene.json"), options, diagnostics);
  }
  float threshold(const std::string& recipe, const std::vector<std::string>& set = {}) const {
    return read({set, {}, true, recipe}).shapes[0].threshold.at(0);
  }
};

constexpr const char* k_recipes = R"(,
  "recipes": { "thick": { "shapes.ball.threshold": 0.5 }, "thin": { "shapes.ball.threshold": 1.5, "film.spp": 3 } })";

TEST_F(Recipes, ChangeWhatTheyName) {
  write("scene.json", scene(k_recipes));
  EXPECT_EQ(threshold(""), 1);
  EXPECT_EQ(threshold("thick"), 0.5f);
  EXPECT_EQ(threshold("thin"), 1.5f);
  EXPECT_EQ(threshold("thin", {"shapes.ball.threshold=1.75"}), 1.75f) << "--set comes last";
  EXPECT_EQ(read({{}, {}, true, "thin"}).film.spp, 3);
}

// So that a further recipe makes no picture anew.
TEST_F(Recipes, AreNoPartOfAPictureUnlessTheyAreTaken) {
  write("scene.json", scene(""));
  const std::string without = read({}).hash;
  write("scene.json", scene(k_recipes));
  EXPECT_EQ(read({}).hash, without);
  EXPECT_NE(read({{}, {}, true, "thick"}).hash, without);
}

TEST_F(Recipes, MayBeIncluded) {
  write("more.json", R"({ "kelpie": 1, "recipes": { "flat": { "shapes.ball.threshold": 1.25 } } })");
  write("scene.json", scene(std::string(k_recipes) + R"(, "include": ["more.json"])"));
  EXPECT_EQ(threshold("flat"), 1.25f);
  EXPECT_EQ(read_recipe_names(path("scene.json"), {}), (std::vector<std::string>{"thick", "thin", "flat"}));
  write("scene.json", scene(""));
  ReadOptions options{{}, {}, true, "flat", {path("more.json")}};
  EXPECT_EQ(read(options).shapes[0].threshold.at(0), 1.25f);
}

TEST_F(Recipes, ThatAreWrongAreProblems) {
  const auto error = [&](const std::string& recipes, const std::string& name) {
    write("scene.json", scene(recipes));
    const Outcome o = kelpie("check scene.json --recipe " + name);
    EXPECT_EQ(o.status, 65);
    return o.err;
  };
  EXPECT_EQ(error(k_recipes, "thik"), "error: --recipe thik: there is none of that name (did you mean \"thick\"?)\n");
  EXPECT_EQ(error("", "thick"), "error: --recipe thick: the scene has no recipes\n");
  EXPECT_EQ(error(R"(, "recipes": { "a": 1 })", "a"),
            "error: scene.json:2:119: a recipe is an object of paths and values, as --set has them; this is a number\n");
  EXPECT_EQ(error(R"(, "recipes": { "a": { "shapes.bal.threshold": 1 } })", "a"),
            "error: scene.json:2:121: shapes has no element \"bal\" (did you mean \"ball\"?)\n");
  EXPECT_EQ(error(R"(, "recipes": [])", "a"), "error: --recipe a: the scene has no recipes\n"
                                              "error: scene.json:2:112: recipes: expected an object, found a list\n");
}

TEST_F(Recipes, MakeSheetsThatGoOn) {
  write("scene.json", scene(k_recipes));
  ASSERT_EQ(kelpie("sheet scene.json --all-recipes --width 32 -o all.png --progress none").status, 0);
  EXPECT_TRUE(std::filesystem::exists(path("all.png")) && std::filesystem::exists(path("all_tiles/thick.exr")) &&
              std::filesystem::exists(path("all_tiles/thin.exr")));
  const auto before = std::filesystem::last_write_time(path("all_tiles/thin.exr"));
  ASSERT_EQ(kelpie("sheet scene.json --all-recipes --width 32 -o all.png --progress none").status, 0);
  EXPECT_EQ(std::filesystem::last_write_time(path("all_tiles/thin.exr")), before) << "it was there";
  ASSERT_EQ(kelpie("sheet scene.json --across 'shapes.ball.threshold=0.5|1|1.5' --down 'frame=1|2' --width 16 -o table.png --progress none")
                .status,
            0);
  EXPECT_TRUE(std::filesystem::exists(path("table_tiles/row_02_column_03.exr")));
}

TEST_F(Recipes, AreDrawnAtRandomForMetamorphoses) {
  write("scene.json", scene(""));
  const Outcome none = kelpie("sheet scene.json --random 3 -o random.png");
  EXPECT_EQ(none.status, 65);
  EXPECT_EQ(none.err, "error: scene.json: random recipes are drawn for features, and there is no metamorphosis with elements\n");
  EXPECT_EQ(kelpie("sheet scene.json --pairs -o no.png").err,
            "error: scene.json: pairs are those of the objects of one metamorphosis, and there is none\n");
  const std::string one = R"({ "field": { "kind": "sdf_sphere", "centre": [0, 0, 0], "sphere_radius": 1 },
    "elements": [ { "name": "left_ear", "centre": [-1, 0, 0], "size": 1 }, { "name": "right_ear", "centre": [1, 0, 0], "size": 1 } ] })";
  write("scene.json",
        R"({ "kelpie": 1, "shapes": [ { "name": "a", "field": { "kind": "metamorphosis", "objects": [ )" + one + ", " + one + " ] } } ] }");
  ASSERT_EQ(kelpie("sheet scene.json --random 3 --seed 5 --width 16 --spp 1 -o random.png --progress none").status, 0);
  const std::string drawn = text_of(path("random_tiles/recipes.json"));
  ASSERT_EQ(kelpie("sheet scene.json --random 3 --seed 5 --width 16 --spp 1 -o again.png --progress none").status, 0);
  EXPECT_EQ(text_of(path("again_tiles/recipes.json")), drawn);
  EXPECT_EQ(kelpie("check scene.json --recipes random_tiles/recipes.json --recipe random_003").status, 0);
  ASSERT_EQ(kelpie("sheet scene.json --pairs --width 16 --spp 1 -o pairs.png --progress none").status, 0);
  EXPECT_TRUE(std::filesystem::exists(path("pairs_tiles/pair_2_1.exr")));
  EXPECT_NE(text_of(path("pairs_tiles/recipes.json")).find("\"shapes.0.field.objects.1.weight\": 3"), std::string::npos);
  EXPECT_EQ(kelpie("sheet scene.json -o no.png").status, 2);
  EXPECT_EQ(kelpie("sheet scene.json --random 3 --all-recipes -o no.png").status, 2);
  EXPECT_EQ(kelpie("sheet scene.json --random 3 -f 1-3 -o no.png").status, 2);
  EXPECT_EQ(kelpie("sheet random_tiles/random_001.exr --random 3 -o no.png").status, 2);
  EXPECT_EQ(kelpie("sheet random_tiles/random_001.exr --set film.spp=2 -o no.png").status, 2);
  EXPECT_EQ(kelpie("sheet scene.json --recipe none -o no.png").status, 65);
  EXPECT_FALSE(std::filesystem::exists(path("no.png")) || std::filesystem::exists(path("no_tiles")));
}

} // namespace
} // namespace kelpie
