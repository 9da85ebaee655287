#include "renderer/trace/mesh_scene.h"

#include <cstring>
#include <new>

#include "renderer/trace/embree_device.h"

namespace kelpie {

/// A mesh in the world.
struct MeshScene::Placed {
  MovingMesh of;
  std::vector<Affine> world_from_file; ///< at equal steps of the time; one where it stands
  float epsilon = 0;

  const SurfaceMesh& mesh() const { return *of.states[0].mesh; }

  /// Vertices go straight from step to step.
  struct Moment {
    size_t step;
    double part;
  };
  Moment moment(float time) const {
    const double place = double(time) * double(world_from_file.size() - 1);
    const size_t step = std::min(static_cast<size_t>(place), world_from_file.size() - 2);
    return {step, place - double(step)};
  }
  Affine at(float time) const {
    if (world_from_file.size() == 1) return world_from_file[0];
    const auto [step, part] = moment(time);
    return between(world_from_file[step], world_from_file[step + 1], part);
  }
  static Affine between(const Affine& a, const Affine& b, double part) {
    return {a.linear + (b.linear - a.linear) * part, a.offset + (b.offset - a.offset) * part};
  }
};

struct MeshScene::State {
  EmbreeDevice device;
  RTCScene scene = device.new_scene();

  ~State() { rtcReleaseScene(scene); }
};

MeshScene::~MeshScene() = default;

namespace {

/// The offset of secondary rays, as a part of the mesh's size.
constexpr double k_epsilon = 1e-6;
/// How far a moving mesh may be from where it should be, as a part of its size.
constexpr double k_most_error = 2e-4;
constexpr size_t k_bytes_per_triangle = 120;
/// A smooth normal that looks away from the ray that sees its triangle is turned until it has this cosine.
constexpr float k_least_cosine = 0.01f;

std::array<Vec3d, 8> corners_of(const SurfaceMesh& mesh) {
  Box3d box;
  for (const Vec3d& p : mesh.positions) box.extend(mesh.origin + p);
  std::array<Vec3d, 8> corners;
  for (size_t i = 0; i < 8; ++i)
    corners[i] = {i & 1 ? box.lower.x : box.upper.x, i & 2 ? box.lower.y : box.upper.y, i & 4 ? box.lower.z : box.upper.z};
  return corners;
}

/// Of the maps at the states, as few steps as follow them. (Affine maps differ the most at a corner of a box.)
std::vector<Affine> needed_steps(const std::vector<Affine>& all, const std::array<Vec3d, 8>& corners, double size) {
  const size_t intervals = all.size() - 1;
  for (size_t stride = intervals; stride > 1; stride /= 2) {
    if (intervals % stride != 0) continue;
    double error = 0;
    std::vector<Affine> steps;
    for (size_t i = 0; i <= intervals; ++i) {
      const size_t first = std::min(i / stride, intervals / stride - 1) * stride;
      if (i % stride == 0) steps.push_back(all[i]);
      for (const Vec3d& p : corners) {
        const Vec3d straight = all[first](p) + (all[first + stride](p) - all[first](p)) * (double(i - first) / double(stride));
        error = std::max(error, glm::distance(all[i](p), straight));
      }
    }
    if (error <= k_most_error * size) return steps;
  }
  return all;
}

} // namespace

void MeshScene::add(const MovingMesh& of) {
  Placed placed{of, {}, 0};
  const SurfaceMesh& mesh = placed.mesh();
  const std::array<Vec3d, 8> corners = corners_of(mesh);
  for (const TriangleMesh<SampledMode>& state : of.states) placed.world_from_file.push_back(state.world_from_file());
  Box3d box;
  for (const Vec3d& p : corners) box.extend(placed.world_from_file[0](p));
  placed.world_from_file = needed_steps(placed.world_from_file, corners, box.diagonal());

  RTCGeometry geometry = rtcNewGeometry(state_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(placed.world_from_file.size()));
  for (size_t step = 0; step < placed.world_from_file.size(); ++step) {
    // Embree's own buffers: it reads past the end of what others lend it.
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(step), RTC_FORMAT_FLOAT3, sizeof(Vec3),
                                             mesh.positions.size());
    if (!vertices) throw std::bad_alloc();
    Box3 extent;
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      const Vec3 p(placed.world_from_file[step](mesh.origin + mesh.positions[i]));
      extent.extend(p);
      static_cast<Vec3*>(vertices)[i] = p;
    }
    placed.epsilon = std::max(placed.epsilon, static_cast<float>(k_epsilon * extent.diagonal()));
  }
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle), mesh.triangles.size());
  if (!indices) throw std::bad_alloc();
  std::memcpy(indices, mesh.triangles.data(), mesh.triangles.size() * sizeof(Triangle));
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(state_->scene, geometry, static_cast<unsigned>(meshes_.size()));
  rtcReleaseGeometry(geometry);
  meshes_.push_back(std::move(placed));
}

MeshScene::MeshScene(std::span<const MovingMesh> meshes) {
  if (meshes.empty()) return;
  state_ = std::make_unique<State>();
  for (const MovingMesh& mesh : meshes) add(mesh);
  rtcCommitScene(state_->scene);
  state_->device.check();
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
  const SurfaceMesh& mesh = placed.mesh();
  const Triangle& triangle = mesh.triangles[found.hit.primID];
  const std::array<Vec3, 3>& normals = mesh.normals[found.hit.primID];
  const Affine world_from_file = placed.at(ray.time);
  const Mat3 world_from_normal(glm::transpose(glm::inverse(world_from_file.linear))); // the lengths of normals are not kept
  const std::array<float, 3> weights{1 - found.hit.u - found.hit.v, found.hit.u, found.hit.v};
  std::array<Vec3, 3> corners, corner_normals;
  Vec3 position(0), smooth(0);
  for (size_t i = 0; i < 3; ++i) {
    corners[i] = Vec3(world_from_file(mesh.origin + mesh.positions[triangle[i]]));
    corner_normals[i] = glm::normalize(world_from_normal * normals[i]);
    position += weights[i] * corners[i], smooth += weights[i] * corner_normals[i];
  }
  const Vec3d edge(corners[1] - corners[0]), other_edge(corners[2] - corners[0]); // in double: areas of tiny triangles are tiny squared
  const double turned = glm::determinant(world_from_file.linear) < 0 ? -1 : 1;    // a mirror turns the triangles
  const Vec3 flat(turned * glm::normalize(glm::cross(edge, other_edge)));
  const float side = glm::dot(flat, ray.direction) > 0 ? -1.f : 1.f; // 1: the ray comes from outside

  // Hanika, "Hacking the shadow terminator" (Ray Tracing Gems II, 2021): up to the planes that touch the smooth
  // surface at the corners, on the side of the ray.
  Vec3 lift(0);
  for (size_t i = 0; i < 3; ++i)
    lift -= weights[i] * std::min(0.f, side * glm::dot(position - corners[i], corner_normals[i])) * side * corner_normals[i];

  Vec3 normal = glm::dot(smooth, flat) > 0 ? side * glm::normalize(smooth) : side * flat;
  const float cosine = -glm::dot(normal, ray.direction);
  if (cosine < k_least_cosine) normal = glm::normalize(normal - (k_least_cosine - cosine) * ray.direction);
  hit = {found.ray.tfar, placed.of.shape, position, side * normal, side < 0, lift, placed.epsilon};
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

bool MeshScene::is_of(std::span<const MovingMesh> meshes) const {
  const auto is_same = [](const MovingMesh& a, const Placed& b) {
    return a.shape == b.of.shape && std::equal(a.states.begin(), a.states.end(), b.of.states.begin(), b.of.states.end(),
                                               [](const auto& p, const auto& q) { return is_equal(p, q); });
  };
  return std::equal(meshes.begin(), meshes.end(), meshes_.begin(), meshes_.end(), is_same);
}

std::optional<Vec3> MeshScene::velocity(uint32_t shape, const Vec3& position, float time) const {
  for (const Placed& placed : meshes_) {
    if (placed.of.shape != shape) continue;
    if (placed.world_from_file.size() == 1) return Vec3(0);
    const size_t step = placed.moment(time).step;
    const Vec3d p = inverse(placed.at(time))(Vec3d(position)); // of the file
    return Vec3((placed.world_from_file[step + 1](p) - placed.world_from_file[step](p)) * double(placed.world_from_file.size() - 1));
  }
  return {};
}

size_t MeshScene::bytes() const { return state_ ? state_->device.bytes() : 0; }

size_t estimated_bytes(const MovingMesh& mesh) {
  const size_t triangles = mesh.states[0].mesh->triangles.size() * k_bytes_per_triangle;
  // What moves has boxes that move, and vertices at each step.
  return mesh.states.size() == 1 ? triangles : 2 * triangles + mesh.states.size() * mesh.states[0].mesh->positions.size() * sizeof(Vec3);
}

} // namespace kelpie
