// A finished frame as data: what the integrator fills, what output/ writes and reads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/vec.h"

namespace kelpie {

/// Pixels [x0, x1) × [y0, y1), counted from the top left of the picture; x to the right, y down.
struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool is_empty() const { return x1 <= x0 || y1 <= y0; }
  size_t area() const { return is_empty() ? 0 : size_t(width()) * size_t(height()); }
  friend bool operator==(const PixelBox&, const PixelBox&) = default;
};

/// How many bits a channel has in the file. In memory all are float.
enum class ChannelDepth { half, full };

/// One channel over the data window, row by row from the top.
struct FrameChannel {
  std::string name;
  ChannelDepth depth = ChannelDepth::half;
  std::vector<float> pixels;
};

/// R, G, B: scene-linear, premultiplied by A (coverage). Z: distance along the camera's axis, scene units,
/// 1e10 where nothing was hit. P.X P.Y P.Z: world position. N.X N.Y N.Z: world normal. albedo.R G B. cost: evaluations of
/// fields a sample.
struct FrameImage {
  Vec2i resolution{0, 0}; ///< the display window is (0, 0) to here
  PixelBox data_window;   ///< the pixels there are: the crop, or the whole picture
  std::vector<FrameChannel> channels;

  FrameImage() = default;
  FrameImage(Vec2i size, PixelBox window) : resolution(size), data_window(window) {}
  explicit FrameImage(Vec2i size) : FrameImage(size, PixelBox{0, 0, size.x, size.y}) {}

  /// A new channel of zeros at its usual depth (Z, P.*, motion.* and cost full, others half). The reference
  /// is good until the next add().
  FrameChannel& add(std::string name) {
    const ChannelDepth depth = usual_depth(name);
    return channels.emplace_back(FrameChannel{std::move(name), depth, std::vector<float>(data_window.area())});
  }

  const FrameChannel* find(std::string_view name) const {
    const auto at = std::find_if(channels.begin(), channels.end(), [&](const FrameChannel& c) { return c.name == name; });
    return at == channels.end() ? nullptr : &*at;
  }
  FrameChannel* find(std::string_view name) { return const_cast<FrameChannel*>(std::as_const(*this).find(name)); }

  /// Where pixel (x, y) of the picture lies in a channel; it must be inside the data window.
  size_t index(int x, int y) const { return size_t(y - data_window.y0) * size_t(data_window.width()) + size_t(x - data_window.x0); }

  /// Geometry needs 24 bits (a position in half is off by a pixel at a few hundred units), and so do counts; light does not.
  static ChannelDepth usual_depth(std::string_view name) {
    const bool is_geometry = name == "Z" || name.substr(0, 2) == "P." || name.substr(0, 7) == "motion.";
    return is_geometry || name == "cost" ? ChannelDepth::full : ChannelDepth::half;
  }
};

} // namespace kelpie
