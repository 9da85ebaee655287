#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.h"
#include "colour/spaces.h"
#include "colour/view.h"

namespace kelpie {
namespace {

void expect_near(const Vec3& a, const Vec3& b, float tolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "channel " << i;
}

class ColourTest : public testing::Test {
protected:
  void SetUp() override {
    unsetenv("OCIO");
    use_ocio_config("");
  }
  void TearDown() override { SetUp(); }
};

TEST_F(ColourTest, WhiteIsOneInEverySpace) {
  for (const char* space : {"sRGB", "Linear Rec.709", "ACEScg", "ACES2065-1", "color_picking", "texture_paint", "scene_linear"})
    expect_near(to_scene_linear(Vec3(1), space), Vec3(1), 2e-5f);
}

TEST_F(ColourTest, PrimariesMatchThePublishedMatrix) {
  // Linear Rec.709 to ACEScg with Bradford adaptation, as published with the ACES configs.
  expect_near(to_scene_linear(Vec3(1, 0, 0), "Linear Rec.709"), Vec3(0.613097f, 0.070194f, 0.020616f), 1e-4f);
  expect_near(to_scene_linear(Vec3(0, 1, 0), "lin_rec709"), Vec3(0.339523f, 0.916354f, 0.109570f), 1e-4f);
  expect_near(to_scene_linear(Vec3(0, 0, 1), "sRGB"), Vec3(0.047379f, 0.013452f, 0.869815f), 1e-4f);
}

TEST_F(ColourTest, SrgbCurveIsTheStandardsCurve) {
  for (const float v : {0.01f, 0.04045f, 0.2f, 0.5f, 0.735f, 1.f}) {
    const float linear = v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
    expect_near(to_scene_linear(Vec3(v), "sRGB"), Vec3(linear), 2e-5f);
  }
}

TEST_F(ColourTest, DataIsLeftAlone) {
  expect_near(to_scene_linear(Vec3(-3, 0.25f, 700), "data"), Vec3(-3, 0.25f, 700), 0);
  expect_near(to_scene_linear(Vec3(-3, 0.25f, 700), "raw"), Vec3(-3, 0.25f, 700), 0);
}

TEST_F(ColourTest, ImagesEqualSingleColours) {
  std::vector<float> pixels;
  const size_t n = 100'000; // several bands
  for (size_t i = 0; i < n; ++i) pixels.insert(pixels.end(), {0.1f, float(i) / n, 0.7f, 0.5f});
  to_scene_linear(pixels.data(), n, 4, "sRGB");
  for (size_t i = 0; i < n; i += 9973) {
    expect_near({pixels[4 * i], pixels[4 * i + 1], pixels[4 * i + 2]}, to_scene_linear(Vec3(0.1f, float(i) / n, 0.7f), "sRGB"), 0);
    EXPECT_EQ(pixels[4 * i + 3], 0.5f);
  }
}

TEST_F(ColourTest, ChromaticitiesAgreeWithNamedSpaces) {
  const Chromaticities rec709{0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
  float rgb[3] = {0.9f, 0.2f, 0.05f};
  to_scene_linear(rgb, 1, 3, rec709);
  expect_near({rgb[0], rgb[1], rgb[2]}, to_scene_linear(Vec3(0.9f, 0.2f, 0.05f), "Linear Rec.709"), 1e-4f);
  EXPECT_THROW(to_scene_linear(rgb, 1, 3, Chromaticities{}), Error);
}

TEST_F(ColourTest, WorkingSpaceIsAp1) {
  const auto c = scene_linear_chromaticities();
  ASSERT_TRUE(c);
  EXPECT_FLOAT_EQ((*c)[0], 0.713f);
  EXPECT_FLOAT_EQ((*c)[7], 0.33767f);
}

TEST_F(ColourTest, UnknownNamesSayWhatIsKnown) {
  try {
    to_scene_linear(Vec3(1), "sRBG");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.status, ExitStatus::bad_data);
    EXPECT_NE(std::string(e.what()).find("ACEScg"), std::string::npos) << e.what();
  }
  try {
    DisplayView("filmic");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.status, ExitStatus::usage);
  }
}

TEST_F(ColourTest, BadConfigIsNeverReplaced) {
  const auto status = [](auto&& act) {
    try {
      act();
      return ExitStatus::ok;
    } catch (const Error& e) {
      return e.status;
    }
  };
  EXPECT_EQ(status([] { use_ocio_config("/no/such/config.ocio"); }), ExitStatus::missing_input);
  EXPECT_EQ(status([] { to_scene_linear(Vec3(1), "sRGB"); }), ExitStatus::missing_input) << "still the bad one";
  setenv("OCIO", "/no/such/config.ocio", 1);
  EXPECT_EQ(status([] { use_ocio_config(""); }), ExitStatus::missing_input);
  const std::string broken = testing::TempDir() + "broken.ocio";
  std::ofstream(broken) << "ocio_profile_version: 2\nroles: [";
  setenv("OCIO", broken.c_str(), 1);
  EXPECT_EQ(status([] { use_ocio_config(""); }), ExitStatus::missing_input);
}

TEST_F(ColourTest, OwnSpacesAreReachedThroughAForeignConfig) {
  const std::string path = testing::TempDir() + "foreign.ocio";
  std::ofstream(path) << R"(ocio_profile_version: 2
roles: {scene_linear: mine, aces_interchange: aces}
file_rules: [!<Rule> {name: Default, colorspace: mine}]
displays: {screen: [!<View> {name: only, colorspace: mine}]}
colorspaces:
  - !<ColorSpace> {name: aces}
  - !<ColorSpace>
    name: mine
    to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
)";
  use_ocio_config(path);
  expect_near(to_scene_linear(Vec3(1, 0, 0), "Linear Rec.709"), Vec3(0.613097f, 0.070194f, 0.020616f), 1e-4f);
  EXPECT_TRUE(scene_linear_chromaticities());
  EXPECT_EQ(view_names(), std::vector<std::string>{"only"});
}

TEST_F(ColourTest, ViewsStayOnTheDisplay) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const char* name : {"ACES", "sRGB"}) {
    std::vector<float> rgb{0, 0, 0, 0.18f, 0.18f, 0.18f, 1, 1, 1, 1000, 900, 800, -1, 0.5f, 2, nan, inf, 1};
    DisplayView(name).apply(rgb.data(), rgb.size() / 3, 3);
    for (const float v : rgb) EXPECT_TRUE(v >= 0 && v <= 1) << name << " " << v;
    EXPECT_NEAR(rgb[3], name[0] == 'A' ? 0.35f : 0.4614f, 0.01f) << "middle grey in " << name;
  }
}

} // namespace
} // namespace kelpie
