#pragma once

#include <atomic>
#include <cstddef>

#include <embree3/rtcore.h>

namespace kelpie {

/// A device of Embree that counts what is allocated for it, and remembers what failed first.
class EmbreeDevice {
public:
  /// Throws std::bad_alloc where there is no memory for one.
  EmbreeDevice();
  ~EmbreeDevice();
  EmbreeDevice(const EmbreeDevice&) = delete;
  EmbreeDevice& operator=(const EmbreeDevice&) = delete;

  RTCDevice get() const { return device_; }
  size_t bytes() const { return static_cast<size_t>(bytes_.load()); }
  /// Throws std::bad_alloc where memory ran out in a call since it was made, std::runtime_error for any other failure.
  void check() const;

private:
  RTCDevice device_ = nullptr;
  std::atomic<std::ptrdiff_t> bytes_{0};
  std::atomic<RTCError> error_{RTC_ERROR_NONE};
};

} // namespace kelpie
