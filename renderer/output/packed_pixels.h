// A frame's pixels as they are in its file: row by row, of each row one channel after another in ascending order of their names, each value
// at its channel's depth. That is what EXR's scanlines hold before they are compressed.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "renderer/film/frame_image.h"
#include "renderer/output/pixel_hash.h"

namespace kelpie {

inline size_t size_of(ChannelDepth depth) { return depth == ChannelDepth::half ? 2 : 4; }

/// Where the channels of a frame stand in a row.
struct RowLayout {
  std::vector<size_t> order;   ///< the channels of the frame, by name
  std::vector<size_t> offsets; ///< of each channel of the frame in a row
  size_t width = 0, height = 0, row_size = 0;

  explicit RowLayout(const FrameImage&);
};

/// What was written instead of values that a channel cannot hold.
struct ReplacedValues {
  size_t clamped = 0;   ///< values beyond 65504 in half channels: ±65504
  size_t nonfinite = 0; ///< infinities: the largest value; NaNs: 0
};

/// Rows as they are in the file: `out` says how many, from `first` on (0: the uppermost).
void pack_rows(const FrameImage&, const RowLayout&, size_t first, std::span<unsigned char> out, ReplacedValues&);

/// Back to float, into the channels of the frame, which must have room for all pixels.
void unpack_rows(std::span<const unsigned char> rows, const RowLayout&, size_t first, FrameImage&);

/// The hash of a frame whose rows are still to be added.
PixelHash begin_hash(const FrameImage&, const RowLayout&);

} // namespace kelpie
