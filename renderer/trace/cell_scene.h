// The cells of all shapes as Embree user geometry: one geometry a shape, one primitive a cell.
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

  // Each of these throws what a solver throws (std::bad_alloc), after Embree is done.

  /// The first surface that the ray meets.
  bool intersect(const Ray&, SolveCounters&, CellHit&) const;
  /// Whether it meets any.
  bool occluded(const Ray&, SolveCounters&) const;

  /// The same for a packet of up to k_packet rays, which had better run side by side: returns the rays (bits)
  /// that hit. A ray's answer does not depend on the others; it may differ from the answer alone by rounding.
  uint32_t intersect(std::span<const Ray>, SolveCounters&, CellHit*) const;
  uint32_t occluded(std::span<const Ray>, SolveCounters&) const;

  /// The slabs of each shape.
  const std::vector<Slabs>& shapes() const;
  /// The cells of a shape at a ray's time.
  const ShapeCells& shape(size_t index, float time) const;
  /// The most slabs that any shape has.
  size_t slab_count() const;
  /// Time is divided into so many equal windows, each with a scene of its own. A packet whose rays are in several windows is traced
  /// once in each.
  size_t window_count() const;
  /// Bytes of Embree's own structures and of the cells.
  size_t bytes() const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Embree wants denormals flushed in every thread that calls it; the solvers are faster so, too.
void flush_denormals_in_this_thread();

} // namespace kelpie
