#include "renderer/output/pixel_hash.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <new>

#include <fmt/format.h>
#include <xxhash.h>

namespace kelpie {

struct PixelHash::State {
  XXH3_state_t* xxh = XXH3_createState();
  ~State() { XXH3_freeState(xxh); }
};

PixelHash::PixelHash() : state_(std::make_unique<State>()) {
  if (!state_->xxh) throw std::bad_alloc();
  XXH3_128bits_reset(state_->xxh);
}

PixelHash::~PixelHash() = default;

void PixelHash::add(Vec2i resolution, const PixelBox& w) {
  const std::array<int, 6> numbers{resolution.x, resolution.y, w.x0, w.y0, w.x1, w.y1};
  XXH3_128bits_update(state_->xxh, numbers.data(), sizeof numbers);
}

void PixelHash::add(const std::string& channel_name, size_t value_size) {
  XXH3_128bits_update(state_->xxh, channel_name.c_str(), channel_name.size() + 1);
  const unsigned char size = static_cast<unsigned char>(value_size);
  XXH3_128bits_update(state_->xxh, &size, 1);
}

namespace {

/// A constant size: the copy becomes one move.
template <size_t k_size>
void gather(unsigned char* out, const unsigned char* values, size_t stride, size_t count) {
  for (size_t i = 0; i < count; ++i) std::memcpy(out + i * k_size, values + i * stride, k_size);
}

} // namespace

void PixelHash::add(size_t value_size, const unsigned char* values, size_t stride, size_t count) {
  std::array<unsigned char, 16384> plane;
  while (count > 0) {
    const size_t n = std::min(count, plane.size() / value_size);
    (value_size == 2 ? gather<2> : gather<4>)(plane.data(), values, stride, n);
    XXH3_128bits_update(state_->xxh, plane.data(), n * value_size);
    count -= n, values += n * stride;
  }
}

std::string PixelHash::hex() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->xxh);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

} // namespace kelpie
