// Values that follow a formula, and the variables of a scene.
#include <cmath>
#include <numbers>
#include <thread>

#include <fmt/format.h>

#include "scene/expression.h"
#include "scene/formula.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

double value_of(const std::string& text, double frame = 0) { return Expression(text).at(frame); }

std::string problem_of(const std::string& text) {
  try {
    Expression{text};
    return "";
  } catch (const Error& e) {
    return e.problems[0].message;
  }
}

/// A scene whose only shape is a point of that radius; `variables` is an object or empty.
std::string scene_of(const std::string& radius, const std::string& variables = "") {
  return fmt::format("{{\"kelpie\":1,\"frames\":{{\"first\":1,\"last\":24}},{}\"shapes\":[{{\"name\":\"a\",\"field\":\n"
                     "{{\"kind\":\"point\",\"centre\":[0,0,0],\"radius\":{}}}}}]}}",
                     variables.empty() ? "" : "\"variables\":\n" + variables + ",", radius);
}
std::string formula(std::string_view text) { return fmt::format("{{\"expression\":\"{}\"}}", text); }

Point<SampledMode> point_at(const Scene& scene, double frame) {
  return std::get<Point<SampledMode>>(sample(scene, frame).shapes[0].field.nodes[0]);
}
float radius_at(const Scene& scene, double frame) { return point_at(scene, frame).radius; }

TEST(Expression, HasTheUsualFunctions) {
  EXPECT_DOUBLE_EQ(value_of("1 + 2*3^2"), 19);
  EXPECT_DOUBLE_EQ(value_of("-2^2"), -4);
  EXPECT_DOUBLE_EQ(value_of("frame/4", 3), 0.75);
  EXPECT_DOUBLE_EQ(value_of("0.3*sin(2*pi*frame/48)", 12), 0.3);
  EXPECT_DOUBLE_EQ(value_of("floor(-1.5) + ceil(0.2) + round(2.6)"), 2);
  EXPECT_DOUBLE_EQ(value_of("fract(-0.25)"), 0.75);
  EXPECT_DOUBLE_EQ(value_of("mod(-1, 4) + mod(9, 4)"), 4);
  EXPECT_DOUBLE_EQ(value_of("clamp(5, 0, 1) + clamp(-5, 0, 1) + clamp(0.5, 0, 1)"), 1.5);
  EXPECT_DOUBLE_EQ(value_of("mix(2, 4, 0.25)"), 2.5);
  EXPECT_DOUBLE_EQ(value_of("smoothstep(1, 3, 2) + smoothstep(1, 3, 0) + smoothstep(1, 3, 9)"), 1.5);
  EXPECT_DOUBLE_EQ(value_of("frame >= 3 && frame < 5 ? 7 : 8", 3), 7);
  EXPECT_DOUBLE_EQ(value_of("frame == 3 ? 7 : 8", 2), 8);
  EXPECT_DOUBLE_EQ(value_of("min(3, 1, 2) + max(3, 1, 2) + pow(2, 3) + atan2(0, 1)"), 12);
  EXPECT_TRUE(std::isnan(value_of("sqrt(frame)", -1)));
}

TEST(Expression, NoiseIsSmoothAndOfUnitVariance) {
  const Expression noise("noise(frame)");
  double sum = 0, squares = 0, steepest = 0;
  constexpr int k_count = 20000;
  for (int i = 0; i < k_count; ++i) {
    const double v = noise.at(i * 0.37);
    sum += v, squares += v * v;
    steepest = std::max(steepest, std::abs(noise.at(i * 0.37 + 1e-3) - v) / 1e-3);
  }
  EXPECT_NEAR(sum / k_count, 0, 0.1);
  EXPECT_NEAR(squares / k_count, 1, 0.3);
  EXPECT_LT(steepest, 20);
}

TEST(Expression, SaysWhatIsWrong) {
  EXPECT_EQ(problem_of(""), "expression: it is empty");
  EXPECT_EQ(problem_of("  "), "expression: it is empty");
  EXPECT_EQ(problem_of("3 *"), "expression: it ends too early");
  EXPECT_EQ(problem_of("sin(frame"), "expression: a ')' is missing");
  EXPECT_EQ(problem_of("(1))"), "expression: \")\" is not expected at character 4");
  EXPECT_EQ(problem_of("3 4"), "expression: \"4\" is not expected at character 3");
  EXPECT_EQ(problem_of("sine(frame)"), "expression: unknown function \"sine\" (did you mean \"sin\"?)");
  EXPECT_EQ(problem_of("sin(1, 2)"), "expression: sin() takes fewer values");
  EXPECT_EQ(problem_of("max()"), "expression: max() takes more values");
  EXPECT_EQ(problem_of("frame ? 1"), "expression: a '?' without its ':'");
  EXPECT_EQ(problem_of("1, 2"), "expression: expected one value, found 2");
  EXPECT_EQ(problem_of("frame = 3"), "expression: '=' is not expected: two values are compared by '=='");
  EXPECT_EQ(problem_of(std::string(5000, '(')), "expression: more than 2000 characters");
  for (const std::string text : {"\"abc\"", "#", "!frame", "frame %% 3", "é", "1..2", "()", "a b", "frame frame"})
    EXPECT_TRUE(problem_of(text).starts_with("expression: ")) << text << ": " << problem_of(text);
}

TEST(Expression, IsTheSameFromManyThreads) {
  const Expression wave("sin(frame) + 2*cos(frame/3)");
  std::vector<std::thread> threads;
  std::atomic<int> wrong{0};
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 5000; ++i) {
        const double frame = 0.01 * i + t;
        wrong += wave.at(frame) != std::sin(frame) + 2 * std::cos(frame / 3);
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

TEST(Formulas, MoveNumbersAndComponents) {
  const SceneFolder folder;
  const Scene scene = folder.read(scene_of(formula("1 + 0.5*sin(pi*frame/12)")));
  for (const double frame : {1.0, 2.5, 6.0, 300.0})
    EXPECT_FLOAT_EQ(radius_at(scene, frame), float(1 + 0.5 * std::sin(std::numbers::pi * frame / 12)));
  const std::string centre = R"(shapes.a.field.centre=[1, {"expression":"frame/2"}, {"keys":[[1,0],[3,4]]}])";
  EXPECT_EQ(point_at(folder.read(scene_of("1"), {{centre}, {}}), 2).centre, Vec3(1, 1, 2));
  const std::string colour = R"(shapes.a.surface={"kind":"matte","colour":[{"expression":"frame/24"},0,1]})";
  const FrameScene at_12 = sample(folder.read(scene_of("1"), {{colour}, {}}), 12);
  EXPECT_EQ(std::get<Matte<SampledMode>>(at_12.materials[at_12.shapes[0].surface.index]).colour.rgb, Vec3(0.5f, 0, 1));
}

TEST(Formulas, ThatDoNotMoveAreConstants) {
  const SceneFolder folder;
  const auto moves = [&](const std::string& radius, const std::string& variables = "") {
    return bool(sample(folder.read(scene_of(radius, variables)), 1).moment);
  };
  EXPECT_FALSE(moves(formula("2*pi")));
  EXPECT_FALSE(moves(formula("2*a"), R"({"a":3})"));
  EXPECT_TRUE(moves(formula("2*a"), R"({"a":{"keys":[[1,1],[2,2]]}})"));
  EXPECT_TRUE(moves(formula("frame")));
}

TEST(Formulas, LiveInTheTimeOfTheirNode) {
  const Scene scene = SceneFolder().read(R"j({"kelpie":1,"frames":{"first":10,"last":20},
    "parts":{"p":{"kind":"point","centre":[0,0,0],"radius":{"expression":"1 + abs(frame)"}}},
    "shapes":[{"name":"a","field":{"kind":"instance","of":"p","time_offset":4,"time_scale":2}}]})j");
  EXPECT_EQ(radius_at(scene, 10), 13);
  EXPECT_EQ(radius_at(scene, 10.5), 14);
}

TEST(Variables, AreNumbersCurvesAndFormulasInAnyOrder) {
  const SceneFolder folder;
  const std::string variables = R"({"c":{"expression":"a*b"},"a":2,"b":{"keys":[[1,1],[3,5]]},"unused":{"expression":"c+1"}})";
  EXPECT_FLOAT_EQ(radius_at(folder.read(scene_of(formula("c + 1"), variables)), 2), 7);
  EXPECT_FLOAT_EQ(radius_at(folder.read(scene_of(formula("c + 1"), variables), {{"variables.a=3"}, {}}), 2), 10);
  EXPECT_FLOAT_EQ(radius_at(folder.read(scene_of(formula("late")), {{R"(variables.late={"expression":"frame+1"})"}, {}}), 2), 3);
}

TEST(Variables, OfTheCommandLineThatNothingAsksForAreSaid) {
  const SceneFolder folder;
  folder.write("scene.json", scene_of(formula("height"), R"({"height":2,"unused":3})"));
  const auto warnings = [&](const std::string& set) {
    Diagnostics diagnostics;
    read_scene(folder.path("scene.json"), {{set}, {}}, diagnostics);
    return diagnostics.warnings().empty() ? "" : diagnostics.warnings()[0].message;
  };
  EXPECT_EQ(warnings("variables.height=3"), "");
  EXPECT_EQ(warnings("variables.hieght=3"), "no expression uses the variable \"hieght\" (did you mean \"height\"?)");
}

TEST(Variables, ComeFromLibraries) {
  const SceneFolder folder;
  folder.write("lib.json", R"({"kelpie":1,"variables":{"size":4},
    "parts":{"p":{"kind":"point","centre":[0,0,0],"radius":{"expression":"size/2"}}}})");
  const std::string scene = R"({"kelpie":1,"include":["lib.json"],"shapes":[{"name":"a","field":{"kind":"instance","of":"p"}}]})";
  EXPECT_EQ(radius_at(folder.read(scene), 1), 2);
  EXPECT_EQ(radius_at(folder.read(scene, {{"variables.size=6"}, {}}), 1), 3);
}

TEST(Formulas, AreRefusedWhereTheyCannotBeUsed) {
  const SceneFolder folder;
  const auto errors = [&](const std::string& text, const std::string& variables = "") {
    return folder.errors(scene_of(formula(text), variables));
  };
  const auto in_field = [](std::string_view what) { return fmt::format("scene.json:2:57: {}", what); };
  EXPECT_EQ(errors("fram + 1"), in_field("expression: unknown name \"fram\" (did you mean \"frame\"?)"));
  EXPECT_EQ(errors("sin + 1"), in_field("expression: unknown name \"sin\"; known: frame, pi"));
  EXPECT_EQ(errors("speed"), in_field("expression: unknown name \"speed\"; known: frame, pi"));
  EXPECT_EQ(errors("1 +"), in_field("expression: it ends too early"));
  EXPECT_EQ(errors("frame - 20"), in_field("radius must be > 0: the expression is -19 at frame 1"));
  EXPECT_EQ(errors("1/(frame-1)"), in_field("radius: the expression has no value at frame 1"));
  EXPECT_EQ(errors("sqrt(6 - frame)").substr(0, 70), in_field("radius must be > 0: the expression is 0 at frame 6").substr(0, 70));
  EXPECT_EQ(folder.errors(scene_of(R"({"expression":3})")), in_field("expression: expected a string, found a number"));
  EXPECT_EQ(folder.errors(scene_of(R"({"expression":"1","frames":2})")), "scene.json:2:61: unknown key \"frames\"; known: expression");
  EXPECT_EQ(folder.errors(scene_of("1"), {{R"(shapes.a.field.centre={"expression":"1"})"}, {}}),
            "--set shapes.a.field.centre={\"expression\":\"1\"}: centre: an expression is one number; give one for each component");
  EXPECT_EQ(folder.errors(scene_of("1"), {{R"(shapes.a.field.centre=[0,{"expression":"1"}])"}, {}}),
            "--set shapes.a.field.centre=[0,{\"expression\":\"1\"}]: centre: expected three components, found 2 values");
}

TEST(Variables, AreRefusedWhereTheyCannotBeUsed) {
  const SceneFolder folder;
  const auto errors = [&](const std::string& variables) { return folder.errors(scene_of(formula("1"), variables)); };
  EXPECT_EQ(errors(R"({"a":{"expression":"a"}})"), "scene.json:2:6: variable \"a\" depends on itself: a -> a");
  EXPECT_EQ(errors(R"({"c":{"expression":"a"},"a":{"expression":"b"},"b":{"expression":"2*a"}})"),
            "scene.json:2:29: variable \"a\" depends on itself: a -> b -> a");
  EXPECT_EQ(errors(R"({"frame":1})"), "scene.json:2:10: \"frame\" is the frame, in every expression");
  EXPECT_EQ(errors(R"({"sin":1})"), "scene.json:2:8: \"sin\" is known to expressions already");
  EXPECT_EQ(errors(R"({"pi":3})"), "scene.json:2:7: \"pi\" is known to expressions already");
  EXPECT_EQ(errors(R"({"my speed":1})"), "scene.json:2:13: \"my speed\" is no name for a variable: letters, digits and '_' make one");
  EXPECT_EQ(errors(R"({"a":"fast"})"), "scene.json:2:6: variables: expected a number, found a string");
  std::string chain = R"({"v0":1)";
  for (int i = 1; i <= 100; ++i) chain += fmt::format(R"(,"v{}":{{"expression":"v{}"}})", i, i - 1);
  EXPECT_EQ(errors(chain + "}"), "") << "read from the first on, each depends on one that is known";
  // Each asks for twice as many values as the one before.
  chain = R"({"v0":{"expression":"frame"},"v1":{"expression":"frame"})";
  for (int i = 2; i <= 40; ++i) chain += fmt::format(R"(,"v{}":{{"expression":"v{} + v{}"}})", i, i - 1, i - 2);
  EXPECT_NE(errors(chain + "}").find("expression: it asks for more than 2000 values, by its variables"), std::string::npos);
  chain = R"({"v100":1)";
  for (int i = 99; i >= 0; --i) chain = fmt::format(R"({{"v{}":{{"expression":"v{}"}},)", i, i + 1) + chain.substr(1);
  EXPECT_NE(errors(chain + "}").find("more than 64 variables that depend on one another"), std::string::npos);
}

// What was not looked at when the scene was read is an error of the frame, with its place.
TEST(Formulas, AreCheckedAtEveryFrame) {
  const Scene scene = SceneFolder().read(scene_of(formula("100 - frame")));
  EXPECT_EQ(radius_at(scene, 99), 1);
  try {
    sample(scene, 100);
    ADD_FAILURE() << "a radius of 0";
  } catch (const Error& e) {
    EXPECT_EQ(e.status, ExitStatus::bad_data);
    EXPECT_EQ(e.problems[0].message, "radius must be > 0: the expression is 0 at frame 100");
    EXPECT_EQ(e.problems[0].where.line, 2);
  }
}

TEST(Curves, ThatGoOnAreCheckedAtEveryFrame) {
  const SceneFolder folder;
  EXPECT_EQ(folder.errors(scene_of(R"({"keys":[[1,5],[2,4]],"after":"continue"})")), "");
  const Scene scene = folder.read(scene_of(R"({"keys":[[1,5],[2,4]],"after":"continue"})"));
  EXPECT_EQ(radius_at(scene, 5), 1);
  EXPECT_THROW(sample(scene, 6), Error);
}

// Where a straight line between two moments of a shutter would not follow the formula.
TEST(Formulas, NameWhereTheyJumpAndTurn) {
  const auto breaks = [](const std::string& text, double from, double to) { return Formula(Expression(text), {0}).breaks(from, to); };
  EXPECT_TRUE(breaks("frame", 0, 1).empty());
  EXPECT_TRUE(breaks("3", 0, 1).empty());
  EXPECT_TRUE(breaks("sin(frame)", 0.2, 0.8).empty());
  const auto is_near = [](const std::vector<double>& found, double at, double tolerance) {
    return std::any_of(found.begin(), found.end(), [&](double f) { return std::abs(f - at) < tolerance; });
  };
  EXPECT_TRUE(is_near(breaks("floor(frame)", 9.7, 10.4), 10, 1e-6));
  EXPECT_TRUE(is_near(breaks("frame < 10.123 ? 1 : 2", 9.7, 10.4), 10.123, 1e-6));
  EXPECT_TRUE(is_near(breaks("abs(frame - 10)", 9.7, 10.4), 10, 0.02));
  EXPECT_TRUE(is_near(breaks("max(0, frame - 10)", 9.7, 10.4), 10, 0.02));
  EXPECT_EQ(breaks("sin(2*pi*4*frame)", 0, 1).size(), 8u) << "two turns a wave";
}

} // namespace
} // namespace kelpie
