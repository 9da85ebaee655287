#include "renderer/output/packed_pixels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <Imath/half.h>
#include <fmt/format.h>

#include "base/error.h"
#include "renderer/output/pixel_hash.h"

namespace kelpie {

namespace {

constexpr float k_largest_half = 65504;

/// What the file holds instead of `v`: always finite.
float storable(float v, float largest, ReplacedValues& counts) {
  if (std::abs(v) <= largest) return v;
  if (std::isnan(v)) return ++counts.nonfinite, 0.f;
  ++(std::isinf(v) ? counts.nonfinite : counts.clamped);
  return std::copysign(largest, v);
}

void pack_row(const float* values, size_t count, ChannelDepth depth, unsigned char* out, ReplacedValues& counts) {
  if (depth == ChannelDepth::full) {
    for (size_t i = 0; i < count; ++i, out += 4) {
      const float v = storable(values[i], std::numeric_limits<float>::max(), counts);
      std::memcpy(out, &v, 4);
    }
  } else {
    for (size_t i = 0; i < count; ++i, out += 2) {
      const Imath::half h(storable(values[i], k_largest_half, counts));
      std::memcpy(out, &h, 2);
    }
  }
}

} // namespace

PackedPixels::PackedPixels(const FrameImage& image) : order(image.channels.size()), offsets(image.channels.size()) {
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return image.channels[a].name < image.channels[b].name; });
  const size_t width = image.data_window.is_empty() ? 0 : size_t(image.data_window.width());
  for (const size_t c : order) {
    offsets[c] = row_size;
    row_size += width * size_of(image.channels[c].depth);
  }
  bytes.resize(width == 0 ? 0 : row_size * size_t(image.data_window.height()));
}

PackedPixels pack(const FrameImage& image, ReplacedValues& counts) {
  const size_t n = image.data_window.area(), width = n ? size_t(image.data_window.width()) : 1;
  for (const FrameChannel& c : image.channels)
    if (c.pixels.size() != n) throw Error(ExitStatus::internal, fmt::format("channel {} has {} pixels of {}", c.name, c.pixels.size(), n));
  PackedPixels packed(image);
  for (size_t row = 0; row < n / width; ++row)
    for (const size_t c : packed.order) {
      const FrameChannel& channel = image.channels[c];
      pack_row(channel.pixels.data() + row * width, width, channel.depth, packed.bytes.data() + row * packed.row_size + packed.offsets[c],
               counts);
    }
  return packed;
}

void unpack(const PackedPixels& packed, FrameImage& image) {
  const size_t n = image.data_window.area(), width = n ? size_t(image.data_window.width()) : 1;
  for (FrameChannel& c : image.channels) c.pixels.resize(n);
  for (size_t row = 0; row < n / width; ++row)
    for (const size_t c : packed.order) {
      FrameChannel& channel = image.channels[c];
      const unsigned char* in = packed.bytes.data() + row * packed.row_size + packed.offsets[c];
      float* const out = channel.pixels.data() + row * width;
      if (channel.depth == ChannelDepth::full) {
        std::memcpy(out, in, 4 * width);
      } else {
        for (size_t i = 0; i < width; ++i, in += 2) {
          Imath::half h;
          std::memcpy(&h, in, 2);
          out[i] = h;
        }
      }
    }
}

std::string hash_of(const PackedPixels& packed, const FrameImage& image) {
  PixelHash hash;
  hash.add(image.resolution, image.data_window);
  for (const size_t c : packed.order) hash.add(image.channels[c].name, size_of(image.channels[c].depth));
  hash.add(packed.bytes);
  return hash.hex();
}

} // namespace kelpie
