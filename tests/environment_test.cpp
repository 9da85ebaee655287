#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "base/atomic_file.h"
#include "base/file_bytes.h"
#include "colour/colour.h"
#include "colour/spaces.h"
#include "renderer/light/environment_map.h"
#include "renderer/output/exr.h"

namespace kelpie {
namespace {

constexpr double k_pi = std::numbers::pi;

Vec3 direction(double u, double v) { // of the place (u, v) in the map, from the top left
  const double theta = k_pi * v, phi = 2 * k_pi * (u - 0.5);
  return Vec3(std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi));
}

/// Mostly dark, with lights of every size, one at the seam, one at the pole and a whole row of nothing.
EnvironmentMap random_map(unsigned seed, int width = 37, int height = 19) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<Vec3> texels(size_t(width) * size_t(height));
  for (Vec3& t : texels) t = Vec3(uniform(random), uniform(random), uniform(random)) * std::pow(uniform(random), 8.f) * 20.f;
  for (int c = 0; c < width; ++c) texels[size_t(5 * width + c)] = Vec3(0);
  texels[size_t(9 * width)] = Vec3(300, 200, 100);
  texels[3] = Vec3(40);
  return EnvironmentMap(width, height, std::move(texels));
}

/// The integral of f over all directions, by midpoints of `steps` x `steps`/2 places.
template <class F>
double integrate(int steps, F&& f) {
  double sum = 0;
  for (int j = 0; j < steps / 2; ++j) {
    const double v = (j + 0.5) / (steps / 2), ring = std::cos(k_pi * j / (steps / 2)) - std::cos(k_pi * (j + 1) / (steps / 2));
    for (int i = 0; i < steps; ++i) sum += f(direction((i + 0.5) / steps, v)) * ring * 2 * k_pi / steps;
  }
  return sum;
}

TEST(EnvironmentMap, LiesAsTheManualSays) {
  // Columns: left edge +z, quarter -x, middle -z, three quarters +x; the top row is up.
  std::vector<Vec3> texels(64 * 32, Vec3(0));
  texels[15 * 64 + 31] = texels[15 * 64 + 32] = texels[16 * 64 + 31] = texels[16 * 64 + 32] = Vec3(1, 0, 0);
  texels[15 * 64 + 47] = texels[15 * 64 + 48] = texels[16 * 64 + 47] = texels[16 * 64 + 48] = Vec3(0, 1, 0);
  for (int c = 0; c < 64; ++c) texels[size_t(c)] = Vec3(0, 0, 1);
  const EnvironmentMap map(64, 32, texels);
  EXPECT_EQ(map.radiance({0, 0, -1}), Vec3(1, 0, 0));
  EXPECT_NEAR(map.radiance({1, 0, 0}).y, 1, 1e-5f);
  EXPECT_EQ(map.radiance({0, 1, 0}), Vec3(0, 0, 1));
  EXPECT_EQ(map.radiance({0, -1, 0}), Vec3(0));
}

TEST(EnvironmentMap, IsContinuousAcrossTheSeam) {
  const EnvironmentMap map = random_map(1);
  for (double v = 0.05; v < 1; v += 0.1) {
    const Vec3 a = map.radiance(direction(1e-7, v)), b = map.radiance(direction(1 - 1e-7, v));
    EXPECT_NEAR(glm::length(a - b), 0, 1e-3f * (1 + glm::length(a))) << v;
  }
}

TEST(EnvironmentMap, DensityIntegratesToOne) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const EnvironmentMap map = random_map(seed);
    // It is constant in each texel, so the middles are enough.
    double sum = 0;
    for (int r = 0; r < map.height(); ++r)
      for (int c = 0; c < map.width(); ++c) {
        const double omega = 2 * k_pi / map.width() * (std::cos(k_pi * r / map.height()) - std::cos(k_pi * (r + 1) / map.height()));
        const float pdf = map.pdf(direction((c + 0.5) / map.width(), (r + 0.5) / map.height()));
        EXPECT_GT(pdf, 0) << "every direction can be chosen";
        sum += omega * pdf;
      }
    EXPECT_NEAR(sum, 1, 1e-5);
  }
}

TEST(EnvironmentMap, SamplesHaveTheDensityTheySay) {
  const EnvironmentMap map = random_map(7);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  const int n = 400'000, w = map.width(), h = map.height();
  int compared = 0;
  std::vector<double> count(size_t(w) * size_t(h));
  for (int i = 0; i < n; ++i) {
    const LightSample s = map.sample({uniform(random), uniform(random)});
    ASSERT_NEAR(glm::length(s.direction), 1, 1e-5f);
    const double u = 0.5 + std::atan2(s.direction.x, -s.direction.z) / (2 * k_pi), v = std::acos(s.direction.y) / k_pi;
    const int c = std::clamp(int(u * w), 0, w - 1), r = std::clamp(int(v * h), 0, h - 1);
    ++count[size_t(r * w + c)];
    const double edge_u = std::abs(u * w - std::round(u * w)), edge_v = std::abs(v * h - std::round(v * h));
    if (edge_u > 1e-3 && edge_v > 1e-3) {
      ASSERT_NEAR(s.pdf, map.pdf(s.direction), 1e-4f * s.pdf);
      ++compared;
    }
  }
  EXPECT_GT(compared, 0.9 * n);
  // Pearson's statistic over cells that expect 10 or more; its mean is the cells, its variance twice that.
  double statistic = 0, cells = 0;
  for (int r = 0; r < h; ++r)
    for (int c = 0; c < w; ++c) {
      const double omega = 2 * k_pi / w * (std::cos(k_pi * r / h) - std::cos(k_pi * (r + 1) / h));
      const double expected = n * omega * map.pdf(direction((c + 0.5) / w, (r + 0.5) / h));
      if (expected < 10) continue;
      statistic += (count[size_t(r * w + c)] - expected) * (count[size_t(r * w + c)] - expected) / expected;
      ++cells;
    }
  ASSERT_GT(cells, 100);
  EXPECT_NEAR(statistic, cells, 5 * std::sqrt(2 * cells));
}

TEST(EnvironmentMap, EstimatesTheLightThereIs) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const EnvironmentMap map = random_map(seed);
    const double truth = integrate(2000, [&](const Vec3& d) { return luminance(map.radiance(d)); });
    double sum = 0;
    const int side = 300;
    for (int i = 0; i < side * side; ++i) {
      const LightSample s = map.sample({(float(i % side) + 0.5f) / side, (float(i / side) + 0.5f) / side});
      sum += luminance(s.radiance) / s.pdf;
    }
    EXPECT_NEAR(sum / (side * side), truth, 0.01 * truth);
  }
}

TEST(EnvironmentMap, ExtremeNumbersStayInside) {
  const EnvironmentMap maps[] = {random_map(3), EnvironmentMap::make(EnvironmentPreset::white), EnvironmentMap(1, 1, {Vec3(1)}),
                                 EnvironmentMap(2, 1, {Vec3(0), Vec3(0)})};
  for (const EnvironmentMap& map : maps)
    for (const float u : {0.f, 0x1p-24f, 0.5f, 0x1.fffffep-1f})
      for (const float v : {0.f, 0x1p-24f, 0.5f, 0x1.fffffep-1f}) {
        const LightSample s = map.sample({u, v});
        EXPECT_NEAR(glm::length(s.direction), 1, 1e-5f);
        EXPECT_TRUE(s.pdf > 0 && std::isfinite(s.pdf));
        EXPECT_TRUE(std::isfinite(s.radiance.x));
      }
}

TEST(EnvironmentPresets, AreFiniteAndUseful) {
  for (const auto& [name, preset] : EnumNames<EnvironmentPreset>::values) {
    SCOPED_TRACE(name);
    const EnvironmentMap map = EnvironmentMap::make(preset);
    for (const Vec3& t : map.texels())
      for (int c = 0; c < 3; ++c) ASSERT_TRUE(t[c] >= 0 && t[c] < 20);
    // A white matte thing under it is neither black nor far beyond white.
    const double mean = integrate(400, [&](const Vec3& d) { return luminance(map.radiance(d)) * std::max(d.y, 0.f); }) / k_pi;
    EXPECT_GT(mean, 0.3);
    EXPECT_LT(mean, 2);
  }
  EXPECT_NEAR(EnvironmentMap::make(EnvironmentPreset::white).pdf({0.6f, 0, 0.8f}), 1 / (4 * k_pi), 1e-5);
}

// Floor and backdrop are one sweep: what a matte floor sends back is what is seen just above the horizon, to both sides of -z.
TEST(EnvironmentPresets, TheFloorOfTheCycloramaRunsIntoItsBackdrop) {
  const EnvironmentMap map = EnvironmentMap::make(EnvironmentPreset::cyclorama);
  const Vec3d floor(0.15, 0.165, 0.19); // as the manual says
  for (int c = 0; c < 3; ++c) {
    const double sent = floor[c] * integrate(800, [&](const Vec3& d) { return map.radiance(d)[c] * std::max(d.y, 0.f); }) / k_pi;
    for (const double degrees : {-55.0, -30.0, 0.0, 30.0, 55.0}) {
      const double a = degrees * k_pi / 180;
      EXPECT_NEAR(map.radiance(glm::normalize(Vec3(std::sin(a), 0.004, -std::cos(a))))[c], sent, 0.01 * sent) << degrees;
    }
  }
}

// --- files ---

class EnvironmentFiles : public testing::Test {
protected:
  std::string path(const std::string& name) const { return testing::TempDir() + name; }

  /// A Radiance file of one colour, uncompressed: mantissas and an exponent.
  std::vector<unsigned char> radiance_file(int width, int height) const {
    const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n";
    std::vector<unsigned char> bytes(header.begin(), header.end());
    for (int i = 0; i < width * height; ++i) bytes.insert(bytes.end(), {128, 64, 32, 129}); // (1, 0.5, 0.25)
    return bytes;
  }

  ExitStatus status_of(const std::string& file) {
    try {
      EnvironmentMap::load(file, diagnostics_);
      return ExitStatus::ok;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(file), std::string::npos) << e.what();
      return e.status;
    }
  }

  Diagnostics diagnostics_;
};

TEST_F(EnvironmentFiles, RadianceIsLinearRec709) {
  write_file_atomically(path("one.hdr"), radiance_file(4, 2));
  const EnvironmentMap map = EnvironmentMap::load(path("one.hdr"), diagnostics_);
  EXPECT_EQ(map.width(), 4);
  const Vec3 expected = to_scene_linear(Vec3(1, 0.5f, 0.25f), "Linear Rec.709");
  EXPECT_NEAR(glm::length(map.texels()[3] - expected), 0, 0.01f);
  EXPECT_TRUE(diagnostics_.warnings().empty());
}

TEST_F(EnvironmentFiles, OurOwnExrIsTakenAsItIs) {
  FrameImage image({4, 2});
  for (const char* name : {"B", "G", "R"}) image.add(name).pixels.assign(8, name[0] == 'R' ? 2.f : 0.5f);
  write_exr(path("own.exr"), image, {});
  const EnvironmentMap map = EnvironmentMap::load(path("own.exr"), diagnostics_);
  EXPECT_NEAR(glm::length(map.texels()[0] - Vec3(2, 0.5f, 0.5f)), 0, 1e-5f);
}

TEST_F(EnvironmentFiles, WhatIsNoLightIsCleanedWithAWarning) {
  FrameImage image({4, 2});
  for (const char* name : {"R", "G", "B"}) image.add(name).pixels.assign(8, 1.f);
  image.find("G")->pixels[2] = -5;
  write_exr(path("negative.exr"), image, {});
  const EnvironmentMap map = EnvironmentMap::load(path("negative.exr"), diagnostics_);
  EXPECT_EQ(diagnostics_.warnings().size(), 1u);
  for (const Vec3& t : map.texels()) EXPECT_TRUE(t.y >= 0);
}

// A sun that was too bright for the file's half floats is bright.
TEST_F(EnvironmentFiles, AnInfinitePixelIsTheLargestHalf) {
  const EnvironmentMap map = EnvironmentMap::load(KELPIE_CASES "/env_inf.exr", diagnostics_);
  ASSERT_EQ(diagnostics_.warnings().size(), 1u);
  EXPECT_NE(to_string(diagnostics_.warnings()[0]).find("3 values are infinite; they are taken as 65504"), std::string::npos);
  float most = 0;
  for (const Vec3& t : map.texels()) most = std::max({most, t.x, t.y, t.z});
  EXPECT_NEAR(most, 65504, 700);
}

TEST_F(EnvironmentFiles, BrokenOnesAreErrors) {
  const std::string file = path("broken.hdr");
  const std::vector<unsigned char> whole = radiance_file(64, 32);
  EXPECT_EQ(status_of(path("none.hdr")), ExitStatus::missing_input);
  for (const size_t cut : {size_t(0), size_t(1), size_t(12), size_t(60), whole.size() / 2, whole.size() - 1}) {
    write_file_atomically(file, std::span(whole).first(cut));
    EXPECT_EQ(status_of(file), ExitStatus::bad_data) << "cut at " << cut;
  }
  for (const char* size : {"-Y 70000 +X 70000", "-Y 60000 +X 60000", "-Y 0 +X 5", "-Y -1 +X 5", "-Y 4000 +X 4000", "+Q 2 +X 2"}) {
    const std::string text = std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n") + size + "\n0123456789";
    write_file_atomically(file, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
    EXPECT_EQ(status_of(file), ExitStatus::bad_data) << size;
  }
  const std::string png = "\x89PNG\r\n\x1a\n";
  write_file_atomically(file, {reinterpret_cast<const unsigned char*>(png.data()), png.size()});
  EXPECT_EQ(status_of(file), ExitStatus::bad_data) << "whatever its name is";
}

TEST_F(EnvironmentFiles, RealMapsAreRead) {
  const char* data = std::getenv("KELPIE_DATA");
  if (!data) GTEST_SKIP() << "KELPIE_DATA is not set: no real maps";
  const std::tuple<const char*, int, double> maps[] = {
      {"pmndrs_studio_1k.hdr", 1024, 1.888}, {"pmndrs_sunset_256.hdr", 256, 0.44}, {"blender_studio_512_zip_half.exr", 512, 0.2561}};
  for (const auto& [name, width, mean] : maps) {
    const EnvironmentMap map = EnvironmentMap::load(std::string(data) + "/hdri/" + name, diagnostics_);
    EXPECT_EQ(map.width(), width);
    double sum = 0;
    for (const Vec3& t : map.texels()) sum += (double(t.x) + t.y + t.z) / 3;
    EXPECT_NEAR(sum / double(map.texels().size()), mean, 0.05 * mean) << name; // the mean is stated before conversion
  }
}

TEST(Environments, KnowHowEvenTheyAre) {
  const auto evenness = [](const auto& radiance) {
    std::vector<Vec3> texels;
    for (int row = 0; row < 64; ++row)
      for (int column = 0; column < 128; ++column) texels.emplace_back(radiance(row, column));
    return EnvironmentMap(128, 64, texels).evenness();
  };
  EXPECT_NEAR(evenness([](int, int) { return 3.f; }), 1, 1e-5);
  EXPECT_NEAR(evenness([](int row, int) { return row < 32 ? 2.f : 0.f; }), 0.5, 0.02);
  EXPECT_NEAR(evenness([](int, int column) { return column < 16 ? 1.f : 0.f; }), 0.125, 0.01);
  EXPECT_EQ(evenness([](int, int) { return 0.f; }), 1);
  EXPECT_LT(EnvironmentMap::make(EnvironmentPreset::studio).evenness(), 0.2f);
  EXPECT_GT(EnvironmentMap::make(EnvironmentPreset::sky).evenness(), 0.6f);
}

} // namespace
} // namespace kelpie
