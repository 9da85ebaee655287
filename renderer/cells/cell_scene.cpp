#include "renderer/cells/cell_scene.h"

#include <atomic>
#include <new>
#include <stdexcept>

#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

namespace kelpie {

void flush_denormals_in_this_thread() {
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}

struct CellScene::State {
  std::vector<ShapeCells> shapes;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::atomic<ssize_t> embree_bytes{0};
  std::atomic<RTCError> error{RTC_ERROR_NONE};

  ~State() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

namespace {

/// What a query passes to the callbacks behind Embree's own context.
struct Query {
  RTCIntersectContext embree; // first, so that Embree's pointer to it is a pointer to this
  const Ray* ray;
  SolveCounters* counters;
};

void cell_bounds(const RTCBoundsFunctionArguments* args) {
  const Box3& box = static_cast<const ShapeCells*>(args->geometryUserPtr)->cells[args->primID].box;
  RTCBounds& out = *args->bounds_o;
  out.lower_x = box.lower.x, out.lower_y = box.lower.y, out.lower_z = box.lower.z;
  out.upper_x = box.upper.x, out.upper_y = box.upper.y, out.upper_z = box.upper.z;
}

/// The part of the ray in the cell, padded so that no wall between two cells is a gap; false if there is none.
/// The pad is small enough that the cell's list of elements is still whole (the builder keeps the same margin).
bool clip(const Ray& ray, float t_far, const Box3& box, bool from_inside, RaySegment& out) {
  const Vec3 inverse = 1.f / ray.direction;
  const Vec3 a = (box.lower - ray.origin) * inverse, b = (box.upper - ray.origin) * inverse;
  float t0 = ray.t_near, t1 = t_far;
  for (int i = 0; i < 3; ++i) { // written so that NaN (0 * inf: the ray runs in the wall) leaves the bounds as they are
    const float near = a[i] < b[i] ? a[i] : b[i], far = a[i] < b[i] ? b[i] : a[i];
    t0 = near > t0 ? near : t0;
    t1 = far < t1 ? far : t1;
  }
  const float pad = 1e-6f * (1 + std::abs(t1));
  t0 = std::max(t0 - pad, ray.t_near), t1 = std::min(t1 + pad, t_far);
  if (!(t0 <= t1)) return false;
  out = {ray.origin, ray.direction, t0, t1, from_inside};
  return true;
}

/// Solves one cell; on a hit shortens the ray, so that farther cells are culled.
bool meet(const ShapeCells& shape, unsigned shape_index, unsigned cell_index, const Query& query, float t_far, float& t) {
  const Cell& cell = shape.cells[cell_index];
  RaySegment segment;
  const bool from_inside = query.ray->inside == static_cast<int>(shape_index);
  return clip(*query.ray, t_far, cell.box, from_inside, segment) && solve(shape, cell, segment, *query.counters, t) && t <= t_far;
}

void cell_intersect(const RTCIntersectFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const auto& shape = *static_cast<const ShapeCells*>(args->geometryUserPtr);
  const auto& query = *reinterpret_cast<const Query*>(args->context);
  auto* hit = reinterpret_cast<RTCRayHit*>(args->rayhit);
  float t;
  if (!meet(shape, args->geomID, args->primID, query, hit->ray.tfar, t)) return;
  hit->ray.tfar = t;
  hit->hit.geomID = args->geomID;
  hit->hit.primID = args->primID;
}

void cell_occluded(const RTCOccludedFunctionNArguments* args) {
  if (!args->valid[0]) return;
  const auto& shape = *static_cast<const ShapeCells*>(args->geometryUserPtr);
  const auto& query = *reinterpret_cast<const Query*>(args->context);
  auto* ray = reinterpret_cast<RTCRay*>(args->ray);
  float t;
  if (meet(shape, args->geomID, args->primID, query, ray->tfar, t)) ray->tfar = -std::numeric_limits<float>::infinity();
}

RTCRay to_embree(const Ray& ray) {
  RTCRay r{};
  r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z;
  r.tnear = ray.t_near, r.tfar = ray.t_far;
  r.mask = ~0u;
  return r;
}

void attach(RTCDevice device, RTCScene scene, ShapeCells& shape, unsigned index) {
  if (shape.cells.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(shape.cells.size()));
  rtcSetGeometryUserData(geometry, &shape);
  rtcSetGeometryBoundsFunction(geometry, cell_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, cell_intersect);
  rtcSetGeometryOccludedFunction(geometry, cell_occluded);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, index);
  rtcReleaseGeometry(geometry);
}

} // namespace

CellScene::CellScene(std::vector<ShapeCells> shapes) : state_(std::make_unique<State>()) {
  flush_denormals_in_this_thread();
  State& s = *state_;
  s.shapes = std::move(shapes);
  s.device = rtcNewDevice(nullptr);
  if (!s.device) throw std::runtime_error("Embree: no device");
  const auto on_error = [](void* state, RTCError code, const char*) { static_cast<State*>(state)->error = code; };
  rtcSetDeviceErrorFunction(s.device, on_error, &s);
  const auto on_memory = [](void* state, ssize_t bytes, bool) {
    static_cast<State*>(state)->embree_bytes += bytes;
    return true;
  };
  rtcSetDeviceMemoryMonitorFunction(s.device, on_memory, &s);
  s.scene = rtcNewScene(s.device);
  rtcSetSceneFlags(s.scene, RTC_SCENE_FLAG_ROBUST); // cells share walls: no ray may slip through
  for (unsigned i = 0; i < s.shapes.size(); ++i) attach(s.device, s.scene, s.shapes[i], i);
  rtcCommitScene(s.scene);
  if (s.error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (s.error != RTC_ERROR_NONE) throw std::runtime_error("Embree: error " + std::to_string(s.error));
}

CellScene::~CellScene() = default;
CellScene::CellScene(CellScene&&) noexcept = default;
CellScene& CellScene::operator=(CellScene&&) noexcept = default;

bool CellScene::intersect(const Ray& ray, SolveCounters& counters, CellHit& hit) const {
  Query query{{}, &ray, &counters};
  rtcInitIntersectContext(&query.embree);
  RTCRayHit r;
  r.ray = to_embree(ray);
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->scene, &query.embree, &r);
  if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit = {r.ray.tfar, r.hit.geomID, r.hit.primID};
  return true;
}

bool CellScene::occluded(const Ray& ray, SolveCounters& counters) const {
  Query query{{}, &ray, &counters};
  rtcInitIntersectContext(&query.embree);
  RTCRay r = to_embree(ray);
  rtcOccluded1(state_->scene, &query.embree, &r);
  return r.tfar < 0;
}

const std::vector<ShapeCells>& CellScene::shapes() const { return state_->shapes; }

size_t CellScene::bytes() const {
  size_t n = static_cast<size_t>(state_->embree_bytes.load());
  for (const ShapeCells& s : state_->shapes) n += s.bytes();
  return n;
}

} // namespace kelpie
