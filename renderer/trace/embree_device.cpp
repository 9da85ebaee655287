#include "renderer/trace/embree_device.h"

#include <new>
#include <stdexcept>
#include <string>

#include <pmmintrin.h>
#include <xmmintrin.h>

#include "renderer/trace/cell_scene.h"

namespace kelpie {

void flush_denormals_in_this_thread() {
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}

namespace {

void throw_if(RTCError error) {
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE) throw std::runtime_error("Embree: error " + std::to_string(error));
}

} // namespace

EmbreeDevice::EmbreeDevice() {
  to_builders_.give();
  flush_denormals_in_this_thread();
  device_ = rtcNewDevice(nullptr);
  if (!device_) {
    throw_if(rtcGetDeviceError(nullptr));
    throw std::runtime_error("Embree: no device");
  }
  const auto on_error = [](void* self, RTCError code, const char*) noexcept {
    static_cast<EmbreeDevice*>(self)->to_builders_.take();
    RTCError none = RTC_ERROR_NONE; // what fails later fails because of the first
    static_cast<EmbreeDevice*>(self)->error_.compare_exchange_strong(none, code);
  };
  rtcSetDeviceErrorFunction(device_, on_error, this);
  const auto on_memory = [](void* self, ssize_t bytes, bool) noexcept {
    static_cast<EmbreeDevice*>(self)->to_builders_.take();
    static_cast<EmbreeDevice*>(self)->bytes_ += bytes;
    return true;
  };
  rtcSetDeviceMemoryMonitorFunction(device_, on_memory, this);
}

EmbreeDevice::~EmbreeDevice() { rtcReleaseDevice(device_); }

RTCScene EmbreeDevice::new_scene() const {
  RTCScene scene = rtcNewScene(device_);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  return scene;
}

void EmbreeDevice::check() const { throw_if(error_); }

RTCRay to_embree(const Ray& ray) {
  RTCRay r{};
  r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z;
  r.tnear = ray.t_near, r.tfar = ray.t_far;
  r.time = ray.time, r.mask = ~0u;
  return r;
}

} // namespace kelpie
