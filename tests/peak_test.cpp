// Whether shapes have a surface: what is said of them, and that it is never said of one that has.
#include <numeric>

#include <fmt/format.h>

#include "renderer/check_surfaces.h"
#include "renderer/peak.h"
#include "renderer/program/evaluate.h"
#include "tests/support/every_kind.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

constexpr int64_t k_work = 10'000'000;

class MissingSurfaces : public testing::Test {
protected:
  /// What is said of a scene with this field and these members besides, in frames 1 to `last`; without the folder.
  std::string warnings(const std::string& field, const std::string& more = "", int last = 1) const {
    return warnings_of(fmt::format("{{ \"kelpie\": 1, {}\n\"shapes\": [\n{{ \"name\": \"a\", \"field\": {} }} ] }}", more, field), last);
  }
  std::string warnings_of(const std::string& text, int last = 1) const {
    const Scene scene = folder_.read(text);
    std::vector<int> frames(size_t(last), 0);
    std::iota(frames.begin(), frames.end(), 1);
    Diagnostics diagnostics;
    warn_of_missing_surfaces(scene, frames, diagnostics);
    std::string lines;
    for (const Problem& p : diagnostics.warnings()) lines += to_string(p).substr(folder_.path("").size()) + "\n";
    return lines;
  }

  SceneFolder folder_;
};

constexpr std::string_view k_weak = "its field is at most {}, and its threshold is {} (raise \"weight\", or lower \"threshold\")\n";
std::string weak(std::string_view most, std::string_view threshold = "1") {
  return "scene.json:3:1: shape \"a\" has no surface: " + fmt::format(fmt::runtime(k_weak), most, threshold);
}

TEST_F(MissingSurfaces, AreThoseOfFieldsThatNeverExceedTheThreshold) {
  EXPECT_EQ(warnings(R"({ "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 1 })"), weak("1"));
  EXPECT_EQ(warnings(R"({ "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 0.25 })"), weak("0.25"));
  EXPECT_EQ(warnings(R"({ "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 1.001 })"), "");
  EXPECT_EQ(warnings(R"({ "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": -2 })"),
            "scene.json:3:1: shape \"a\" has no surface: its field is nowhere above 0\n");
  EXPECT_EQ(warnings(R"({ "kind": "box", "centre": [0, 0, 0], "size": 1, "radius": 1, "weight": 1 })"), weak("1"));
  EXPECT_EQ(warnings(R"({ "kind": "box", "centre": [0, 0, 0], "size": 1, "radius": 1, "weight": 1.001 })"), "");
  EXPECT_EQ(warnings(R"({ "kind": "revolution", "radius": 1, "weight": 1, "profile": [[1, 0, 0.1], [1, 1, 0.1]] })"), weak("1"));
  folder_.write("weak.ply", "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
                            "property float radius\nproperty float weight\nend_header\n0 1 0 1 0.7\n9 1 0 1 0.7\n");
  EXPECT_EQ(warnings(R"({ "kind": "blobs", "file": "weak.ply" })"), weak("0.7"));
  EXPECT_EQ(warnings(R"({ "kind": "blobs", "file": "cloud.ply" })"), "");
  EXPECT_EQ(warnings_of("{ \"kelpie\": 1, \"shapes\": [ { \"name\": \"a\", \"geometry\": { \"kind\": \"plane\" } } ] }"), "");
}

TEST_F(MissingSurfaces, AreNotThoseOfWeakFieldsThatAddUp) {
  const auto pair = [](double x, double weight) {
    return fmt::format(
        R"({{ "kind": "blend", "children": [ {{ "kind": "point", "centre": [-{0}, 0, 0], "radius": 1, "weight": {1}, "falloff": "quartic" }},
                                                   {{ "kind": "point", "centre": [{0}, 0, 0], "radius": 1, "weight": {1}, "falloff": "quartic" }} ] }})",
        x, weight);
  };
  EXPECT_EQ(warnings(pair(0.2, 0.6)), "");            // 2 * 0.6 * (1 - 0.04)^2 = 1.106 in the middle
  EXPECT_EQ(warnings(pair(0.3, 0.6)), weak("0.994")); // 1.2 * 0.91^2
  EXPECT_EQ(warnings(pair(5, 0.6)), weak("0.6"));
  EXPECT_EQ(warnings(pair(5, 1)), weak("1"));
  EXPECT_EQ(warnings(pair(0.4, 1)), "");
}

TEST_F(MissingSurfaces, AreToldFromWhatOperatorsLeave) {
  const std::string leaf = R"({ "kind": "point", "centre": [0, 0, 0], "radius": 1, "falloff": "quartic" })";
  const std::string large = R"({ "kind": "point", "centre": [0, 0, 0], "radius": 1.1, "weight": 9 })";
  // Largest on a whole sphere, so its bound is wide.
  const std::string left = warnings(R"({ "kind": "difference", "children": [)" + leaf + ", " + large + "] }");
  EXPECT_EQ(left.find("scene.json:3:1: shape \"a\" has no surface: its field is at most 0."), 0) << left;
  EXPECT_EQ(left.find("raise"), std::string::npos) << left;
  const std::string plane = R"({ "kind": "sdf_plane", "point": [0, 0, 0] })",
                    soft = R"({ "kind": "box", "centre": [0, 0, 0], "size": 1, "radius": 1, "weight": 1 })";
  EXPECT_EQ(warnings(R"({ "kind": "intersection", "children": [)" + plane + ", " + soft + "] }"), weak("1")); // one of them is weak
  const std::string far = R"({ "kind": "point", "centre": [9, 0, 0], "radius": 1, "weight": 2 })";
  EXPECT_EQ(warnings(R"({ "kind": "intersection", "children": [)" + leaf + ", " + far + "] }"),
            "scene.json:3:1: shape \"a\" has no surface: its field is nowhere above 0\n");
  const std::string near =
      R"({ "kind": "point", "centre": [1.2, 0, 0], "radius": 1, "falloff": "quartic" })"; // 2 (1 - 0.36)^2 where they meet
  EXPECT_EQ(warnings(R"({ "kind": "intersection", "children": [)" + leaf + ", " + near + "] }"),
            "scene.json:3:1: shape \"a\" has no surface: its field is at most 0.819, and its threshold is 1\n");
}

TEST_F(MissingSurfaces, CountInThresholdsWhereDistancesDo) {
  const auto ball = [](std::string_view rest) {
    return fmt::format(R"({{ "kind": "sdf_sphere", "centre": [0, 0, 0], "sphere_radius": 1{} }})", rest);
  };
  EXPECT_EQ(warnings(ball("")), "");
  EXPECT_EQ(warnings(ball(R"(, "weight": 0.6)")), "");
  EXPECT_EQ(warnings(ball(R"(, "weight": 0.5)")), weak("1"));
  EXPECT_EQ(warnings(ball(R"(, "falloff": "quartic", "radius": 0.2)")), weak("1"));
  EXPECT_EQ(warnings_of(R"({ "kelpie": 1, "shapes": [
{ "name": "a", "threshold": 7, "field": { "kind": "sdf_sphere", "centre": [0, 0, 0], "sphere_radius": 1 } } ] })"),
            "");
}

TEST_F(MissingSurfaces, AreMissingInAllFrames) {
  const auto growing = [](std::string_view keys) {
    return fmt::format(R"({{ "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": {{ "keys": [{}] }} }})", keys);
  };
  EXPECT_EQ(warnings(growing("[1, 0], [10, 2]"), "", 10), "");
  EXPECT_EQ(warnings(growing("[1, 0], [10, 2]"), "", 3), "scene.json:3:1: shape \"a\" has no surface: its field is at most 0.444 "
                                                         "(frame 3), and its threshold is 1 (raise \"weight\", or lower \"threshold\")\n");
  EXPECT_EQ(warnings(growing("[6, 0], [7, 2], [8, 0]"), "", 10), ""); // in a frame that is not looked at first
  EXPECT_EQ(warnings(growing("[6, 0], [6.5, 2], [7, 0]"), "", 10),
            "scene.json:3:1: shape \"a\" has no surface: its field is nowhere above 0\n"); // between frames, the shutter closed
  // While the shutter is open.
  EXPECT_EQ(warnings(growing("[1, 1], [2, 3]"), R"("camera": { "shutter": 0 },)"), weak("1"));
  EXPECT_EQ(warnings(growing("[1, 1], [2, 3]"), R"("camera": { "shutter": 0.5 },)"), "");
  // The threshold may move as well.
  EXPECT_EQ(warnings_of(R"({ "kelpie": 1, "shapes": [
{ "name": "a", "threshold": { "keys": [[1, 3], [10, 2.5]] }, "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 2 } } ] })",
                        10),
            "scene.json:2:1: shape \"a\" has no surface: its field is at most 2 (frame 10), and its threshold is 2.5 (raise \"weight\", "
            "or lower \"threshold\")\n");
}

TEST_F(MissingSurfaces, OfSingleSkeletonsAreSaidWhereNothingAddsToThem) {
  const auto joined = [](std::string_view operation, std::string_view weight, double to, std::string_view more) {
    return fmt::format(
        R"({{ "kind": "{}", "children": [ {{ "kind": "segment", "from": [0, 0, 0], "to": [{}, 0, 0], "radius": 0.5, "weight": {} }},
                           {{ "kind": "point", "centre": [0, 0, 0], "radius": 1.5, "weight": 2 }}{} ] }})",
        operation, to, weight, more);
  };
  const auto said = [](int column) {
    return fmt::format(
        "scene.json:3:{}: this segment of shape \"a\" has no surface of its own: its field only reaches the threshold (raise "
        "\"weight\", or lower \"threshold\")\n",
        column);
  };
  EXPECT_EQ(warnings(joined("blend", "1", 8, "")), said(58));
  EXPECT_EQ(warnings(joined("union", "1", 8, "")), said(58));
  EXPECT_EQ(warnings(joined("union", "1.1", 8, "")), "");
  EXPECT_EQ(warnings(joined("blend", "1", 1.2, "")), ""); // the point reaches all of it
  EXPECT_EQ(warnings(joined("blend", "0.8", 8, "")), ""); // known to be weak: it only adds to others
  EXPECT_EQ(warnings(joined("union", "{ \"keys\": [[1, 1], [5, 2]] }", 8, ""), "", 5), "");
  EXPECT_EQ(warnings(fmt::format(R"({{ "kind": "rotate", "angle": 40, "axis": [1, 2, 3], "centre": [5, 0, 2], "child": {} }})",
                                 joined("union", "1", 8, ""))),
            said(140));
  // In the part, whoever uses it, after parts that are used twice; and what complex primitives become is not spoken of.
  const std::string parts = R"("parts": { "ball": { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 2 },
"limb": { "kind": "generalized_cylinder", "points": [[0, 0, 0], [3, 1, 0]], "radius": 0.3, "weight": 1 } }, "film": { "spp": 4 },)";
  EXPECT_EQ(
      warnings(
          R"({ "kind": "union", "children": [ { "kind": "instance", "of": "ball" }, { "kind": "instance", "of": "ball", "position": [0, 2, 0] },
 { "kind": "instance", "of": "limb" } ] })",
          parts),
      "scene.json:2:9: this generalized_cylinder of shape \"a\" has no surface of its own: its field only reaches the threshold (raise "
      "\"weight\", or lower \"threshold\")\n");
}

TEST_F(MissingSurfaces, AreFoundBelowInstancesAndWarps) {
  const std::string parts = R"("parts": { "p": { "kind": "segment", "from": [0, 0, 0], "to": [0, 1, 0], "radius": 0.4, "weight": 1 } },)";
  EXPECT_EQ(warnings(R"({ "kind": "instance", "of": "p", "position": [3, 0, 0], "scale": 2 })", parts), weak("1"));
  EXPECT_EQ(
      warnings(
          R"({ "kind": "twist", "rate": 40, "child": { "kind": "box", "centre": [0, 1, 0], "size": 1, "radius": 0.3, "weight": 1 } })"),
      weak("1"));
}

// Whatever the field: of one that exceeds its threshold somewhere nobody says that it does not, and the other way round.
TEST(FieldsPeaks, AreBoundedSoundly) {
  const EveryKind kinds;
  std::array<int, 3> count{};
  for (unsigned trial = 0; trial < 1500; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    SampledField field = kinds.random_field(trial, r);
    const FieldProgram program = compile(std::move(field), r.log_uniform(0.5, 8));
    int64_t work = k_work / 10;
    const Surface surface = find_surface(program, work);
    ++count[size_t(surface)];
    if (surface == Surface::present) continue;
    const double peak = peak_of(program, work = k_work / 100);
    if (program.support.is_empty()) continue;
    for (int i = 0; i < 200; ++i) {
      const Vec3d p = r.in(program.support);
      const double f = evaluate(program, program.code, Point3<double>{p.x, p.y, p.z});
      const double most = surface == Surface::none ? std::min(peak, program.threshold) : peak;
      ASSERT_LE(f, most + k_peak_margin * program.threshold);
    }
  }
  EXPECT_GT(count[size_t(Surface::none)], 100);
  EXPECT_GT(count[size_t(Surface::present)], 500);
  EXPECT_LT(count[size_t(Surface::unknown)], 100);
}

// No leaf of any kind is anywhere more than it is said to be at most.
TEST(FieldsPeaks, OfLeavesAreBounded) {
  FieldKinds::for_each([]<template <class> class Kind>() {
    if constexpr (Skeleton<Kind<SampledMode>>) {
      SCOPED_TRACE(Kind<SampledMode>::k_name);
      double closest = 0;
      for (unsigned trial = 0; trial < 60; ++trial) {
        Random r(trial);
        SampledField field;
        field.nodes.emplace_back(random_kind<Kind>(r));
        const FieldProgram program = compile(std::move(field), r.log_uniform(0.5, 2));
        const double most = peak_of_weakest_leaf(program);
        for (int i = 0; i < 100 && std::isfinite(most); ++i) {
          const Vec3d p = r.in(intersect(program.support, Box3d{Vec3d(-4), Vec3d(4)}));
          const double f = evaluate(program, program.code, Point3<double>{p.x, p.y, p.z});
          ASSERT_LE(f, most * (1 + 1e-6)) << trial;
          closest = std::max(closest, f / most);
        }
      }
      EXPECT_GT(closest, 0.4);
    }
  });
}

// Random soft leaves in a blend: a little below their peak there is a surface, a little above there is none.
TEST(FieldsPeaks, AreFoundAsNearAsIsSaid) {
  int hard = 0, compared = 0;
  for (unsigned trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    SampledField field;
    Blend<SampledMode> blend;
    for (int i = 0; i < 1 + r.below(5); ++i) {
      blend.children.push_back(unsigned(field.nodes.size()));
      if (r.below(2))
        field.nodes.emplace_back(random_leaf<Point>(r));
      else
        field.nodes.emplace_back(random_leaf<Segment>(r));
    }
    field.nodes.emplace_back(blend);
    int64_t work = k_work;
    const double peak = peak_of(compile(field, 1), work);
    if (!(peak > 0)) continue;
    if (work <= 0 && ++hard) continue;
    ++compared;
    EXPECT_EQ(find_surface(compile(field, peak * 0.998), work = k_work), Surface::present);
    EXPECT_EQ(find_surface(compile(field, peak * 1.0001), work = k_work), Surface::none);
  }
  EXPECT_LT(hard, 10);
  EXPECT_GT(compared, 150);
}

} // namespace
} // namespace kelpie
