// `kelpie render` from end to end: pictures whose every pixel is known, and the same picture whatever the
// number of threads, the crop, or the way it was asked for.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "renderer/output/exr.h"
#include "tests/support/program.h"

namespace kelpie {
namespace {

/// A unit sphere: a lone quartic point of weight 2 whose radius of influence is 1 / sqrt(1 - sqrt(1/2)).
constexpr const char* k_sphere = R"({ "kelpie": 1,
  "camera": { "position": [0, 0, 5], "look_at": [0, 0, 0], "fov": 40 },
  "film": { "resolution": [48, 32], "spp": 1, "bounces": 0, "filter": "centre", "background": "transparent" },
  "lights": [ { "kind": "sun", "direction": [1, 2, 2], "strength": 3, "angle": 0 } ],
  "shapes": [ { "name": "ball", "surface": { "kind": "matte", "colour": [0.5, 0.25, 0.125] },
    "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1.8477590650225735, "weight": 2, "falloff": "quartic" } } ] })";

/// A bit of everything, sampled: blobs, a carved union, metal, a plane, two lights, bounces.
constexpr const char* k_mixture = R"({ "kelpie": 1, "frames": { "first": 1, "last": 3 },
  "camera": { "position": [0, 1.5, 6], "look_at": [0, 0.7, 0], "fov": 35 },
  "film": { "resolution": [53, 31], "spp": 4, "bounces": 3 },
  "lights": [ { "kind": "environment", "preset": "sky" }, { "kind": "sun", "direction": [2, 3, 1], "angle": 5 } ],
  "shapes": [
    { "name": "carved", "surface": { "kind": "metal", "roughness": 0.2 }, "field": { "kind": "difference", "children": [
      { "kind": "union", "children": [ { "kind": "point", "centre": [-1, 0.8, 0], "radius": 1.5, "weight": 2 },
                                       { "kind": "segment", "from": [-1, 0.5, 0], "to": [1, 0.9, 0.5], "radius": 0.8, "weight": 2 } ] },
      { "kind": "point", "centre": [-0.7, 1.2, 0.7], "radius": 1, "weight": 2 } ] } },
    { "name": "drops", "field": { "kind": "blend", "children": [
      { "kind": "point", "centre": { "keys": [[1, [1.2, 1, 0]], [3, [1.4, 1.4, 0]]] }, "radius": 1, "weight": 1.6 },
      { "kind": "point", "centre": [1.6, 0.6, 0.2], "radius": 1, "weight": 1.6, "falloff": "wyvill" } ] } },
    { "name": "floor", "geometry": { "kind": "plane" } } ] })";

class Render : public ProgramTest {
protected:
  FrameImage render(const std::string& scene, const std::string& options = "") {
    write("scene.json", scene);
    const Outcome o = kelpie("render scene.json -f 1 --progress=none -o a.exr " + options);
    EXPECT_EQ(o.status, 0) << o.err;
    return read_exr(path("a.exr")).image;
  }
};

double value(const FrameImage& image, const char* channel, int x, int y) { return image.find(channel)->pixels[image.index(x, y)]; }
Vec3d vector(const FrameImage& image, const std::string& channel, int x, int y) {
  return {value(image, (channel + ".X").c_str(), x, y), value(image, (channel + ".Y").c_str(), x, y),
          value(image, (channel + ".Z").c_str(), x, y)};
}

// Every pixel of a lit sphere follows from geometry: where its ray goes, where it meets the unit sphere, the
// normal there, and albedo / pi * irradiance * cosine.
TEST_F(Render, EveryPixelOfASphereIsWhatGeometrySays) {
  const FrameImage image = render(k_sphere);
  const Vec3d eye(0, 0, 5), sun = glm::normalize(Vec3d(1, 2, 2));
  int hits = 0, misses = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 48; ++x) {
      const double scale = std::tan(glm::radians(20.0)) / 16;
      const Vec3d d = glm::normalize(Vec3d((x + 0.5 - 24) * scale, (16 - y - 0.5) * scale, -1));
      const double along = -glm::dot(eye, d), discriminant = along * along - 24;
      if (std::abs(discriminant) < 1e-4) continue; // grazing: either answer is right
      if (discriminant < 0) {
        ++misses;
        EXPECT_EQ(value(image, "A", x, y), 0);
        EXPECT_EQ(value(image, "R", x, y), 0);
        EXPECT_FLOAT_EQ(float(value(image, "Z", x, y)), 1e10f);
        EXPECT_EQ(vector(image, "P", x, y), Vec3d(0));
        EXPECT_EQ(vector(image, "N", x, y), Vec3d(0));
        continue;
      }
      ++hits;
      const Vec3d p = eye + (along - std::sqrt(discriminant)) * d;
      EXPECT_EQ(value(image, "A", x, y), 1);
      EXPECT_NEAR(value(image, "Z", x, y), 5 - p.z, 1e-4);
      EXPECT_LT(glm::distance(vector(image, "P", x, y), p), 1e-4);
      EXPECT_LT(glm::distance(vector(image, "N", x, y), p), 1e-3); // half floats
      const double radiance = 3 / 3.14159265358979 * std::max(0.0, glm::dot(p, sun));
      if (std::abs(glm::dot(p, sun)) > 0.02) { // the terminator is the epsilon's
        EXPECT_NEAR(value(image, "R", x, y), 0.5 * radiance, 1e-3);
        EXPECT_NEAR(value(image, "G", x, y), 0.25 * radiance, 1e-3);
        EXPECT_NEAR(value(image, "B", x, y), 0.125 * radiance, 1e-3);
      }
    }
  EXPECT_GT(hits, 200);
  EXPECT_GT(misses, 200);
}

// Under the same light from everywhere a convex matte surface shows its albedo: no light is made or lost.
TEST_F(Render, WhiteFurnace) {
  const FrameImage image =
      render(k_sphere, "--set film.spp=256 --set film.bounces=4 --set 'lights=[{\"kind\":\"environment\",\"preset\":\"white\"}]'");
  double sum = 0;
  int n = 0;
  for (int y = 10; y < 22; ++y)
    for (int x = 18; x < 30; ++x, ++n) sum += value(image, "R", x, y);
  EXPECT_NEAR(sum / n, 0.5, 0.005);
}

TEST_F(Render, ThreadsDoNotShow) {
  std::string scene = k_mixture; // and a mesh of many triangles that share edges
  scene.insert(scene.rfind("] }"), R"(, { "name": "wave", "geometry": { "kind": "mesh", "file": "wave.obj", "crease": 180 } })");
  write("scene.json", scene);
  std::string obj;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j)
      obj += fmt::format("v {} {} {}\n", 0.1 * i - 3, 0.3 + 0.1 * std::sin(0.7 * i) * std::cos(0.5 * j), 0.1 * j - 3);
  for (int i = 1; i < 59 * 60; ++i)
    if (i % 60) obj += fmt::format("f {} {} {} {}\n", i, i + 1, i + 61, i + 60);
  write("wave.obj", obj);
  for (const char* threads : {"1", "2", "4"}) {
    const Outcome o = kelpie(std::string("render scene.json -f 1-3x2 --progress=none -o 't") + threads + ".####.exr' -j " + threads);
    ASSERT_EQ(o.status, 0) << o.err;
  }
  for (const char* frame : {".0001.exr", ".0003.exr"}) {
    const std::string one = text_of(path(std::string("t1") + frame));
    ASSERT_FALSE(one.empty());
    EXPECT_TRUE(one == text_of(path(std::string("t2") + frame))) << frame;
    EXPECT_TRUE(one == text_of(path(std::string("t4") + frame))) << frame;
  }
  EXPECT_NE(read_exr(path("t1.0001.exr")).pixel_hash, read_exr(path("t1.0003.exr")).pixel_hash);
}

TEST_F(Render, ACropIsAPartOfTheWhole) {
  const FrameImage whole = render(k_mixture), part = render(k_mixture, "--crop 11,40,7,23 -j 1");
  ASSERT_EQ(part.data_window, (PixelBox{11, 7, 40, 23}));
  ASSERT_EQ(part.resolution, whole.resolution);
  for (const FrameChannel& c : part.channels)
    for (int y = 7; y < 23; ++y)
      for (int x = 11; x < 40; ++x)
        ASSERT_EQ(c.pixels[part.index(x, y)], whole.find(c.name)->pixels[whole.index(x, y)]) << c.name << ' ' << x << ' ' << y;
}

// What a pixel cost is a count of its own: whatever the threads and the crop, and so whatever shares its
// packets; and asking for it changes no other channel.
TEST_F(Render, TheHeatMapIsDeterministicAndChangesNothingElse) {
  const FrameImage plain = render(k_mixture), whole = render(k_mixture, "--heatmap -j 1 --stats stats.json");
  const std::string stats = text_of(path("stats.json"));
  const FrameImage part = render(k_mixture, "--heatmap --crop 11,40,7,23 -j 3");
  EXPECT_EQ(plain.find("cost"), nullptr);
  ASSERT_NE(whole.find("cost"), nullptr);
  for (const FrameChannel& c : plain.channels) EXPECT_EQ(c.pixels, whole.find(c.name)->pixels) << c.name;
  double sum = 0;
  for (const float cost : whole.find("cost")->pixels) sum += cost;
  EXPECT_NE(stats.find("\"evaluations\": " + std::to_string(std::llround(4 * sum)) + ","), std::string::npos) << sum << stats; // 4 samples
  EXPECT_GT(sum, 1000);
  for (int y = 7; y < 23; ++y)
    for (int x = 11; x < 40; ++x) ASSERT_EQ(value(part, "cost", x, y), value(whole, "cost", x, y)) << x << ' ' << y;
}

/// A cloud of many small blobs, and what moves beside it.
std::string scene_of_many() {
  std::string points;
  for (int i = 0; i < 600; ++i)
    points += fmt::format("{}{{ \"kind\": \"point\", \"centre\": [{}, {}, {}], \"radius\": 0.25, \"weight\": 1.5 }}", i ? "," : "",
                          std::sin(0.7 * i), std::sin(1.3 * i), std::sin(2.1 * i + 1));
  return fmt::format(
      R"({{ "kelpie": 1, "frames": {{ "first": 1, "last": 3 }}, "camera": {{ "position": {{ "keys": [[1, [0, 0, 5]], [2, [0, 1, 5]]] }} }},
    "film": {{ "resolution": [40, 30], "spp": 2, "bounces": 1 }}, "shapes": [
    {{ "name": "still", "field": {{ "kind": "blend", "children": [ {} ] }} }},
    {{ "name": "mesh", "geometry": {{ "kind": "mesh", "file": "mesh.obj", "position": {{ "keys": [[2, [0, 0, 0]], [3, [1, 0, 0]]] }} }} }},
    {{ "name": "moving", "field": {{ "kind": "point", "centre": {{ "keys": [[2, [0, 1, 0]], [3, [0, 1.5, 0]]] }}, "radius": 1, "weight": 2 }} }} ] }})",
      points);
}

// Frame 2 moves the camera only, frame 3 a shape and a mesh: what stays is kept, and no bit of a picture shows it.
TEST_F(Render, ASequenceKeepsWhatStandsStill) {
  write("scene.json", scene_of_many());
  write("mesh.obj", "v -2 -1 0\nv 2 -1 0\nv 0 2 -1\nf 1 2 3\n");
  ASSERT_EQ(kelpie("render scene.json -o 's.####.exr' --stats s.json").status, 0);
  for (const std::string frame : {"1", "2", "3"}) {
    ASSERT_EQ(kelpie("render scene.json -f " + frame + " -o 'lone.####.exr'").status, 0);
    EXPECT_TRUE(text_of(path("s.000" + frame + ".exr")) == text_of(path("lone.000" + frame + ".exr"))) << frame;
  }
  std::vector<int> cells, kept;
  const std::string stats = text_of(path("s.json"));
  for (size_t at = 0; (at = stats.find("\"cells\": ", at)) != std::string::npos; ++at) {
    if (stats[at - 1] == '{') continue; // of a solver
    cells.push_back(std::stoi(stats.substr(at + 9)));
    kept.push_back(std::stoi(stats.substr(stats.find("\"kept_cells\": ", at) + 14)));
  }
  ASSERT_EQ(cells.size(), 3u) << stats;
  EXPECT_EQ(kept[0], 0);
  EXPECT_EQ(kept[1], cells[1]);
  EXPECT_GT(kept[2], 0);
  EXPECT_LT(kept[2], cells[2]);
}

// Less memory, coarser cells, the same picture but for rounding; and where nothing helps, one line and status 33.
TEST_F(Render, MemoryMayBeCapped) {
  const std::string scene = scene_of_many();
  write("mesh.obj", "v -2 -1 0\nv 2 -1 0\nv 0 2 -1\nf 1 2 3\n");
  const FrameImage whole = render(scene, "--stats s.json");
  int coarsest = 0;
  for (int kb = 1024; kb >= 1; kb /= 2) {
    const Outcome o = kelpie(fmt::format("render scene.json -f 1 --progress=none -o b.exr --max-memory {}K --stats s.json", kb));
    if (o.status == 0) {
      const std::string stats = text_of(path("s.json"));
      const int coarsenings = std::stoi(stats.substr(stats.find("\"coarsenings\": ") + 15));
      EXPECT_GE(coarsenings, coarsest);
      EXPECT_EQ(o.err.find("cells are") != std::string::npos, coarsenings > 0) << o.err;
      coarsest = coarsenings;
      const FrameImage image = read_exr(path("b.exr")).image;
      size_t differing = 0;
      for (size_t i = 0; i < image.data_window.area(); ++i)
        differing += std::abs(image.find("Z")->pixels[i] - whole.find("Z")->pixels[i]) > 1e-4f;
      EXPECT_LE(differing, 2u) << "but for rays that graze";
      continue;
    }
    EXPECT_EQ(o.status, 33);
    EXPECT_EQ(o.err.find("error: frame 1: even with the coarsest cells building takes more than"), 0u) << o.err;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1);
    EXPECT_GT(coarsest, 0);
    EXPECT_EQ(kelpie(fmt::format("check scene.json -f 1 --max-memory {}K", kb)).status, 33);
    const Outcome check = kelpie(fmt::format("check scene.json -f 1 --max-memory {}K", 2 * kb));
    EXPECT_NE(check.out.find("times as long, to fit into --max-memory"), std::string::npos) << check.out;
    for (const char* wrong : {"0", "much", "-5M"})
      EXPECT_EQ(kelpie(std::string("render scene.json -f 1 -o c.exr --max-memory ") + wrong).status, 2);
    return;
  }
  FAIL() << "it fits into nothing";
}

TEST_F(Render, FramesThatExistAreKeptOnlyIfTheyAreOfThisScene) {
  write("scene.json", k_sphere);
  ASSERT_EQ(kelpie("render scene.json -f 1 -o a.exr").status, 0);
  const auto written = std::filesystem::last_write_time(path("a.exr"));
  ASSERT_EQ(kelpie("render scene.json -f 1 -o a.exr --skip-existing").status, 0);
  EXPECT_EQ(std::filesystem::last_write_time(path("a.exr")), written);
  ASSERT_EQ(kelpie("render scene.json -f 1 -o a.exr --skip-existing --set film.spp=2").status, 0);
  EXPECT_NE(std::filesystem::last_write_time(path("a.exr")), written);
}

// What a mesh's file holds is part of the scene; what is wrong with it has a line.
TEST_F(Render, MeshesAreAssetsLikeOthers) {
  write("mesh.json", R"({ "kelpie": 1, "film": { "resolution": [8, 8], "spp": 1 }, "shapes": [ { "name": "m",
    "geometry": { "kind": "mesh", "file": "m.obj" } } ] })");
  EXPECT_EQ(kelpie("render mesh.json -f 1 -o a.exr").status, 66);
  write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ASSERT_EQ(kelpie("render mesh.json -f 1 -o a.exr").status, 0);
  const auto written = std::filesystem::last_write_time(path("a.exr"));
  ASSERT_EQ(kelpie("render mesh.json -f 1 -o a.exr --skip-existing").status, 0);
  EXPECT_EQ(std::filesystem::last_write_time(path("a.exr")), written);
  write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n");
  ASSERT_EQ(kelpie("render mesh.json -f 1 -o a.exr --skip-existing").status, 0);
  EXPECT_NE(std::filesystem::last_write_time(path("a.exr")), written);

  write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  const Outcome damaged = kelpie("render mesh.json -f 1 -o b.exr");
  EXPECT_EQ(damaged.status, 65);
  EXPECT_NE(damaged.err.find("m.obj:4: there is no vertex 4: the file has 3"), std::string::npos) << damaged.err;
  write("m.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_EQ(kelpie("render mesh.json -f 1 -o b.exr").status, 65) << "no area";
  const Outcome outside = kelpie("render mesh.json -f 1 -o b.exr --allow-path . --set shapes.m.geometry.file=none.obj");
  EXPECT_EQ(outside.status, 66);
  write("mesh.json", R"({ "kelpie": 1, "shapes": [ { "name": "m", "geometry": { "kind": "mesh", "file": "/etc/hostname" } } ] })");
  EXPECT_EQ(kelpie("render mesh.json -f 1 -o b.exr").status, 65);
  EXPECT_FALSE(std::filesystem::exists(path("b.exr")));
}

TEST_F(Render, ProblemsAreOneLineWithPositionAndStatus) {
  write(
      "bad.json",
      "{ \"kelpie\": 1,\n  \"shapes\": [ { \"name\": \"a\", \"field\": { \"kind\": \"point\", \"centre\": [0,0,0], \"raduis\": 1 } } ] }");
  const Outcome bad = kelpie("render bad.json -o a.exr");
  EXPECT_EQ(bad.status, 65);
  EXPECT_NE(bad.err.find("error: bad.json:2:77: unknown key \"raduis\" (did you mean \"radius\"?)"), std::string::npos) << bad.err;
  EXPECT_EQ(bad.out, "");
  EXPECT_EQ(kelpie("render nowhere.json -o a.exr").status, 66);
  EXPECT_EQ(kelpie("render").status, 2);
  EXPECT_EQ(kelpie("rendr").status, 2);
  write("scene.json", k_sphere);
  EXPECT_EQ(kelpie("render scene.json -f 9-1 -o a.exr").status, 2);
  EXPECT_EQ(kelpie("render scene.json -f 1 -o scene.json/a.exr").status, 74);
  EXPECT_EQ(file_count(), 2u) << "only the two scenes: nothing half-written";
}

} // namespace
} // namespace kelpie
