// A frame's pixels as they are in its file: row by row, of each row one channel after another in ascending order of their names, each value
// at its channel's depth. That is what EXR's scanlines hold before they are compressed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "renderer/film/frame_image.h"

namespace kelpie {

inline size_t size_of(ChannelDepth depth) { return depth == ChannelDepth::half ? 2 : 4; }

struct PackedPixels {
  std::vector<unsigned char> bytes;
  std::vector<size_t> order;   ///< the channels of the frame, by name
  std::vector<size_t> offsets; ///< of each channel of the frame in a row
  size_t row_size = 0;

  /// Room for the pixels of a frame, which may have none yet.
  explicit PackedPixels(const FrameImage&);
};

/// What was written instead of values that a channel cannot hold.
struct ReplacedValues {
  size_t clamped = 0;   ///< values beyond 65504 in half channels: ±65504
  size_t nonfinite = 0; ///< infinities: the largest value; NaNs: 0
};

/// Throws Error internal where a channel has not as many values as there are pixels.
PackedPixels pack(const FrameImage&, ReplacedValues&);

/// Back to float, into the channels of the frame.
void unpack(const PackedPixels&, FrameImage&);

/// The PixelHash, as 32 hex digits.
std::string hash_of(const PackedPixels&, const FrameImage&);

} // namespace kelpie
