#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "base/error.h"
#include "colour/spaces.h"
#include "renderer/output/picture.h"

namespace kelpie {
namespace {

/// 4 x 2 pixels, of which the middle 2 x 2 exist; the right ones of these hit nothing.
DecodedFrame small_frame() {
  DecodedFrame frame;
  frame.image = FrameImage({4, 2}, PixelBox{1, 0, 3, 2});
  const auto set = [&](const char* name, std::vector<float> pixels) { frame.image.add(name).pixels = std::move(pixels); };
  set("R", {1, 0.25f, 4, 0}), set("G", {1, 0.5f, 2, 0}), set("B", {1, 0.75f, 1, 0}), set("A", {1, 0, 1, 0});
  set("Z", {2, 1e10f, 4, 1e10f});
  set("N.X", {0, 0, 1, 0}), set("N.Y", {0, 0, 0, 0}), set("N.Z", {-1, 0, 0, 0});
  frame.claimed_hash = "kelpie's own";
  return frame;
}

Vec3 at(const Picture& p, int x, int y) {
  const float* rgb = &p.rgb[3 * size_t(y * p.width + x)];
  return {rgb[0], rgb[1], rgb[2]};
}

TEST(Pictures, ColoursAreOverBlack) {
  const Picture p = picture_of(small_frame());
  EXPECT_TRUE(p.is_light);
  EXPECT_EQ(p.width, 4);
  EXPECT_EQ(at(p, 0, 0), Vec3(0)) << "outside the data window";
  EXPECT_EQ(at(p, 1, 0), Vec3(1));
  EXPECT_EQ(at(p, 2, 0), Vec3(0.25f, 0.5f, 0.75f)) << "a background that is shown has no coverage";
}

// A file without primaries is in linear Rec.709; what was just rendered is in the scene's own.
TEST(Pictures, WhatWasRenderedStaysAsItIs) {
  DecodedFrame frame = small_frame();
  EXPECT_EQ(at(picture_of(frame.image), 2, 0), Vec3(0.25f, 0.5f, 0.75f));
  frame.claimed_hash.clear();
  EXPECT_GT(glm::length(at(picture_of(frame), 2, 0) - Vec3(0.25f, 0.5f, 0.75f)), 0.01f);
}

TEST(Pictures, DataIsDrawnAsADiagram) {
  const Picture z = picture_of(small_frame(), "Z"), n = picture_of(small_frame(), "N"), a = picture_of(small_frame(), "A");
  EXPECT_FALSE(z.is_light);
  EXPECT_EQ(at(z, 1, 0), Vec3(1)) << "nearest";
  EXPECT_NEAR(at(z, 1, 1).x, 0.15f, 1e-6f) << "farthest";
  EXPECT_EQ(at(z, 2, 0), Vec3(0)) << "a miss";
  EXPECT_EQ(at(n, 1, 0), Vec3(0.5f, 0.5f, 0));
  EXPECT_EQ(at(n, 2, 0), Vec3(0));
  EXPECT_EQ(at(a, 1, 1), Vec3(1));
}

TEST(Pictures, CostIsOnOneScaleForAllPictures) {
  DecodedFrame frame = small_frame();
  frame.image.add("cost").pixels = {0, 100, 1e5f, 1e9f};
  const Picture cost = picture_of(frame, "cost");
  EXPECT_EQ(at(cost, 1, 0), Vec3(0));
  EXPECT_EQ(at(cost, 2, 0), Vec3(0.1f, 0.7f, 0.2f));
  EXPECT_EQ(at(cost, 1, 1), Vec3(1));
  EXPECT_EQ(at(cost, 2, 1), Vec3(1));
  float before = -1; // a dearer pixel is never darker
  for (float v = 1; v < 2e5f; v *= 1.1f) {
    frame.image.find("cost")->pixels[0] = v;
    const Vec3 c = at(picture_of(frame, "cost"), 1, 0);
    if (v >= 1000) break; // from yellow to red it goes by hue
    EXPECT_GT(glm::dot(c, Vec3(0.2126f, 0.7152f, 0.0722f)), before) << v;
    before = glm::dot(c, Vec3(0.2126f, 0.7152f, 0.0722f));
  }
}

TEST(Pictures, UnknownChannelsSayWhichThereAre) {
  try {
    picture_of(small_frame(), "depth");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.status, ExitStatus::usage);
    EXPECT_NE(std::string(e.what()).find("N.X"), std::string::npos);
  }
}

TEST(Pictures, OtherProgramsFilesAreLinearRec709UnlessTheySayOtherwise) {
  DecodedFrame frame = small_frame();
  frame.claimed_hash.clear();
  const Vec3 expected = to_scene_linear(Vec3(0.25f, 0.5f, 0.75f), "Linear Rec.709");
  EXPECT_LT(glm::length(at(picture_of(frame), 2, 0) - expected), 1e-6f);
  frame.chromaticities = scene_linear_chromaticities();
  EXPECT_EQ(at(picture_of(frame), 2, 0), Vec3(0.25f, 0.5f, 0.75f));
}

TEST(Pictures, ResizingKeepsLightAndMakesNone) {
  Picture p{64, 32, std::vector<float>(64 * 32 * 3, 0.f), true};
  for (int c = 0; c < 3; ++c) p.rgb[size_t(3 * (16 * 64 + 31) + c)] = 1000; // one hot pixel
  const Picture small = resize(p, 16);
  EXPECT_EQ(small.height, 8);
  EXPECT_NEAR(std::accumulate(small.rgb.begin(), small.rgb.end(), 0.0) * 16, 3000, 150);
  for (const float v : small.rgb) EXPECT_GE(v, 0) << "no ringing";
}

TEST(Pictures, ExposureIsInStops) {
  Picture a{1, 1, {0.1f, 0.1f, 0.1f}, true}, b{1, 1, {0.4f, 0.4f, 0.4f}, true};
  const DisplayView view("sRGB");
  develop(a, view, 2), develop(b, view, 0);
  EXPECT_NEAR(a.rgb[0], b.rgb[0], 1e-6f);
  EXPECT_NEAR(b.rgb[0], 1.055 * std::pow(0.4, 1 / 2.4) - 0.055, 1e-4);
}

TEST(Pictures, PngIsTaggedAndReproducible) {
  Picture p{3, 2, std::vector<float>(18, 0.5f), false};
  EXPECT_EQ(to_8_bit(p)[0], 128);
  for (const int bits : {8, 16}) {
    const std::vector<unsigned char> png = encode_png(p, bits, true);
    EXPECT_EQ(png, encode_png(p, bits, true));
    EXPECT_EQ(png[24], bits);
    const std::string text(png.begin(), png.end());
    EXPECT_NE(text.find("sRGB"), std::string::npos);
    EXPECT_EQ(text.find("tIME"), std::string::npos);
  }
}

// 8 bits hold a value between two of theirs as a mixture of both, within 1/128 over any square of 8 x 8.
TEST(Pictures, DitherKeepsTheMean) {
  for (const float value : {0.f, 0.3f, 100 / 255.f, 100.1f / 255, 100.5f / 255, 254.9f / 255, 1.f}) {
    const Picture p{16, 8, std::vector<float>(16 * 8 * 3, value), false};
    const std::vector<uint8_t> bytes = dithered_to_8_bit(p);
    EXPECT_NEAR(std::accumulate(bytes.begin(), bytes.end(), 0.0) / double(bytes.size()), 255.0 * double(value), 1.0 / 128 + 1e-4) << value;
    const auto [least, most] = std::minmax_element(bytes.begin(), bytes.end());
    const bool is_whole = std::abs(255 * value - std::round(255 * value)) < 1e-4f;
    EXPECT_EQ(*most - *least, is_whole ? 0 : 1) << value;
  }
}

} // namespace
} // namespace kelpie
