// What the scenes of cells and of triangles share of Embree. Only this folder knows Embree.
#pragma once

#include <atomic>

#include <embree3/rtcore.h>

#include "base/parallel.h"
#include "renderer/trace/solve.h"

namespace kelpie {

/// A device that remembers its first error and counts its memory.
class EmbreeDevice {
public:
  /// Flushes denormals in this thread, as Embree wants it. Throws std::bad_alloc where there is no memory for a device, and
  /// std::runtime_error where Embree does not work at all.
  EmbreeDevice();
  ~EmbreeDevice();
  EmbreeDevice(const EmbreeDevice&) = delete; // Embree knows its address

  operator RTCDevice() const { return device_; } // NOLINT: it is one
  /// A scene through whose shared edges and walls no ray slips.
  RTCScene new_scene() const;
  /// Throws std::bad_alloc where Embree has run out of memory, and std::runtime_error for any other error.
  void check() const;
  /// Bytes of Embree's own structures.
  size_t bytes() const { return static_cast<size_t>(bytes_.load()); }

private:
  RTCDevice device_;
  HandOver to_builders_; ///< to the threads in which Embree calls back
  std::atomic<ssize_t> bytes_{0};
  std::atomic<RTCError> error_{RTC_ERROR_NONE};
};

/// Whether Embree takes the ray, which else ends the program: its numbers are some, and not beyond 1e18. Other rays meet
/// nothing.
inline bool is_traceable(const Ray& ray) {
  const Vec3 sum = glm::abs(ray.origin) + glm::abs(ray.direction);
  return sum.x + sum.y + sum.z <= 1e18f;
}

RTCRay to_embree(const Ray&);

} // namespace kelpie
