// One hash over all pixels of a frame, independent of how they are compressed or ordered in a file.
#pragma once

#include <memory>
#include <string>

#include "renderer/film/frame_image.h"

namespace kelpie {

/// XXH3-128 of: the windows, the names of the channels with their bytes a value, and then for each row
/// from the top each channel's values, little endian. Channels are to be taken in ascending order of name.
class PixelHash {
public:
  PixelHash();
  ~PixelHash();

  void add(Vec2i resolution, const PixelBox& data_window);
  void add(const std::string& channel_name, size_t value_size);
  /// A row of a channel: `count` values of `value_size` (2 or 4) bytes, `stride` bytes from one to the next.
  void add(size_t value_size, const unsigned char* values, size_t stride, size_t count);
  /// 32 hex digits.
  std::string hex() const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace kelpie
