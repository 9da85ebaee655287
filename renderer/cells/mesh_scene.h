// Triangle meshes as Embree triangles, with smooth normals.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "renderer/trace/solve.h"
#include "scene/geometry.h"

namespace kelpie {

/// What a triangle takes in Embree and beside it, about.
inline constexpr size_t k_tree_bytes_per_triangle = 120;

struct MeshHit {
  float t = 0;
  uint32_t shape = 0; ///< as it was added
  Vec3 position{0};
  Vec3 normal{0};          ///< unit, smooth, on the triangle's outer side; it faces the ray where the triangle does
  bool is_leaving = false; ///< the triangle is seen from behind
  Vec3 lift{0};            ///< see Hit
  float epsilon = 0;       ///< of secondary rays, but for what rounding asks for
};

/// Rays are traced one by one: an answer then depends on nothing but the ray. (In packets Embree may go through other
/// triangles first, and take the other one where two meet.)
class MeshScene {
public:
  /// Takes meshes and the shapes that they are. Throws std::bad_alloc when Embree runs out of memory.
  explicit MeshScene(std::span<const std::pair<uint32_t, TriangleMesh<SampledMode>>>);
  ~MeshScene();

  bool is_empty() const { return meshes_.empty(); }
  /// The first triangle that the ray meets, from either side.
  bool intersect(const Ray&, MeshHit&) const;
  bool occluded(const Ray&) const;
  /// Whether it is made of these meshes in these places.
  bool is_of(std::span<const std::pair<uint32_t, TriangleMesh<SampledMode>>>) const;
  /// Bytes of Embree's own structures and of the meshes in the world.
  size_t bytes() const;

private:
  struct Placed;
  void add(uint32_t shape, const TriangleMesh<SampledMode>&);
  struct State;
  std::unique_ptr<State> state_; ///< null while there is no mesh
  std::vector<Placed> meshes_;   ///< by Embree's geometry
};

} // namespace kelpie
