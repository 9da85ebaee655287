// A mesh as Embree's own triangles: what the tracer is compared with. Not part of the program.
#pragma once

#include <memory>
#include <span>

#include "bench/field_mesh.h"
#include "renderer/trace/solve.h"

namespace kelpie {

struct TriangleHit {
  float t = 0;
  Vec3 position{0}, normal{0}; ///< unit, as the triangle has it
};

class TriangleScene {
public:
  explicit TriangleScene(const FieldMesh& mesh);
  ~TriangleScene();

  bool intersect(const Ray&, TriangleHit&) const;
  bool occluded(const Ray&) const;
  /// Up to k_packet rays; returns those (bits) that hit. `is_coherent`: they run side by side.
  uint32_t intersect(std::span<const Ray>, bool is_coherent, TriangleHit*) const;
  uint32_t occluded(std::span<const Ray>, bool is_coherent) const;

  /// Of the mesh in Embree and its bounding volumes.
  size_t bytes() const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace kelpie
