// Triangle meshes as Embree triangles, with smooth normals.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "renderer/trace/solve.h"
#include "scene/geometry.h"

namespace kelpie {

/// A mesh and the shape that it is; its places at equal steps of the open shutter, one where it stands.
struct MovingMesh {
  uint32_t shape;
  std::vector<TriangleMesh<SampledMode>> states;
};

/// What meshes take in Embree and beside it, about, in bytes.
size_t estimated_bytes(const MovingMesh&);

struct MeshHit {
  float t = 0;
  uint32_t shape = 0; ///< as it was added
  Vec3 position{0};
  Vec3 normal{0};          ///< unit, smooth, on the triangle's outer side; it faces the ray where the triangle does
  bool is_leaving = false; ///< the triangle is seen from behind
  Vec3 lift{0};            ///< see Hit
  float epsilon = 0;       ///< of secondary rays, but for what rounding asks for
};

/// What moves goes straight from step to step, of as many as it takes to follow the states.
/// Rays are traced one by one: an answer then depends on nothing but the ray. (In packets Embree may go through other
/// triangles first, and take the other one where two meet.)
class MeshScene {
public:
  /// Throws std::bad_alloc when Embree runs out of memory.
  explicit MeshScene(std::span<const MovingMesh>);
  ~MeshScene();

  bool is_empty() const { return meshes_.empty(); }
  /// The first triangle that the ray meets, from either side.
  bool intersect(const Ray&, MeshHit&) const;
  bool occluded(const Ray&) const;
  /// Whether it is made of these meshes in these places.
  bool is_of(std::span<const MovingMesh>) const;
  /// How far a point of a shape moves at a time, per exposure; nothing of what is no mesh.
  std::optional<Vec3> velocity(uint32_t shape, const Vec3& position, float time) const;
  /// Bytes of Embree's own structures.
  size_t bytes() const;

private:
  struct Placed;
  void add(const MovingMesh&);
  struct State;
  std::unique_ptr<State> state_; ///< null while there is no mesh
  std::vector<Placed> meshes_;   ///< by Embree's geometry
};

} // namespace kelpie
