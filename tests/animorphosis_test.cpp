// Trees that become one another: exact at the ends, continuous between.
#include <cmath>

#include "morph/tree/skeleton_graph.h"
#include "tests/support/written_trees.h"

namespace kelpie {
namespace {

/// At both ends the field is that of the end alone. Returns how far it is from both half way.
double expect_exact_ends(const SceneFolder& folder, const std::string& from, const std::string& to, double frame, const Values& values) {
  const Scene a = folder.read(scene_with(from)), b = folder.read(scene_with(to));
  for (const auto& [progress, end] : {std::pair("0", &a), std::pair("1", &b)}) {
    const Scene morph = folder.read(scene_with(morph_of(from, to, progress)));
    EXPECT_LT(largest_difference(values(morph, frame), values(*end, frame)), 1e-5) << progress << "\n" << from << "\n" << to;
  }
  const std::vector<double> halfway = values(folder.read(scene_with(morph_of(from, to, "0.5"))), frame);
  return std::min(largest_difference(halfway, values(a, frame)), largest_difference(halfway, values(b, frame)));
}

TEST(Animorphosis, OfAnyTwoSkeletonsIsExactAtBothEnds) {
  const SceneFolder folder;
  const Values values(200);
  RandomTree random(7, true);
  int changes = 0;
  for (int i = 0; i < RandomTree::k_leaf_kinds; ++i)
    for (int j = 0; j < RandomTree::k_leaf_kinds; ++j)
      changes += expect_exact_ends(folder, random.leaf(i), random.leaf(j), 1 + (i + j) % 9, values) > 0.1;
  EXPECT_GT(changes, RandomTree::k_leaf_kinds * RandomTree::k_leaf_kinds * 9 / 10) << "what does not change is exact for nothing";
}

TEST(Animorphosis, OfAnyTwoTreesIsExactAtBothEnds) {
  const SceneFolder folder;
  const Values values(300);
  int changes = 0;
  for (unsigned seed = 1; seed <= 120; ++seed) {
    RandomTree random(seed, true);
    const std::string from = random.tree(1 + int(seed % 3)), to = random.tree(1 + int(seed / 3 % 3));
    changes += expect_exact_ends(folder, from, to, 1 + seed % 9, values) > 0.1;
  }
  EXPECT_GT(changes, 100);
}

/// Between the ends nothing jumps: no step is much larger than most, and half as large a step changes half as much.
void expect_continuous(const SceneFolder& folder, const std::string& from, const std::string& to, const Values& values) {
  const Scene morph = folder.read(scene_with(morph_of(from, to, R"j({"expression":"clamp(frame/1000,0,1)"})j")));
  constexpr int k_steps = 250;
  std::vector<double> before = values(morph, 0);
  double sum = 0, most = 0, at = 0;
  for (int i = 1; i <= k_steps; ++i) {
    const double frame = 1000.0 * i / k_steps;
    std::vector<double> now = values(morph, frame);
    const double step = largest_difference(before, now);
    sum += step;
    if (step > most) most = step, at = frame;
    before = std::move(now);
  }
  ASSERT_LT(most, 20 * sum / k_steps) << from << "\n" << to << "\nat " << at;
  const double middle = at - 500.0 / k_steps, quarter = 250.0 / k_steps;
  const double half = std::max(largest_difference(values(morph, middle - quarter), values(morph, middle)),
                               largest_difference(values(morph, middle), values(morph, middle + quarter)));
  ASSERT_LT(half, 0.8 * most) << "a jump at " << at << "\n" << from << "\n" << to;
}

TEST(Animorphosis, OfAnyTwoSkeletonsIsContinuous) {
  const SceneFolder folder;
  const Values values(150);
  RandomTree random(8, false);
  for (int i = 0; i < RandomTree::k_leaf_kinds; ++i)
    for (int j = i % 2; j < RandomTree::k_leaf_kinds; j += 3) expect_continuous(folder, random.leaf(i), random.leaf(j), values);
}

// It has radii, and so a form of its own.
TEST(Animorphosis, OfEllipsoidsIsExactAndContinuous) {
  const SceneFolder folder;
  const Values values(150);
  RandomTree random(9, false);
  const std::string ellipsoid =
      R"({"kind":"ellipsoid","centre":[0.2,0.1,0],"radii":[1.2,0.5,0.8],"axis":[1,2,0],"weight":1.7,"falloff":"quartic"})";
  int changes = 0;
  for (int i = 0; i < RandomTree::k_leaf_kinds; ++i) {
    const std::string other = random.leaf(i);
    changes += expect_exact_ends(folder, ellipsoid, other, 1, values) > 0.1;
    expect_continuous(folder, i % 2 ? ellipsoid : other, i % 2 ? other : ellipsoid, values);
  }
  EXPECT_GT(changes, RandomTree::k_leaf_kinds * 3 / 4);
}

// Places and directions go on beyond the ends, sizes and weights do not.
TEST(Animorphosis, MayOvershoot) {
  const SceneFolder folder;
  const auto ball = [](double x, double radius) {
    return fmt::format(
        R"({{"kind":"translate","by":[{},0,0],"child":{{"kind":"point","centre":[0,0,0],"radius":{},"falloff":"quartic"}}}})", x, radius);
  };
  const std::string progress = R"({"keys":[[1,0],[11,1.25],[21,1],[31,-0.1]]})";
  const std::string text = scene_with(morph_of(ball(-1, 0.5), ball(3, 0.8), progress));
  const Scene scene = folder.read(text);
  for (const auto& [frame, x, radius] :
       {std::tuple(1.0, -1.0, 0.5), std::tuple(11.0, 4.0, 0.8), std::tuple(21.0, 3.0, 0.8), std::tuple(31.0, -1.4, 0.5)}) {
    const SampledShape shape = sample(scene, frame).shapes[0];
    const FieldProgram program = compile(shape.field, shape.threshold);
    ASSERT_EQ(program.blobs.size(), 1u);
    EXPECT_NEAR(program.blobs.x[0], x, 1e-5) << frame;
    EXPECT_NEAR(program.blobs.radius[0], radius, 1e-5) << frame;
  }
  Diagnostics diagnostics;
  const Scene again = read_scene(folder.path("scene.json"), {}, diagnostics);
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_NE(diagnostics.warnings()[0].message.find("progress leaves [0, 1]: 1.25 at frame 11"), std::string::npos)
      << diagnostics.warnings()[0].message;
  EXPECT_NE(folder.errors(scene_with(morph_of(ball(0, 1), ball(1, 1), "2.5"))).find("progress must be >= -1 and <= 2"), std::string::npos);
}

TEST(Animorphosis, OfAnyTwoTreesIsContinuous) {
  const SceneFolder folder;
  const Values values(150);
  for (unsigned seed = 200; seed < 230; ++seed) {
    RandomTree random(seed, false);
    const std::string from = random.tree(1 + int(seed % 2)), to = random.tree(1 + int(seed / 2 % 2));
    expect_continuous(folder, from, to, values);
  }
}

TEST(SkeletonGraph, HasAPathBetweenAnyTwoSkeletons) {
  int paths = 0;
  const auto visit_pairs = [&]<template <class> class From, template <class> class To>() {
    using F = From<SampledMode>;
    using T = To<SampledMode>;
    constexpr auto is_soft = []<class K>() { return (SolidSkeleton<K> || BlobSource<K>)&&!HasAssets<K>; };
    if constexpr (is_soft.template operator()<F>() && is_soft.template operator()<T>()) {
      AnimatedKind from = From<AnimatedMode>{}, to = To<AnimatedMode>{};
      for (AnimatedKind* kind : {&from, &to})
        if (auto* hull = std::get_if<Polyhedron<AnimatedMode>>(kind)) hull->points.resize(5);
      const auto path = skeleton_path(from, to);
      ASSERT_TRUE(path) << F::k_name << " " << T::k_name;
      for (const SkeletonPath::Stage& stage : path->stages) ASSERT_TRUE(mixed_kind(stage.from, stage.to, 0.5f));
      EXPECT_LE(path->stages.size(), 2u);
      EXPECT_EQ(path->cost == 0, from.index() == to.index());
      ++paths;
    }
  };
  FieldFolderKinds::for_each([&]<template <class> class From>() {
    FieldFolderKinds::for_each([&]<template <class> class To>() { visit_pairs.template operator()<From, To>(); });
  });
  EXPECT_EQ(paths, 17 * 17);
  EXPECT_NE(skeleton_graph_dot().find("point -> segment"), std::string::npos);
}

TEST(Correspondence, GoesByPlaceAndByForcedPairs) {
  const SceneFolder folder;
  const auto ball = [](double x, std::string_view name = "") {
    return fmt::format(R"({{"kind":"point","centre":[{},0,0],"radius":0.3{}}})", x,
                       name.empty() ? "" : fmt::format(R"(,"name":"{}")", name));
  };
  const auto blend = [](const std::string& a, const std::string& b) {
    return fmt::format(R"({{"kind":"blend","children":[{},{}]}})", a, b);
  };
  const auto value_at = [&](const std::string& text, double x) {
    const SampledShape shape = sample(folder.read(scene_with(text)), 1).shapes[0];
    const FieldProgram program = compile(shape.field, shape.threshold);
    return evaluate(program, program.code, Point3<double>{x, 0, 0});
  };
  const std::string from = blend(ball(-2, "left"), ball(2, "right")), to = blend(ball(4, "far"), ball(-4, "near"));
  const std::string natural = morph_of(from, to, "0.5");
  EXPECT_NEAR(value_at(natural, -3), 2, 1e-6);
  EXPECT_NEAR(value_at(natural, 3), 2, 1e-6);
  const std::string crossed = morph_of(from, to, "0.5", R"(,"pairs":[{"from":"left","to":"far"}])");
  EXPECT_NEAR(value_at(crossed, 1), 2, 1e-6);
  EXPECT_NEAR(value_at(crossed, -1), 2, 1e-6);
  // One that goes two ways is half of itself on each.
  const std::string divided = morph_of(ball(0, "one"), to, "0.25");
  EXPECT_NEAR(value_at(morph_of(blend(ball(0, "one"), ball(9, "other")), to, "0",
                                R"(,"pairs":[{"from":"one","to":"far"},{"from":"one","to":"near"}])"),
                       0),
              2, 1e-6);
  EXPECT_GT(value_at(divided, -1) + value_at(divided, 1), 1);
  // Each pair in its own time.
  const std::string staggered = morph_of(from, to, "0.5", R"(,"pairs":[{"from":"left","to":"near","progress":0}])");
  EXPECT_NEAR(value_at(staggered, -2), 2, 1e-6);
  EXPECT_NEAR(value_at(staggered, 3), 2, 1e-6);
}

/// What once was not exact, or not even a number: mirrors, what carves, instances in times of their own, axes of other lengths, smooth
/// Booleans, and animorphoses of animorphoses.
TEST(Animorphosis, OfWhatIsUnlikeIsExactAtBothEnds) {
  const SceneFolder folder;
  const Values values(200);
  const auto ball = [](double x, double weight = 2) {
    return fmt::format(R"({{"kind":"point","centre":[{},0.1,0],"radius":0.8,"weight":{}}})", x, weight);
  };
  const auto joined = [](std::string_view kind, const std::vector<std::string>& parts) {
    return fmt::format(R"({{"kind":"{}","children":[{}]}})", kind, fmt::join(parts, ","));
  };
  const auto bent = [&](std::string_view rest, std::string_view deformed) {
    return fmt::format(R"({{"kind":"axial","axes":[{{"rest":[{}],"deformed":[{}],"radius":0.6}}],"child":{}}})", rest, deformed, ball(0.5));
  };
  const std::vector<std::string> trees{
      ball(0.3),
      fmt::format(R"({{"kind":"scale","by":[-1,1,1],"child":{}}})", ball(0.5)),
      fmt::format(R"({{"kind":"bend","angle":60,"length":1,"child":{}}})", ball(0.4)),
      joined("blend", {ball(0), ball(0.4, -1)}),
      joined("union", {ball(-0.3), ball(0.3)}),
      joined("intersection", {ball(-0.2), ball(0.2)}),
      joined("blend", {joined("union", {ball(-0.4), ball(0.2)}), joined("difference", {ball(0.5), ball(0.8)})}),
      bent("[0,0,0],[0.5,0,0],[1,0,0],[1.5,0,0]", "[0,0,0],[0.5,0.1,0],[0.9,0.3,0],[1.2,0.7,0]"),
      bent("[0,0,0],[0.4,0,0],[0.8,0,0],[1.2,0,0],[1.5,0,0]", "[0,0,0],[0.4,0.1,0],[0.8,0.2,0],[1.1,0.5,0],[1.2,0.8,0]"),
      morph_of(ball(-0.5), joined("union", {ball(0), ball(0.6)}), "0.4"),
  };
  for (const std::string& from : trees)
    for (const std::string& to : trees) {
      expect_exact_ends(folder, from, to, 3, values);
      const std::vector<double> halfway = values(folder.read(scene_with(morph_of(from, to, "0.5"))), 3);
      EXPECT_TRUE(std::all_of(halfway.begin(), halfway.end(), [](double v) { return std::isfinite(v); })) << from << to;
    }
}

TEST(Animorphosis, RefusesWhatWouldTakeForEver) {
  const SceneFolder folder;
  std::string nested = R"({"kind":"point","centre":[0,0,0],"radius":1})";
  for (int i = 0; i < 6; ++i) nested = morph_of(nested, R"({"kind":"point","centre":[1,0,0],"radius":1})", "0.5");
  EXPECT_EQ(folder.errors(scene_with(nested)), "");
  nested = morph_of(nested, nested, "0.5");
  EXPECT_NE(folder.errors(scene_with(nested)).find("more than 6 animorphoses in one another"), std::string::npos);
  std::string balls = R"({"kind":"point","centre":[0,0,0],"radius":1})";
  for (int i = 0; i < 1200; ++i) balls += R"(,{"kind":"point","centre":[0,0,0],"radius":1})";
  const std::string many = fmt::format(R"({{"kind":"blend","children":[{}]}})", balls);
  EXPECT_NE(folder.errors(scene_with(morph_of(many, many, "0.5"))).find("operators of 1201 and 1201 parts are too many to match"),
            std::string::npos);
}

TEST(Animorphosis, MaterialsOfOneKindMixTheirNumbersAndOthersDissolve) {
  const SceneFolder folder;
  const auto ball = [](std::string_view material) {
    return fmt::format(R"({{"kind":"point","centre":[0,0,0],"radius":1,"material":{}}})", material);
  };
  const auto material_of = [&](std::string_view from, std::string_view to) {
    const FrameScene frame = sample(folder.read(scene_with(morph_of(ball(from), ball(to), "0.25"))), 1);
    const SampledField& field = frame.shapes[0].field;
    EXPECT_EQ(field.nodes.size(), 1u) << "no leaf is there twice for its material";
    return std::pair(frame.materials[field.materials.at(0).index], frame.materials);
  };
  const std::string_view red = R"({"kind":"matte","colour":[1,0,0]})", blue = R"({"kind":"matte","colour":[0,0,1]})";
  EXPECT_EQ(std::get<Matte<SampledMode>>(material_of(red, blue).first).colour.rgb, Vec3(0.75f, 0, 0.25f));
  const auto [marble, of_marble] =
      material_of(R"({"kind":"marble","size":1,"stops":[{"at":0,"material":{"kind":"matte","colour":[1,1,1]}}]})",
                  R"({"kind":"marble","size":3,"stops":[{"at":1,"material":{"kind":"matte","colour":[0,0,0]}}]})");
  EXPECT_FLOAT_EQ(std::get<Marble<SampledMode>>(marble).size, 1.5f);
  EXPECT_FLOAT_EQ(std::get<Marble<SampledMode>>(marble).stops[0].at, 0.25f);
  const MaterialIndex stop = std::get<Marble<SampledMode>>(marble).stops[0].material;
  EXPECT_EQ(std::get<Matte<SampledMode>>(of_marble[stop.index]).colour.rgb, Vec3(0.75f));
  const auto [other, of_other] = material_of(red, "\"gold\"");
  const auto& transition = std::get<Transition<SampledMode>>(other);
  EXPECT_EQ(transition.way, TransitionWay::dissolve);
  EXPECT_EQ(transition.progress, 0.25f);
  EXPECT_EQ(std::get<Matte<SampledMode>>(of_other[transition.from.index]).colour.rgb, Vec3(1, 0, 0));
}

/// What an instance shows has the instance's time, its materials too.
TEST(Animorphosis, MaterialsKeepTheTimeOfTheirInstance) {
  const SceneFolder folder;
  const std::string turning = R"({"kind":"matte","colour":{"keys":[[1,[0,0,0]],[11,[1,1,1]]]}})";
  const std::string part = fmt::format(R"({{"kind":"point","centre":[0,0,0],"radius":1,"material":{}}})", turning);
  const std::string late = R"({"kind":"instance","of":"p","time_offset":2})";
  const std::string morph =
      morph_of(late, R"({"kind":"point","centre":[0,0,0],"radius":2,"material":{"kind":"matte","colour":[1,0,0]}})", "0.5");
  std::string scene = scene_with(morph);
  scene.insert(scene.find('{') + 1, fmt::format(R"("parts":{{"p":{}}},)", part));
  const FrameScene frame = sample(folder.read(scene), 6);
  const MaterialIndex own = frame.shapes[0].field.materials.at(0);
  EXPECT_NEAR(std::get<Matte<SampledMode>>(frame.materials[own.index]).colour.rgb.y, 0.5f * 0.3f, 1e-6f);
}

/// Between a pattern and a metal the one grows through the other: at s the second has the share s of space, nothing at 0, all at 1.
TEST(Animorphosis, OneMaterialGrowsThroughTheOther) {
  const SceneFolder folder;
  const auto metal_at = [&](std::string_view from, std::string_view to, double progress) {
    const auto ball = [](std::string_view material) {
      return fmt::format(R"({{"kind":"point","centre":[0,0,0],"radius":1,"material":"{}"}})", material);
    };
    const FrameScene frame = sample(folder.read(scene_with(morph_of(ball(from), ball(to), fmt::format("{}", progress)))), 1);
    Random r(5);
    double sum = 0;
    constexpr int k_places = 4000;
    for (int i = 0; i < k_places; ++i) {
      SurfaceMix mix;
      add_material(frame.materials, frame.shapes[0].field.materials.at(0), Vec3(r.in(Box3d{Vec3d(-40), Vec3d(40)})), {}, 1, mix);
      sum += double(mix.sum().base_metalness) / k_places;
    }
    return sum;
  };
  for (const std::string_view pattern : {"granite", "leather", "giraffe", "marble"})
    for (const double s : {1e-6, 0.25, 0.5, 0.75, 1 - 1e-6}) {
      EXPECT_NEAR(metal_at(pattern, "gold", s), s, 0.08) << pattern << " " << s;
      EXPECT_NEAR(metal_at("gold", pattern, s), 1 - s, 0.08) << pattern << " " << s;
    }
}

TEST(Animorphosis, RefusesWhatCannotCorrespond) {
  const SceneFolder folder;
  const std::string from = R"({"kind":"blend","children":[{"kind":"point","name":"head","centre":[0,0,0],"radius":1},
    {"kind":"translate","name":"leg","by":[1,0,0],"child":{"kind":"point","name":"foot","centre":[0,0,0],"radius":1}}]})";
  const std::string to = R"({"kind":"blend","children":[{"kind":"point","name":"skull","centre":[0,0,0],"radius":1},
    {"kind":"point","name":"twin","centre":[0,0,0],"radius":1},{"kind":"point","name":"twin","centre":[1,0,0],"radius":1}]})";
  const auto errors = [&](std::string_view pairs) {
    return folder.errors(scene_with(morph_of(from, to, "0.5", fmt::format(",\"pairs\":[{}]", pairs))));
  };
  EXPECT_EQ(errors(R"({"from":"head","to":"skull"})"), "");
  EXPECT_EQ(errors(R"({"from":"haed","to":"skull"})"),
            "scene.json:4:149: pairs: in `from` no node is called \"haed\" (did you mean \"head\"?)");
  EXPECT_EQ(errors(R"({"from":"head","to":"twin"})"), "scene.json:4:149: pairs: in `to` 2 nodes are called \"twin\"");
  EXPECT_EQ(folder.errors(scene_with(
                morph_of(from, R"({"kind":"point","centre":[0,0,0],"radius":1})", "0.5", R"(,"pairs":[{"from":"head","to":"x"}])"))),
            "scene.json:3:195: pairs: in `to` no node is called \"x\", as none has a name");
  EXPECT_EQ(folder.errors(scene_with(morph_of(from, to, "2.5"))).substr(0, 12), "scene.json:4");
}

} // namespace
} // namespace kelpie
