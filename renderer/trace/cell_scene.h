// The cells of all shapes as Embree user geometry: one geometry a shape, one primitive a cell. Only this folder knows
// Embree.
#pragma once

#include <memory>

#include "renderer/trace/solve.h"

namespace kelpie {

struct CellHit {
  float t = 0;
  uint32_t shape = 0; ///< index into the shapes that the scene was made of
  uint32_t cell = 0;  ///< of the shape's slab at the ray's time
};

class CellScene {
public:
  /// Takes the shapes' cells: for each shape its slabs of time, a power of two of them. Throws std::bad_alloc when
  /// Embree runs out of memory.
  explicit CellScene(std::vector<Slabs> shapes);
  ~CellScene();
  CellScene(CellScene&&) noexcept;
  CellScene& operator=(CellScene&&) noexcept;

  /// The first surface that the ray meets.
  bool intersect(const Ray&, SolveCounters&, CellHit&) const;
  /// Whether it meets any.
  bool occluded(const Ray&, SolveCounters&) const;

  /// The same for a packet of up to k_packet rays, best of rays that run side by side: returns the rays (bits)
  /// that hit. A ray's answer does not depend on the others; it may differ from the answer alone by rounding.
  uint32_t intersect(std::span<const Ray>, SolveCounters&, CellHit*) const;
  uint32_t occluded(std::span<const Ray>, SolveCounters&) const;

  /// The slabs of each shape.
  const std::vector<Slabs>& shapes() const;
  /// The cells of a shape at a ray's time.
  const ShapeCells& shape(size_t index, float time) const;
  /// The most slabs that any shape has.
  size_t slab_count() const;
  /// Into so many equal parts time is divided, each with a scene of its own. Rays that share a packet had better share one.
  size_t window_count() const;
  /// Bytes of Embree's own structures and of the cells.
  size_t bytes() const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Whether Embree takes the ray, which else ends the program: its numbers are some, and not beyond 1e18. Other rays meet
/// nothing.
inline bool is_traceable(const Ray& ray) {
  const Vec3 sum = glm::abs(ray.origin) + glm::abs(ray.direction);
  return sum.x + sum.y + sum.z <= 1e18f;
}

/// Embree wants denormals flushed in every thread that calls it; the solvers are faster so, too.
void flush_denormals_in_this_thread();

} // namespace kelpie
