// Environment maps from files.
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "base/file_bytes.h"
#include "colour/spaces.h"
#include "renderer/images/image_library.h"
#include "renderer/light/environment_map.h"
#include "renderer/output/exr.h"

namespace kelpie {

namespace {

constexpr int k_max_map_side = 65536;
constexpr float k_largest_texel = 65504;
constexpr size_t k_max_texels = size_t(1) << 27; // 1.5 GB of floats

/// Texels as they are in the file, three floats each.
struct RawMap {
  int width = 0, height = 0;
  std::vector<float> rgb;
  std::optional<Chromaticities> chromaticities;
};

[[noreturn]] void fail(const std::string& path, const std::string& why) {
  throw Error(ExitStatus::bad_data, fmt::format("{}: {}", path, why));
}

void check_size(const std::string& path, int width, int height) {
  if (width < 1 || height < 1 || width > k_max_map_side || height > k_max_map_side || size_t(width) * size_t(height) > k_max_texels)
    fail(path, fmt::format("{}×{} pixels are no map of a size that can be used", width, height));
}

RawMap read_radiance(const std::string& path, const std::string& bytes) {
  RawMap map;
  const auto make_room = [&](int width, int height, int channels) {
    check_size(path, width, height);
    // A run of 127 equal values takes two bytes: fewer bytes than that make no such picture.
    if (channels != 3 || size_t(width) * size_t(height) * 4 / 64 > bytes.size()) fail(path, "truncated");
    map.width = width, map.height = height;
    map.rgb.resize(size_t(width) * size_t(height) * 3);
    return map.rgb.data();
  };
  if (const auto why = image_library().read_radiance(as_bytes(bytes), make_room))
    fail(path, fmt::format("not a {}Radiance HDR picture: {}", map.rgb.empty() ? "" : "whole ", *why));
  return map;
}

RawMap read_openexr(const std::string& path, const std::string& bytes) {
  const DecodedFrame frame = decode_exr(as_bytes(bytes), path);
  const PixelBox& window = frame.image.data_window;
  check_size(path, window.width(), window.height());
  RawMap map{window.width(), window.height(), std::vector<float>(window.area() * 3), frame.chromaticities};
  const char* names[3] = {"R", "G", "B"};
  for (int c = 0; c < 3; ++c) {
    const FrameChannel* channel = frame.image.find(names[c]);
    if (!channel) channel = frame.image.find("Y");
    if (!channel) fail(path, "has neither the channels R, G and B nor Y");
    for (size_t i = 0; i < window.area(); ++i) map.rgb[3 * i + size_t(c)] = channel->pixels[i];
  }
  return map;
}

} // namespace

EnvironmentMap EnvironmentMap::load(const std::string& path, Diagnostics& warnings) {
  const std::string bytes = read_file_bytes(path);
  const auto begins_with = [&](std::string_view magic) {
    return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
  };
  RawMap map;
  if (begins_with("\x76\x2f\x31\x01"))
    map = read_openexr(path, bytes);
  else if (begins_with("#?"))
    map = read_radiance(path, bytes);
  else
    fail(path, "neither a Radiance HDR (.hdr) nor an OpenEXR (.exr) picture");

  const size_t n = size_t(map.width) * size_t(map.height);
  size_t cleaned = 0, clamped = 0;
  for (float& v : map.rgb) {
    if (v == std::numeric_limits<float>::infinity()) v = k_largest_texel, ++clamped; // a sun that was too bright for its format
    if (!std::isfinite(v)) v = 0, ++cleaned;
  }
  if (map.chromaticities)
    to_scene_linear(map.rgb.data(), n, 3, *map.chromaticities);
  else
    to_scene_linear(map.rgb.data(), n, 3, k_space_linear_rec709);
  // Checked in the working space: it is wider than most files', and a colour outside of it has a negative part.
  std::vector<Vec3> texels(n);
  for (size_t i = 0; i < n; ++i)
    for (int c = 0; c < 3; ++c) {
      const float v = map.rgb[3 * i + size_t(c)];
      cleaned += v < -1e-4f || !std::isfinite(v);
      texels[i][c] = v > 0 && std::isfinite(v) ? v : 0.f;
    }
  if (clamped > 0) warnings.warning({path}, fmt::format("{} values are infinite; they are taken as {}", clamped, k_largest_texel));
  if (cleaned > 0) warnings.warning({path}, fmt::format("{} values are negative or no numbers; they are taken as 0", cleaned));
  return EnvironmentMap(map.width, map.height, std::move(texels));
}

} // namespace kelpie
