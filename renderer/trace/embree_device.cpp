#include "renderer/trace/embree_device.h"

#include <new>
#include <stdexcept>
#include <string>

#include "renderer/trace/cell_scene.h"

namespace kelpie {

namespace {

void throw_if(RTCError error) {
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE) throw std::runtime_error("Embree: error " + std::to_string(error));
}

} // namespace

EmbreeDevice::EmbreeDevice() {
  flush_denormals_in_this_thread();
  device_ = rtcNewDevice(nullptr);
  if (!device_) {
    throw_if(rtcGetDeviceError(nullptr));
    throw std::runtime_error("Embree: no device");
  }
  const auto on_error = [](void* self, RTCError code, const char*) {
    RTCError none = RTC_ERROR_NONE; // what fails later fails because of the first
    static_cast<EmbreeDevice*>(self)->error_.compare_exchange_strong(none, code);
  };
  const auto on_memory = [](void* self, ssize_t bytes, bool) {
    static_cast<EmbreeDevice*>(self)->bytes_ += bytes;
    return true;
  };
  rtcSetDeviceErrorFunction(device_, on_error, this);
  rtcSetDeviceMemoryMonitorFunction(device_, on_memory, this);
}

EmbreeDevice::~EmbreeDevice() { rtcReleaseDevice(device_); }

void EmbreeDevice::check() const { throw_if(error_); }

} // namespace kelpie
