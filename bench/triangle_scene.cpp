#include "bench/triangle_scene.h"

#include <array>
#include <atomic>
#include <new>

#include <embree3/rtcore.h>

namespace kelpie {

struct TriangleScene::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::atomic<ssize_t> bytes{0};
  std::atomic<RTCError> error{RTC_ERROR_NONE};

  ~State() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

namespace {

RTCIntersectContext context(bool is_coherent) {
  RTCIntersectContext c;
  rtcInitIntersectContext(&c);
  if (is_coherent) c.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return c;
}

RTCRay to_embree(const Ray& ray) {
  RTCRay r{};
  r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z;
  r.tnear = ray.t_near, r.tfar = ray.t_far, r.mask = ~0u;
  return r;
}

template <class Packet>
void fill(std::span<const Ray> rays, Packet& out, int* valid) {
  for (size_t i = 0; i < k_packet; ++i) {
    valid[i] = i < rays.size() ? -1 : 0;
    const Ray& ray = rays[i < rays.size() ? i : 0];
    out.org_x[i] = ray.origin.x, out.org_y[i] = ray.origin.y, out.org_z[i] = ray.origin.z;
    out.dir_x[i] = ray.direction.x, out.dir_y[i] = ray.direction.y, out.dir_z[i] = ray.direction.z;
    out.tnear[i] = ray.t_near, out.tfar[i] = ray.t_far, out.time[i] = 0;
    out.mask[i] = ~0u, out.id[i] = 0, out.flags[i] = 0;
  }
}

TriangleHit make_hit(const Ray& ray, float t, const Vec3& normal) { return {t, ray.origin + t * ray.direction, glm::normalize(normal)}; }

} // namespace

TriangleScene::TriangleScene(const FieldMesh& mesh) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.device = rtcNewDevice(nullptr);
  rtcSetDeviceErrorFunction(
      s.device, [](void* state, RTCError code, const char*) { static_cast<State*>(state)->error = code; }, &s);
  rtcSetDeviceMemoryMonitorFunction(
      s.device,
      [](void* state, ssize_t bytes, bool) {
        static_cast<State*>(state)->bytes += bytes;
        return true;
      },
      &s);
  s.scene = rtcNewScene(s.device);
  RTCGeometry geometry = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* points = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), mesh.points.size());
  void* indices =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), mesh.triangles.size() / 3);
  if (!points || !indices) throw std::bad_alloc();
  std::copy(mesh.points.begin(), mesh.points.end(), static_cast<Vec3*>(points));
  std::copy(mesh.triangles.begin(), mesh.triangles.end(), static_cast<uint32_t*>(indices));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(s.scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(s.scene);
  if (s.error != RTC_ERROR_NONE) throw std::bad_alloc();
}

TriangleScene::~TriangleScene() = default;

bool TriangleScene::intersect(const Ray& ray, TriangleHit& hit) const {
  RTCIntersectContext c = context(false);
  RTCRayHit r;
  r.ray = to_embree(ray);
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->scene, &c, &r);
  if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit = make_hit(ray, r.ray.tfar, Vec3(r.hit.Ng_x, r.hit.Ng_y, r.hit.Ng_z));
  return true;
}

bool TriangleScene::occluded(const Ray& ray) const {
  RTCIntersectContext c = context(false);
  RTCRay r = to_embree(ray);
  rtcOccluded1(state_->scene, &c, &r);
  return r.tfar < 0;
}

uint32_t TriangleScene::intersect(std::span<const Ray> rays, bool is_coherent, TriangleHit* hits) const {
  if (rays.empty()) return 0;
  RTCIntersectContext c = context(is_coherent);
  alignas(64) std::array<int, k_packet> valid;
  RTCRayHit16 r;
  fill(rays, r.ray, valid.data());
  std::fill(std::begin(r.hit.geomID), std::end(r.hit.geomID), RTC_INVALID_GEOMETRY_ID);
  rtcIntersect16(valid.data(), state_->scene, &c, &r);
  uint32_t found = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    if (r.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    hits[i] = make_hit(rays[i], r.ray.tfar[i], Vec3(r.hit.Ng_x[i], r.hit.Ng_y[i], r.hit.Ng_z[i]));
    found |= 1u << i;
  }
  return found;
}

uint32_t TriangleScene::occluded(std::span<const Ray> rays, bool is_coherent) const {
  if (rays.empty()) return 0;
  RTCIntersectContext c = context(is_coherent);
  alignas(64) std::array<int, k_packet> valid;
  RTCRay16 r;
  fill(rays, r, valid.data());
  rtcOccluded16(valid.data(), state_->scene, &c, &r);
  uint32_t found = 0;
  for (size_t i = 0; i < rays.size(); ++i) found |= uint32_t(r.tfar[i] < 0) << i;
  return found;
}

size_t TriangleScene::bytes() const { return static_cast<size_t>(state_->bytes.load()); }

} // namespace kelpie
