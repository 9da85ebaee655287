#include "renderer/output/pixel_hash.h"

#include <array>
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
PixelHash::PixelHash(PixelHash&&) noexcept = default;
PixelHash& PixelHash::operator=(PixelHash&&) noexcept = default;

void PixelHash::add(Vec2i resolution, const PixelBox& w) {
  const std::array<int, 6> numbers{resolution.x, resolution.y, w.x0, w.y0, w.x1, w.y1};
  XXH3_128bits_update(state_->xxh, numbers.data(), sizeof numbers);
}

void PixelHash::add(const std::string& channel_name, size_t value_size) {
  XXH3_128bits_update(state_->xxh, channel_name.c_str(), channel_name.size() + 1);
  const unsigned char size = static_cast<unsigned char>(value_size);
  XXH3_128bits_update(state_->xxh, &size, 1);
}

void PixelHash::add(std::span<const unsigned char> rows) { XXH3_128bits_update(state_->xxh, rows.data(), rows.size()); }

std::string PixelHash::hex() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->xxh);
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

} // namespace kelpie
