// What `kelpie report` measures, against what is known.
#include "renderer/measure/measure_morph.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "renderer/measure/bumps.h"
#include "renderer/measure/morph_pops.h"
#include "renderer/measure/pops.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

constexpr double k_pi = std::numbers::pi;

class Measure : public testing::Test {
protected:
  /// All frames from 1 to `last`.
  std::vector<FieldMeasures> measure(std::string_view field, int last = 1, int resolution = 64) {
    const Scene scene = folder_.read(scene_with_field(field));
    std::vector<int> frames;
    for (int frame = 1; frame <= last; ++frame) frames.push_back(frame);
    MorphMeasurer measurer(scene, 0, frames, resolution);
    std::vector<FieldMeasures> out;
    for (size_t i = 0; i < frames.size(); ++i) out.push_back(measurer.measure_next());
    return out;
  }
  static std::vector<PartEvent> events_of(const std::vector<FieldMeasures>& frames) {
    std::vector<PartEvent> all;
    for (const FieldMeasures& f : frames) all.insert(all.end(), f.events.begin(), f.events.end());
    return all;
  }

  SceneFolder folder_;
};

TEST_F(Measure, Sphere) {
  const FieldMeasures m = measure(R"({"kind":"sdf_sphere","centre":[0.3,0.1,-0.2],"sphere_radius":0.8})")[0];
  const double volume = 4 * k_pi / 3 * 0.512, area = 4 * k_pi * 0.64;
  EXPECT_NEAR(m.volume, volume, 0.001 * volume);
  EXPECT_NEAR(m.area, area, 0.001 * area);
  ASSERT_EQ(m.parts.size(), 1u);
  EXPECT_EQ(m.genus, 0);
  EXPECT_EQ(m.cavities, 0);
  EXPECT_NEAR(glm::length(m.parts[0].centre - Vec3d(0.3, 0.1, -0.2)), 0, 1e-3);
  EXPECT_EQ(m.speed, 0);
  EXPECT_EQ(m.to_first->largest, 0);
}

// Twice as fine, a quarter of the error.
TEST_F(Measure, ConvergesWithTheSquareOfTheStep) {
  const auto error = [&](int resolution) {
    return 1 - measure(R"({"kind":"sdf_sphere","centre":[0,0,0],"sphere_radius":1})", 1, resolution)[0].volume / (4 * k_pi / 3);
  };
  const double coarse = error(24), fine = error(48);
  EXPECT_GT(coarse, 0);
  EXPECT_NEAR(coarse / fine, 4, 0.6);
}

TEST_F(Measure, Torus) {
  const FieldMeasures m = measure(R"({"kind":"sdf_torus","centre":[0,0,0],"major_radius":1,"minor_radius":0.3})")[0];
  EXPECT_NEAR(m.volume, 2 * k_pi * k_pi * 0.09, 0.003 * m.volume);
  EXPECT_NEAR(m.area, 4 * k_pi * k_pi * 0.3, 0.003 * m.area);
  EXPECT_EQ(m.genus, 1);
  EXPECT_EQ(m.parts.size(), 1u);
}

TEST_F(Measure, ABlobInAShell) {
  const FieldMeasures m = measure(R"({"kind":"union","children":[{"kind":"difference","children":[
      {"kind":"sdf_sphere","centre":[0,0,0],"sphere_radius":1},{"kind":"sdf_sphere","centre":[0,0,0],"sphere_radius":0.7}]},{"kind":"sdf_sphere","centre":[0,0,0],"sphere_radius":0.4}]})")
      [0];
  ASSERT_EQ(m.parts.size(), 2u);
  EXPECT_EQ(m.genus, 0);
  EXPECT_EQ(m.parts[0].cavities, 1);
  EXPECT_EQ(m.parts[1].cavities, 0);
  EXPECT_NEAR(m.parts[0].volume, 4 * k_pi / 3 * (1 - 0.343), 0.01);
  EXPECT_NEAR(m.parts[1].volume, 4 * k_pi / 3 * 0.064, 0.002);
}

TEST_F(Measure, NothingAtAll) {
  const auto frames = measure(R"({"kind":"point","centre":[0,0,0],"radius":1,"weight":0.5})", 3);
  for (const FieldMeasures& m : frames) {
    EXPECT_EQ(m.volume, 0);
    EXPECT_TRUE(m.parts.empty());
    EXPECT_FALSE(m.to_first);
  }
  EXPECT_TRUE(find_pops(frames, {0, 0}).empty());
}

TEST_F(Measure, AFieldWithoutAnEndIsRefused) {
  try {
    measure(R"({"kind":"sdf_plane","point":[0,0,0]})");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.status, ExitStatus::bad_data);
  }
}

TEST_F(Measure, ABallThatFlies) {
  const auto frames = measure(R"({"kind":"sdf_sphere","sphere_radius":0.5,"centre":{"keys":[[-9,[-0.5,0,0]],[21,[1,0,0]]]}})", 11);
  for (const FieldMeasures& m : frames) EXPECT_NEAR(m.speed, 0.05, 0.0005) << m.frame;
  // Of two equal spheres, a small way apart, the distance is the way times the cosine.
  EXPECT_NEAR(frames[2].to_first->rms, 0.1 / std::sqrt(3), 0.004);
  EXPECT_NEAR(frames[2].to_first->largest, 0.1, 0.002);
  EXPECT_NEAR(frames[8].to_last->largest, 0.1, 0.002);
  EXPECT_TRUE(events_of(frames).empty());
  EXPECT_TRUE(find_pops(frames, std::vector<double>(10)).empty());
}

// Farther in a frame than it is wide: still the same ball.
TEST_F(Measure, ABallThatFliesFast) {
  const auto frames = measure(R"({"kind":"union","children":[{"kind":"sdf_sphere","centre":[0,0,0],"sphere_radius":0.5},
      {"kind":"sdf_sphere","sphere_radius":0.1,"centre":{"keys":[[1,[1,0,0]],[5,[1,2,0]]]}}]})",
                              5);
  EXPECT_TRUE(events_of(frames).empty());
}

TEST_F(Measure, TwoBallsThatMerge) {
  const auto frames = measure(R"({"kind":"blend","children":[{"kind":"point","centre":[0,0,0],"radius":1,"weight":3,"falloff":"quartic"},
      {"kind":"point","radius":0.8,"weight":2,"falloff":"quartic","centre":{"keys":[[1,[1.5,0.4,0]],[21,[0.5,0.4,0]]]}}]})",
                              21, 48);
  const std::vector<PartEvent> events = events_of(frames);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, PartEvent::Kind::merges);
  const auto after = std::find_if(frames.begin(), frames.end(), [](const FieldMeasures& m) { return !m.events.empty(); });
  EXPECT_EQ((after - 1)->parts.size(), 2u);
  EXPECT_EQ(after->parts.size(), 1u);
  const double x = 1.5 - 0.05 * (after->frame - 2); // of the smaller one, in the frame before
  EXPECT_NEAR(glm::length(events[0].place - Vec3d(x, 0.4, 0)), 0, 0.03);
}

// A ball that is there in one frame and not in the next.
TEST_F(Measure, APop) {
  const auto frames = measure(
      R"({"kind":"union","children":[{"kind":"sdf_sphere","centre":[0,0,0],"sphere_radius":0.5},{"kind":"sdf_sphere","centre":[1,2,0],
      "sphere_radius":{"keys":[[1,0.2],[12,0.0001]],"interpolation":"step"}}]})",
      20);
  const std::vector<PartEvent> events = events_of(frames);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, PartEvent::Kind::vanishes);
  EXPECT_NEAR(glm::length(events[0].place - Vec3d(1, 2, 0)), 0, 0.01);
  const std::vector<Pop> pops = find_pops(frames, std::vector<double>(19));
  ASSERT_EQ(pops.size(), 3u);
  const double lost = 0.008 / (0.125 + 0.008);
  for (const Pop& pop : pops) EXPECT_EQ(pop.frame, 12);
  EXPECT_EQ(pops[0].kind, Pop::Kind::volume);
  EXPECT_NEAR(pops[0].change, lost, 0.002);
  EXPECT_EQ(pops[1].kind, Pop::Kind::area);
  EXPECT_EQ(pops[2].kind, Pop::Kind::part);
  EXPECT_NEAR(pops[2].change, lost, 0.002);
}

TEST(Pops, AreMeasuredByWhatIsAround) {
  std::vector<double> changes(30, 0.01);
  EXPECT_TRUE(find_pops(changes).empty());
  changes[17] = 0.029;
  EXPECT_TRUE(find_pops(changes).empty());
  changes[17] = 0.031;
  EXPECT_EQ(find_pops(changes), std::vector<size_t>{17});
  changes.assign(30, 0.0001);
  changes[0] = 0.0019; // small, whatever is around
  changes[29] = 0.0021;
  EXPECT_EQ(find_pops(changes), std::vector<size_t>{29});
  EXPECT_TRUE(find_pops(std::vector<double>{0.5}).empty());
}

TEST(Pops, SmoothMotionHasNone) {
  std::vector<double> changes;
  for (int i = 0; i < 96; ++i) changes.push_back(0.05 * std::pow(std::sin(k_pi * i / 95), 2)); // from rest to rest
  EXPECT_TRUE(find_pops(changes).empty());
}

FrameImage normals(int width, int height, const std::function<Vec3(int, int)>& normal) {
  FrameImage image(Vec2i(width, height));
  for (const char* name : {"N.X", "N.Y", "N.Z"}) image.add(name);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) image.channels[size_t(c)].pixels[image.index(x, y)] = normal(x, y)[c];
  return image;
}

TEST(BumpsOfAPicture, AreTheAngleToTheSmoothSurface) {
  const auto in_disc = [](int x, int y) { return (x - 40) * (x - 40) + (y - 30) * (y - 30) < 25 * 25; };
  const auto flat = bumps_of(normals(80, 60, [&](int x, int y) { return in_disc(x, y) ? Vec3(0, 0, 1) : Vec3(0); }));
  ASSERT_TRUE(flat);
  EXPECT_NEAR(flat->median, 0, 0.02);
  const double a = 10 * k_pi / 180;
  const auto rough = bumps_of(normals(
      80, 60, [&](int x, int y) { return in_disc(x, y) ? Vec3((x + y) % 2 ? std::sin(a) : -std::sin(a), 0, std::cos(a)) : Vec3(0); }));
  EXPECT_NEAR(rough->median, 10, 0.1);
  EXPECT_NEAR(rough->p90, 10, 0.1);
  EXPECT_FALSE(bumps_of(normals(80, 60, [](int, int) { return Vec3(0); })));
}

} // namespace
} // namespace kelpie
