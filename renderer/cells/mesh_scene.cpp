#include "renderer/cells/mesh_scene.h"

#include <atomic>
#include <cstring>
#include <new>
#include <stdexcept>

#include <embree3/rtcore.h>

#include "renderer/cells/cell_scene.h"

namespace kelpie {

/// A mesh in the world.
struct MeshScene::Placed {
  uint32_t shape;
  TriangleMesh<SampledMode> kind;
  std::shared_ptr<const SurfaceMesh> mesh;
  std::vector<Vec3> positions;
  Mat3 world_from_normal; ///< the lengths of normals are not kept
  float epsilon;
};

struct MeshScene::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::atomic<ssize_t> embree_bytes{0};
  std::atomic<RTCError> error{RTC_ERROR_NONE};

  State() {
    flush_denormals_in_this_thread();
    device = rtcNewDevice(nullptr);
    if (!device) throw std::runtime_error("Embree: no device");
    const auto on_error = [](void* state, RTCError code, const char*) { static_cast<State*>(state)->error = code; };
    rtcSetDeviceErrorFunction(device, on_error, this);
    const auto on_memory = [](void* state, ssize_t bytes, bool) {
      static_cast<State*>(state)->embree_bytes += bytes;
      return true;
    };
    rtcSetDeviceMemoryMonitorFunction(device, on_memory, this);
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST); // watertight where triangles share vertices
  }
  ~State() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

MeshScene::~MeshScene() = default;

namespace {

/// The offset of secondary rays, as a part of the mesh's size.
constexpr double k_epsilon = 1e-6;
/// A smooth normal that looks away from the ray that sees its triangle is turned until it has this cosine.
constexpr float k_least_cosine = 0.01f;

RTCRay to_embree(const Ray& ray) {
  RTCRay r{};
  r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z;
  r.tnear = ray.t_near, r.tfar = ray.t_far;
  r.mask = ~0u;
  return r;
}

} // namespace

void MeshScene::add(uint32_t shape, const TriangleMesh<SampledMode>& kind) {
  const SurfaceMesh& mesh = *kind.mesh;
  const Affine world_from_file = kind.world_from_file();
  Placed placed{shape, kind, kind.mesh, {}, Mat3(glm::transpose(glm::inverse(world_from_file.linear))), 0};
  Box3 box;
  placed.positions.reserve(mesh.positions.size());
  for (const Vec3d& p : mesh.positions) box.extend(placed.positions.emplace_back(world_from_file(mesh.origin + p)));
  placed.epsilon = static_cast<float>(k_epsilon * box.diagonal());

  RTCGeometry geometry = rtcNewGeometry(state_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree's own buffers: it reads past the end of what others lend it.
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), placed.positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle), mesh.triangles.size());
  if (!vertices || !indices) throw std::bad_alloc();
  std::memcpy(vertices, placed.positions.data(), placed.positions.size() * sizeof(Vec3));
  std::memcpy(indices, mesh.triangles.data(), mesh.triangles.size() * sizeof(Triangle));
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(state_->scene, geometry, static_cast<unsigned>(meshes_.size()));
  rtcReleaseGeometry(geometry);
  meshes_.push_back(std::move(placed));
}

MeshScene::MeshScene(std::span<const std::pair<uint32_t, TriangleMesh<SampledMode>>> meshes) {
  if (meshes.empty()) return;
  state_ = std::make_unique<State>();
  for (const auto& [shape, mesh] : meshes) add(shape, mesh);
  rtcCommitScene(state_->scene);
  if (state_->error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (state_->error != RTC_ERROR_NONE) throw std::runtime_error("Embree: error " + std::to_string(state_->error));
}

bool MeshScene::intersect(const Ray& ray, MeshHit& hit) const {
  if (is_empty() || !is_traceable(ray)) return false;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit found;
  found.ray = to_embree(ray);
  found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->scene, &context, &found);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;

  const Placed& placed = meshes_[found.hit.geomID];
  const Triangle& triangle = placed.mesh->triangles[found.hit.primID];
  const std::array<Vec3, 3>& normals = placed.mesh->normals[found.hit.primID];
  const std::array<float, 3> weights{1 - found.hit.u - found.hit.v, found.hit.u, found.hit.v};
  std::array<Vec3, 3> corners, corner_normals;
  Vec3 position(0), smooth(0);
  for (size_t i = 0; i < 3; ++i) {
    corners[i] = placed.positions[triangle[i]];
    corner_normals[i] = glm::normalize(placed.world_from_normal * normals[i]);
    position += weights[i] * corners[i], smooth += weights[i] * corner_normals[i];
  }
  const Vec3d edge(corners[1] - corners[0]), other_edge(corners[2] - corners[0]); // in double: areas of tiny triangles are tiny squared
  const Vec3 flat(glm::normalize(glm::cross(edge, other_edge)));
  const float side = glm::dot(flat, ray.direction) > 0 ? -1.f : 1.f; // 1: the ray comes from outside

  // Hanika, "Hacking the shadow terminator" (Ray Tracing Gems II, 2021): up to the planes that touch the smooth
  // surface at the corners, on the side of the ray.
  Vec3 lift(0);
  for (size_t i = 0; i < 3; ++i)
    lift -= weights[i] * std::min(0.f, side * glm::dot(position - corners[i], corner_normals[i])) * side * corner_normals[i];

  Vec3 normal = glm::dot(smooth, flat) > 0 ? side * glm::normalize(smooth) : side * flat;
  const float cosine = -glm::dot(normal, ray.direction);
  if (cosine < k_least_cosine) normal = glm::normalize(normal - (k_least_cosine - cosine) * ray.direction);
  hit = {found.ray.tfar, placed.shape, position, side * normal, side < 0, lift, placed.epsilon};
  return true;
}

bool MeshScene::occluded(const Ray& ray) const {
  if (is_empty() || !is_traceable(ray)) return false;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay r = to_embree(ray);
  rtcOccluded1(state_->scene, &context, &r);
  return r.tfar < 0;
}

bool MeshScene::is_of(std::span<const std::pair<uint32_t, TriangleMesh<SampledMode>>> meshes) const {
  return std::equal(meshes.begin(), meshes.end(), meshes_.begin(), meshes_.end(),
                    [](const auto& a, const Placed& b) { return a.first == b.shape && is_equal(a.second, b.kind); });
}

size_t MeshScene::bytes() const {
  size_t n = state_ ? static_cast<size_t>(state_->embree_bytes.load()) : 0;
  for (const Placed& p : meshes_) n += p.positions.size() * sizeof(Vec3);
  return n;
}

} // namespace kelpie
