// Morphs as ordinary key-framed models: keys that are merged, and scenes that are saved.
#include <cmath>

#include "morph/tree/computed.h"
#include "morph/tree/merged_keys.h"
#include "scene/generic_scene.h"
#include "tests/support/written_trees.h"

namespace kelpie {
namespace {

/// A curve from frame 1 to 25 or so, of any mode but steps.
Animated<float> random_curve(Random& r, double low, double high, int most_order) {
  std::vector<Key<float>> keys;
  double frame = r.uniform(0.5, 3);
  const int count = 2 + r.below(4), order = 1 + r.below(most_order);
  for (int i = 0; i < count; ++i, frame += r.uniform(1, 8)) {
    Key<float> key(frame, float(r.uniform(low, high)));
    for (int j = 1; j < order; ++j) key.derivatives.push_back(float(r.uniform(-0.2, 0.2)));
    keys.push_back(key);
  }
  const Interpolation how = order > 1 ? Interpolation::hermite
                                      : std::array{Interpolation::linear, Interpolation::smooth, Interpolation::spline}[size_t(r.below(3))];
  return {keys, how};
}

double how_far_apart(const Animated<float>& a, const Animated<float>& b, double first, double last) {
  double most = 0;
  for (int i = 0; i <= 2000; ++i) {
    const double frame = first + (last - first) * i / 2000;
    most = std::max(most, std::abs(double(a.at(frame)) - double(b.at(frame))));
  }
  return most;
}

// (1 - s) a + s b of curves of up to order 3, s a cubic: exact at the keys and between them, by no more keys than all three have, and
// those at both ends of the frames.
TEST(MergedKeys, OfMixturesAreExactAndNoMoreThanThoseOfAllThree) {
  Random r(5);
  for (int trial = 0; trial < 400; ++trial) {
    SCOPED_TRACE(trial);
    const Animated<float> a = random_curve(r, -2, 2, 3), b = random_curve(r, -2, 2, 3);
    const Animated<float> s(random_curve(r, 0, 1, 1).curve()->keys(),
                            Interpolation::smooth); // stays in [0, 1], and so has no other corners
    const Animated<float> c = mixed(a, b, s);
    const MergedKeys<float> merged = merged_keys(c, 0, 30);
    double largest = 0;
    for (int i = 0; i <= 300; ++i) largest = std::max(largest, std::abs(double(c.at(0.1 * i))));
    ASSERT_LE(merged.keys.size(), a.frames().size() + b.frames().size() + s.frames().size() + 2);
    // Of a curve with derivatives, float numbers lose more than 1e-6 where large terms nearly cancel.
    ASSERT_LT(merged.error, 1e-5 * largest);
    ASSERT_LT(how_far_apart(c, {merged.keys, Interpolation::hermite}, 0, 30), 2e-5 * largest);
    for (const Key<float>& key : merged.keys) ASSERT_EQ(key.value, c.at(key.frame));
  }
}

TEST(MergedKeys, TakeNoHigherOrderThanTheyNeed) {
  const Animated<float> line({{1, 0.f}, {9, 4.f}}, Interpolation::linear), still({{1, 2.f}, {9, 2.f}}, Interpolation::linear);
  const MergedKeys<float> merged = merged_keys(mixed<float>(line, still, 0.25f), 0, 10);
  ASSERT_EQ(merged.keys.size(), 4u);
  for (const Key<float>& key : merged.keys) EXPECT_TRUE(key.derivatives.empty() && key.before().empty());
}

// A step is two keys; what is no polynomial is halved until it is nearly one, and so is what has a corner of which no break tells.
TEST(MergedKeys, OfStepsAndOfOtherFunctionsAreNearlyThese) {
  const Animated<float> step({{2, 1.f}, {5, 3.f}, {8, 2.f}}, Interpolation::step), one({{1, 0.f}, {9, 1.f}}, Interpolation::smooth);
  const Animated<float> stepped = mixed<float>(step, 5.f, one);
  const MergedKeys<float> steps = merged_keys(stepped, 0, 10);
  for (const double frame : {1.0, 3.0, 4.9999, 5.0, 5.0001, 7.0, 8.5, 9.5})
    EXPECT_NEAR(Animated<float>(steps.keys, Interpolation::hermite).at(frame), stepped.at(frame), 1e-5) << frame;
  const auto wave = computed<float>([](float t) { return std::sin(9 * t) + std::abs(t - 0.31f); }, one);
  const MergedKeys<float> waves = merged_keys(wave, 0, 10);
  EXPECT_GT(waves.keys.size(), 4u);
  EXPECT_LT(waves.keys.size(), 80u);
  EXPECT_LT(how_far_apart(wave, {waves.keys, Interpolation::hermite}, 0, 10), 1.2 * waves.error + 1e-5);
  EXPECT_LT(waves.error, 1e-5);
}

TEST(MergedKeys, OfDirectionsAndColours) {
  const Animated<Vec3> a({{1, Vec3(0, 1, 0)}, {9, Vec3(1, 2, 0)}}, Interpolation::smooth);
  const Animated<float> s({{2, 0.f}, {8, 1.f}}, Interpolation::smooth);
  const Animated<Vec3> turning = turned(a, Vec3(1, 0, 0.2f), s);
  const Animated<Vec3> merged(merged_keys(turning, 0, 10).keys, Interpolation::hermite);
  const auto colour = mixed<Colour>(Colour{Vec3(0.1f, 0.5f, 0.9f)}, Colour{Vec3(1, 0, 0.3f)}, s);
  const Animated<Colour> colours(merged_keys(colour, 0, 10).keys, Interpolation::hermite);
  for (int i = 0; i <= 100; ++i) {
    EXPECT_LT(glm::distance(merged.at(0.1 * i), turning.at(0.1 * i)), 1e-5) << i;
    EXPECT_LT(glm::distance(colours.at(0.1 * i).rgb, colour.at(0.1 * i).rgb), 1e-6) << i;
  }
}

// A saved morph is an ordinary scene: it is read, and its field is the same at any moment.
TEST(GenericScene, IsTheMorphAtAnyMoment) {
  const SceneFolder folder;
  const Values values(120);
  size_t curves = 0;
  for (unsigned seed = 300; seed < 360; ++seed) {
    SCOPED_TRACE(seed);
    RandomTree random(seed, true);
    const std::string progress = R"({"keys":[[2,0],[8,1]],"interpolation":"smooth"})";
    const std::string from = random.tree(1 + int(seed % 3)), to = random.tree(1 + int(seed / 3 % 3));
    folder.write("scene.json", scene_with(morph_of(from, to, progress)));
    Diagnostics diagnostics;
    std::vector<GrownTree> trees;
    const Scene morph = read_scene_and_trees(folder.path("scene.json"), {}, diagnostics, trees);
    const GenericScene generic = generic_scene(folder.path("scene.json"), morph, trees);
    ASSERT_EQ(generic.trees, 1u);
    ASSERT_EQ(generic.text.find("animorphosis"), std::string::npos);
    curves += generic.curves;
    const Scene saved = folder.read(generic.text);
    for (const double frame : {1.0, 2.0, 3.3, 5.0, 6.85, 8.0, 9.0}) {
      ASSERT_LT(largest_difference(values(saved, frame), values(morph, frame)), 1e-5) << frame << "\n" << from << "\n" << to;
    }
  }
  EXPECT_GT(curves, 1000u);
}

TEST(GenericScene, KeepsTheNamesOfMaterialsAndSaysWhereThereIsNothingToSave) {
  const SceneFolder folder;
  const auto saved = [&](const std::string& field) {
    folder.write("scene.json",
                 "{\"kelpie\":1,\"materials\":{\"red\":{\"kind\":\"matte\"}},\"shapes\":[{\"name\":\"a\",\"field\":" + field + "}]}");
    Diagnostics diagnostics;
    std::vector<GrownTree> trees;
    const Scene scene = read_scene_and_trees(folder.path("scene.json"), {}, diagnostics, trees);
    return generic_scene(folder.path("scene.json"), scene, trees).text;
  };
  const std::string point = R"({"kind":"point","centre":[0,0,0],"radius":1,"material":"red"})";
  const std::string text = saved(morph_of(point, point, "0.5"));
  EXPECT_NE(text.find(R"("material":"red")"), std::string::npos) << text;
  EXPECT_EQ(text.find("matte 1"), std::string::npos) << text;
  try {
    saved(point);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("no shape has an animorphosis"), std::string::npos);
  }
}

} // namespace
} // namespace kelpie
