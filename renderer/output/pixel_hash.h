// One hash over all pixels of a frame, independent of how they are compressed or ordered in a file.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "renderer/film/frame_image.h"

namespace kelpie {

inline constexpr size_t k_pixel_hash_digits = 32;

/// XXH3-128 of: the windows, the names of the channels with their bytes a value, and then for each row
/// from the top each channel's values, little endian. Channels are to be taken in ascending order of name.
class PixelHash {
public:
  PixelHash();
  ~PixelHash();
  PixelHash(PixelHash&&) noexcept;
  PixelHash& operator=(PixelHash&&) noexcept;

  void add(Vec2i resolution, const PixelBox& data_window);
  void add(const std::string& channel_name, size_t value_size);
  /// Rows: of each all channels, one after another.
  void add(std::span<const unsigned char> rows);
  /// k_pixel_hash_digits hex digits.
  std::string hex() const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace kelpie
