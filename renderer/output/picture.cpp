#include "renderer/output/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>

#include <fmt/format.h>

#include "base/error.h"
#include "colour/spaces.h"
#include "renderer/images/image_library.h"

namespace kelpie {

namespace {

constexpr float k_miss = 1e9f; // Z of a pixel that shows nothing is 1e10

using Channels = std::array<const FrameChannel*, 3>;

/// NAME's channels by these suffixes; false unless all three are there.
bool find_group(const FrameImage& image, const std::string& name, const char* suffixes, Channels& found) {
  for (size_t c = 0; c < 3; ++c) {
    found[c] = image.find(name.empty() ? std::string(1, suffixes[c]) : fmt::format("{}.{}", name, suffixes[c]));
    if (!found[c]) return false;
  }
  return true;
}

/// A black picture of the display window, filled from the data window: value(channel 0..2, index of the pixel).
template <class Value>
Picture fill(const FrameImage& image, bool is_light, Value&& value) {
  Picture picture{image.resolution.x, image.resolution.y, {}, is_light};
  picture.rgb.resize(picture.pixel_count() * 3);
  const PixelBox& window = image.data_window;
  for (int y = std::max(window.y0, 0); y < std::min(window.y1, picture.height); ++y)
    for (int x = std::max(window.x0, 0); x < std::min(window.x1, picture.width); ++x) {
      const size_t from = image.index(x, y), to = 3 * (size_t(y) * size_t(picture.width) + size_t(x));
      for (size_t c = 0; c < 3; ++c) picture.rgb[to + c] = value(c, from);
    }
  return picture;
}

/// A channel's values from low to high, for a scale of greys.
struct Extent {
  float lower = 0, upper = 0;
  float fraction(float v) const { return upper > lower ? std::clamp((v - lower) / (upper - lower), 0.f, 1.f) : 0; }
};

/// The extent of the values for which is_shown(index), but for this part of them at either end.
template <class IsShown>
Extent extent_of(const std::vector<float>& values, float part_cut, IsShown&& is_shown) {
  std::vector<float> shown;
  for (size_t i = 0; i < values.size(); ++i)
    if (is_shown(i)) shown.push_back(values[i]);
  if (shown.empty()) return {};
  const auto at = [&](double part) {
    const auto place = shown.begin() + static_cast<std::ptrdiff_t>(part * double(shown.size() - 1));
    std::nth_element(shown.begin(), place, shown.end());
    return *place;
  };
  return {at(part_cut), at(1 - part_cut)};
}

/// By inverse distance: a floor that reaches the horizon leaves contrast for what stands on it.
Picture depth_picture(const FrameImage& image, const FrameChannel& z) {
  std::vector<float> nearness(z.pixels.size());
  for (size_t i = 0; i < nearness.size(); ++i) nearness[i] = z.pixels[i] > 0 && z.pixels[i] < k_miss ? 1 / z.pixels[i] : 0.f;
  const Extent extent = extent_of(nearness, 0, [&](size_t i) { return nearness[i] > 0; });
  return fill(image, false, [&](size_t, size_t i) { return nearness[i] > 0 ? 0.15f + 0.85f * extent.fraction(nearness[i]) : 0.f; });
}

Picture position_picture(const FrameImage& image, const Channels& p) {
  const auto is_hit = [&](size_t i) { return p[0]->pixels[i] != 0 || p[1]->pixels[i] != 0 || p[2]->pixels[i] != 0; };
  std::array<Extent, 3> extents;
  for (size_t c = 0; c < 3; ++c) extents[c] = extent_of(p[c]->pixels, 0.05f, is_hit); // the far end of a floor is not of interest
  return fill(image, false, [&](size_t c, size_t i) { return is_hit(i) ? extents[c].fraction(p[c]->pixels[i]) : 0.f; });
}

Picture normal_picture(const FrameImage& image, const Channels& n) {
  return fill(image, false, [&](size_t c, size_t i) {
    const bool is_hit = n[0]->pixels[i] != 0 || n[1]->pixels[i] != 0 || n[2]->pixels[i] != 0;
    return is_hit ? 0.5f + 0.5f * n[c]->pixels[i] : 0.f;
  });
}

Picture grey_picture(const FrameImage& image, const FrameChannel& channel) {
  if (channel.name == "A") return fill(image, false, [&](size_t, size_t i) { return channel.pixels[i]; });
  const Extent extent = extent_of(channel.pixels, 0, [](size_t) { return true; });
  return fill(image, false, [&](size_t, size_t i) { return extent.fraction(channel.pixels[i]); });
}

/// Powers of ten from black to white, by colours that grow brighter all the way.
Picture cost_picture(const FrameImage& image, const FrameChannel& cost) {
  constexpr std::array<std::array<float, 3>, 6> k_scale{
      {{0, 0, 0}, {0.1f, 0.2f, 0.8f}, {0.1f, 0.7f, 0.2f}, {1, 0.9f, 0.1f}, {1, 0.2f, 0.1f}, {1, 1, 1}}};
  return fill(image, false, [&](size_t c, size_t i) {
    const float place = std::clamp(std::log10(std::max(cost.pixels[i], 1.f)), 0.f, float(k_scale.size() - 1));
    const size_t below = std::min(static_cast<size_t>(place), k_scale.size() - 2);
    return std::lerp(k_scale[below][c], k_scale[below + 1][c], place - static_cast<float>(below));
  });
}

Picture light_picture(const FrameImage& image, const Channels& channels) {
  return fill(image, true, [&](size_t c, size_t i) { return channels[c]->pixels[i]; });
}

} // namespace

Picture picture_of(const DecodedFrame& frame, const std::string& name) {
  Picture picture = picture_of(frame.image, name);
  if (!picture.is_light) return picture;
  if (frame.chromaticities && frame.chromaticities != scene_linear_chromaticities())
    to_scene_linear(picture.rgb.data(), picture.pixel_count(), 3, *frame.chromaticities);
  else if (!frame.chromaticities && frame.claimed_hash.empty())
    to_scene_linear(picture.rgb.data(), picture.pixel_count(), 3, k_space_linear_rec709);
  return picture;
}

Picture picture_of(const FrameImage& image, const std::string& name) {
  Channels group;
  if (find_group(image, name, "RGB", group)) return light_picture(image, group);
  if (name == "Z" && image.find(name)) return depth_picture(image, *image.find(name));
  if (find_group(image, name, "XYZ", group)) return name == "N" ? normal_picture(image, group) : position_picture(image, group);
  if (const FrameChannel* channel = image.find(name.empty() ? "Y" : name)) {
    if (name.empty()) return light_picture(image, {channel, channel, channel}); // EXR's luminance pictures
    if (name == "cost") return cost_picture(image, *channel);
    return grey_picture(image, *channel);
  }
  std::vector<std::string> names;
  for (const FrameChannel& c : image.channels) names.push_back(c.name);
  throw Error(ExitStatus::usage, fmt::format("no channel \"{}\"; there are: {}", name.empty() ? "R" : name, fmt::join(names, ", ")));
}

Picture resize(const Picture& picture, int width) {
  const int height = std::max(1, static_cast<int>(std::lround(double(picture.height) * width / picture.width)));
  Picture resized{width, height, std::vector<float>(size_t(width) * size_t(height) * 3), picture.is_light};
  const PixelRows from{picture.width, picture.height, const_cast<float*>(picture.rgb.data())}, to{width, height, resized.rgb.data()};
  if (const auto why = image_library().resize(from, to)) throw Error(ExitStatus::internal, "resizing failed: " + *why);
  return resized;
}

void paste(Picture& into, const Picture& picture, int left, int top) {
  for (int y = 0; y < std::min(picture.height, into.height - top); ++y)
    std::copy_n(picture.rgb.begin() + 3 * size_t(y) * size_t(picture.width), 3 * size_t(picture.width),
                into.rgb.begin() + 3 * (size_t(top + y) * size_t(into.width) + size_t(left)));
}

void develop(Picture& picture, const DisplayView& view, float exposure) {
  if (!picture.is_light) {
    for (float& v : picture.rgb) v = v > 0 ? std::min(v, 1.f) : 0.f;
    return;
  }
  const float scale = std::exp2(exposure);
  if (exposure != 0)
    for (float& v : picture.rgb) v *= scale;
  view.apply(picture.rgb.data(), picture.pixel_count(), 3);
}

std::vector<uint8_t> to_8_bit(const Picture& picture) {
  std::vector<uint8_t> bytes(picture.rgb.size());
  std::transform(picture.rgb.begin(), picture.rgb.end(), bytes.begin(), [](float v) { return static_cast<uint8_t>(v * 255 + 0.5f); });
  return bytes;
}

namespace {

/// The 8 x 8 matrix of Bayer (1973) as numbers between 0 and 1: what is rounded down after one of them was added is, on average over the
/// matrix, the value itself. A whole number stays what it is.
float dither_threshold(unsigned x, unsigned y) {
  unsigned rank = 0;
  for (unsigned bit = 0; bit < 3; ++bit) rank = 4 * rank + 2 * (((x ^ y) >> bit) & 1) + ((y >> bit) & 1);
  return (static_cast<float>(rank) + 0.5f) / 64;
}

} // namespace

std::vector<uint8_t> dithered_to_8_bit(const Picture& picture) {
  std::vector<uint8_t> bytes(picture.rgb.size());
  size_t i = 0;
  for (unsigned y = 0; y < unsigned(picture.height); ++y)
    for (unsigned x = 0; x < unsigned(picture.width); ++x)
      for (const size_t end = i + 3; i < end; ++i) bytes[i] = static_cast<uint8_t>(picture.rgb[i] * 255 + dither_threshold(x, y));
  return bytes;
}

std::vector<unsigned char> encode_png(const Picture& picture, int bits, bool is_srgb) {
  std::vector<unsigned char> bytes;
  ImageLibrary::Failure why;
  if (bits == 16) {
    std::vector<uint16_t> values(picture.rgb.size());
    std::transform(picture.rgb.begin(), picture.rgb.end(), values.begin(), [](float v) { return static_cast<uint16_t>(v * 65535 + 0.5f); });
    why = image_library().encode_png(picture.width, picture.height, bits, values.data(), is_srgb, bytes);
  } else {
    const std::vector<uint8_t> values = dithered_to_8_bit(picture);
    why = image_library().encode_png(picture.width, picture.height, bits, values.data(), is_srgb, bytes);
  }
  if (!why) return bytes;
  if (why->empty()) throw std::bad_alloc(); // encoding to memory fails for lack of it
  throw Error(ExitStatus::internal, "the PNG encoder failed: " + *why);
}

std::string base64(const std::vector<unsigned char>& bytes) {
  constexpr const char* k_digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(3, bytes.size() - i);
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k) group = group << 8 | (k < count ? bytes[i + k] : 0u);
    for (size_t k = 0; k < 4; ++k) text += k <= count ? k_digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

} // namespace kelpie
