#include "renderer/output/packed_pixels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <Imath/half.h>

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

RowLayout::RowLayout(const FrameImage& image) : order(image.channels.size()), offsets(image.channels.size()) {
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return image.channels[a].name < image.channels[b].name; });
  if (image.data_window.is_empty()) return;
  width = size_t(image.data_window.width()), height = size_t(image.data_window.height());
  for (const size_t c : order) {
    offsets[c] = row_size;
    row_size += width * size_of(image.channels[c].depth);
  }
}

void pack_rows(const FrameImage& image, const RowLayout& layout, size_t first, std::span<unsigned char> out, ReplacedValues& counts) {
  for (size_t row = 0; row < out.size() / layout.row_size; ++row)
    for (const size_t c : layout.order) {
      const FrameChannel& channel = image.channels[c];
      pack_row(channel.pixels.data() + (first + row) * layout.width, layout.width, channel.depth,
               out.data() + row * layout.row_size + layout.offsets[c], counts);
    }
}

void unpack_rows(std::span<const unsigned char> rows, const RowLayout& layout, size_t first, FrameImage& image) {
  for (size_t row = 0; row < rows.size() / layout.row_size; ++row)
    for (const size_t c : layout.order) {
      FrameChannel& channel = image.channels[c];
      const unsigned char* in = rows.data() + row * layout.row_size + layout.offsets[c];
      float* const out = channel.pixels.data() + (first + row) * layout.width;
      if (channel.depth == ChannelDepth::full) {
        std::memcpy(out, in, 4 * layout.width);
      } else {
        for (size_t i = 0; i < layout.width; ++i, in += 2) {
          Imath::half h;
          std::memcpy(&h, in, 2);
          out[i] = h;
        }
      }
    }
}

PixelHash begin_hash(const FrameImage& image, const RowLayout& layout) {
  PixelHash hash;
  hash.add(image.resolution, image.data_window);
  for (const size_t c : layout.order) hash.add(image.channels[c].name, size_of(image.channels[c].depth));
  return hash;
}

} // namespace kelpie
