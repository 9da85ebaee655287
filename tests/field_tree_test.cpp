// What tables lead to: children in lists and records, references, numbers wherever they stand; and the one way through a field tree.
#include <gtest/gtest.h>

#include "base/sample_record.h"
#include "field/motion.h"
#include "morph/field_fold.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

/// A record that holds a field, a part and numbers.
template <class Mode>
struct MadeUpFeature {
  typename Mode::Child where{};
  Value<Mode, float> share{1.f};
  typename Mode::Reference of{};
  std::vector<Value<Mode, Vec3>> places;

  static constexpr auto parameters() {
    using F = MadeUpFeature;
    return std::tuple{parameter("where", &F::where, "").as(Role::weight), parameter("share", &F::share, ""), parameter("of", &F::of, ""),
                      parameter("places", &F::places, "")};
  }
};

/// A kind with all that a table can lead to.
template <class Mode>
struct MadeUp {
  typename Mode::Children children;
  std::vector<MadeUpFeature<Mode>> features;
  std::vector<Value<Mode, float>> weights;
  typename Mode::Child region{};
  int count = 0;
  std::shared_ptr<const int> loaded;

  static constexpr auto parameters() {
    using M = MadeUp;
    return std::tuple{parameter("children", &M::children, ""), parameter("features", &M::features, ""),
                      parameter("weights", &M::weights, ""), parameter("region", &M::region, "").as(Role::region),
                      parameter("count", &M::count, "")};
  }
  static constexpr auto assets() { return std::tuple{&MadeUp::loaded}; }
};

FieldPtr leaf() { return std::make_shared<FieldNode>(); }

MadeUp<AnimatedMode> made_up() {
  const auto rising = [](float from) { return Animated<float>({{0, from, {}}, {10, from + 10, {}}}, Interpolation::linear); };
  MadeUp<AnimatedMode> kind;
  kind.children = {leaf(), leaf()};
  kind.features.resize(2);
  for (auto& feature : kind.features) feature.where = leaf(), feature.of.target = leaf(), feature.share = rising(1);
  kind.features[1].places = {Animated<Vec3>({{0, Vec3(0), {}}, {10, Vec3(10), {}}}, Interpolation::linear), Vec3(7)};
  kind.weights = {rising(2), 5.f, rising(3)};
  kind.region = leaf(), kind.count = 9;
  kind.loaded = std::make_shared<const int>(1);
  return kind;
}

TEST(Tables, LeadToEveryEdge) {
  const MadeUp<AnimatedMode> kind = made_up();
  std::vector<const FieldNode*> found;
  std::vector<Role> roles;
  for_each_edge(kind, [&]<class Edge>(const Edge& edge, const ParameterRules& rules) {
    if constexpr (std::is_same_v<Edge, PartReference>)
      found.push_back(edge.target.get());
    else
      found.push_back(edge.get());
    roles.push_back(rules.role);
  });
  const MadeUpFeature<AnimatedMode>&a = kind.features[0], &b = kind.features[1];
  const std::vector<const FieldNode*> expected{kind.children[0].get(), kind.children[1].get(), a.where.get(),    a.of.target.get(),
                                               b.where.get(),          b.of.target.get(),      kind.region.get()};
  EXPECT_EQ(found, expected);
  EXPECT_EQ(roles, (std::vector{Role::child, Role::child, Role::weight, Role::child, Role::weight, Role::child, Role::region}));
}

TEST(Tables, AreSampledThroughout) {
  const std::vector<unsigned> nodes{10, 11, 12, 13, 14, 15, 16};
  const MadeUp<AnimatedMode> animated = made_up();
  const MadeUp<SampledMode> at_5 = sample_record(animated, 5, nodes.data());
  std::vector<unsigned> edges;
  for_each_edge(at_5, [&](unsigned node, const ParameterRules&) { edges.push_back(node); });
  EXPECT_EQ(edges, nodes);
  EXPECT_EQ(at_5.weights, (std::vector{7.f, 5.f, 8.f}));
  EXPECT_EQ(at_5.features[1].share, 6);
  EXPECT_EQ(at_5.features[1].places, (std::vector{Vec3(5), Vec3(7)}));
  EXPECT_EQ(at_5.count, 9);
  EXPECT_EQ(at_5.loaded, animated.loaded);
}

// No number of a kind stands because of where it is kept.
TEST(Tables, MoveThroughout) {
  const std::vector<unsigned> nodes(7, 1);
  const auto at = [&](double frame) { return sample_record(made_up(), frame, nodes.data()); };
  const MadeUp<SampledMode> a = at(0), b = at(10), middle = interpolated(a, b, 0.5);
  EXPECT_EQ(middle.weights, at(5).weights);
  EXPECT_EQ(middle.features[0].share, at(5).features[0].share);
  EXPECT_EQ(middle.features[1].places, at(5).features[1].places);
  EXPECT_TRUE(is_same(a, at(0)));
  const auto differs = [&](const auto& change) {
    MadeUp<SampledMode> other = a;
    change(other);
    return !is_same(a, other);
  };
  EXPECT_TRUE(differs([](auto& k) { k.weights[2] += 1; }));
  EXPECT_TRUE(differs([](auto& k) { k.features[1].share += 1; }));
  EXPECT_TRUE(differs([](auto& k) { k.features[1].places[0].y += 1; }));
}

TEST(Kinds, AreEqualWithAllTheyLoaded) {
  Blobs<SampledMode> a, b;
  a.cloud = b.cloud = std::make_shared<const BlobCloud>(1);
  EXPECT_TRUE(is_equal(a, b));
  b.cloud = std::make_shared<const BlobCloud>(1);
  EXPECT_FALSE(is_equal(a, b));
}

// --- through a tree ---

const std::string k_twice = R"({"kelpie":1,
  "parts":{"drop":{"kind":"point","centre":[0,0,0],"radius":1},
           "pair":{"kind":"blend","children":[{"kind":"instance","of":"drop"},{"kind":"instance","of":"drop","time_offset":1}]}},
  "shapes":[{"name":"a","field":{"kind":"local_blend",
    "children":[{"kind":"instance","of":"pair"},{"kind":"instance","of":"pair","time_offset":1},{"kind":"instance","of":"drop","time_offset":2}],
    "region":{"kind":"disc","centre":[0,0,0],"normal":[0,1,0],"disc_radius":1,"radius":1}}}]})";

/// The kinds of the nodes that are visited, in order.
std::vector<std::string_view> visited(const FieldNode& root, PartsShared shared) {
  std::vector<std::string_view> names;
  FieldFold<int> fold(shared);
  fold(root, [&](const FieldNode&, const auto& kind, auto&&...) {
    names.push_back(kind.k_name);
    return 0;
  });
  return names;
}

TEST(FieldFold, VisitsPartsOnceForEachTime) {
  const SceneFolder folder;
  const Scene scene = folder.read(k_twice);
  const FieldNode& root = *scene.shapes[0].field;
  const auto count = [](const std::vector<std::string_view>& names, std::string_view name) {
    return std::count(names.begin(), names.end(), name);
  };
  const std::vector<std::string_view> once = visited(root, PartsShared::always), in_time = visited(root, PartsShared::in_one_time);
  EXPECT_EQ(count(once, "point"), 1);
  EXPECT_EQ(count(once, "blend"), 1);
  EXPECT_EQ(count(in_time, "point"), 3); // 0, 1 and 2 frames late
  EXPECT_EQ(count(in_time, "blend"), 2);
  EXPECT_EQ(count(in_time, "disc"), 1);
  EXPECT_EQ(in_time.back(), "local_blend");
}

// Messages about a sampled node are about the right node of the file.
TEST(FieldFold, IsTheOrderOfSampledNodes) {
  const SceneFolder folder;
  const Scene scene = folder.read(k_twice);
  std::vector<std::string_view> sampled;
  const FrameScene frame = sample(scene, 1);
  for (const auto& node : frame.shapes[0].field.nodes)
    sampled.push_back(std::visit([](const auto& kind) { return kind.k_name; }, node));
  EXPECT_EQ(sampled, visited(*scene.shapes[0].field, PartsShared::in_one_time));
}

// What is below is given to a node in the order of its edges.
TEST(FieldFold, GivesResultsInTheOrderOfEdges) {
  const SceneFolder folder;
  const Scene scene = folder.read(k_twice);
  FieldFold<std::string> fold(PartsShared::always);
  const std::string all =
      fold(*scene.shapes[0].field, [](const FieldNode&, const auto& kind, const TimeMap&, std::span<const std::string> below) {
        std::string text(kind.k_name.substr(0, 2));
        for (const std::string& part : below) text += "(" + part + ")";
        return text;
      });
  EXPECT_EQ(all, "lo(in(bl(in(po))(in(po))))(in(bl(in(po))(in(po))))(in(po))(di)");
}

// --- time ---

TEST(TimeMaps, ComposeAndInvert) {
  const TimeMap outer{2, 4}, inner{-1, 0.5}, both = outer.then(inner);
  for (const double frame : {-3.0, 0.0, 2.5, 11.0}) {
    EXPECT_EQ(both.at(frame), inner.at(outer.at(frame)));
    EXPECT_EQ(both.frame_of(both.at(frame)), frame);
  }
  EXPECT_EQ(TimeMap{}.then(outer), outer);
  const TimeMap far{1e300, 1e-3}, back{-1e300, 1e-3};
  EXPECT_TRUE(std::isfinite(TimeMap{}.then(far).then(back).then(far).offset));
}

TEST(TimeMaps, ScaleTheTimeOfInstances) {
  const SceneFolder folder;
  const std::string moving = R"({"kind":"point","centre":{"keys":[[1,[0,0,0]],[3,[2,0,0]]]},"radius":1})";
  const Scene scene =
      folder.read("{\"kelpie\":1,\"parts\":{\"drop\":" + moving +
                  R"(},"shapes":[{"name":"a","field":{"kind":"instance","of":"drop","time_offset":10,"time_scale":0.25}}]})");
  // Its keys are at 10 + 4 and 10 + 12.
  for (const auto& [frame, x] : {std::pair{12.0, 0.f}, {14.0, 0.f}, {18.0, 1.f}, {22.0, 2.f}, {30.0, 2.f}})
    EXPECT_EQ(std::get<Point<SampledMode>>(sample(scene, frame).shapes[0].field.nodes[0]).centre.x, x) << frame;
  for (const double at : {14.0, 22.0}) EXPECT_EQ(sample(scene, at).breaks, std::vector<double>{at});
  EXPECT_TRUE(sample(scene, 13).breaks.empty());
}

} // namespace
} // namespace kelpie
