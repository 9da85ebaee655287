#include "renderer/trace/solve.h"

namespace kelpie {

Ray RayLanes::ray(size_t i) const {
  Ray r;
  r.origin = {origin_x[i], origin_y[i], origin_z[i]}, r.direction = {direction_x[i], direction_y[i], direction_z[i]};
  r.t_near = t_near[i], r.t_far = t_far[i];
  return r;
}

bool clip(const Cell& cell, const Ray& ray, bool from_inside, RaySegment& out) {
  const Vec3 inverse = 1.f / ray.direction;
  const Vec3 a = (cell.box.lower - ray.origin) * inverse, b = (cell.box.upper - ray.origin) * inverse;
  float t0 = ray.t_near, t1 = std::numeric_limits<float>::infinity();
  for (int i = 0; i < 3; ++i) { // written so that NaN (0 * inf: the ray runs in the wall) leaves the bounds as they are
    const float near = a[i] < b[i] ? a[i] : b[i], far = a[i] < b[i] ? b[i] : a[i];
    t0 = near > t0 ? near : t0;
    t1 = far < t1 ? far : t1;
  }
  if (!(t0 <= t1)) return false;
  const float pad = 1e-6f * (1 + std::abs(t1));
  out = {ray.origin, ray.direction, std::max(t0 - pad, ray.t_near), t1 + pad, t0, from_inside};
  return true;
}

bool solve(const ShapeCells& shape, const Cell& cell, const RaySegment& ray, SolveCounters& counters, float& t) {
  switch (cell.content) {
  case Cell::Content::tree: ++counters.trees.cells; return solve_tree(shape, cell, ray, counters.trees, t);
  case Cell::Content::code: ++counters.code.cells; return solve_code(shape, cell, ray, counters.code, t);
  default: ++counters.blobs.cells; return solve_blobs(shape, cell, ray, counters.blobs, t);
  }
}

uint32_t solve_lanes(const ShapeCells& shape, const Cell& cell, const RayLanes& rays, SolveCounters& counters, float* t) {
  switch (cell.content) {
  case Cell::Content::tree: return solve_tree_lanes(shape, cell, rays, counters, t);
  case Cell::Content::code: return solve_one_by_one(shape, cell, rays, counters, t);
  default: return solve_blobs_lanes(shape, cell, rays, counters, t);
  }
}

uint32_t solve_one_by_one(const ShapeCells& shape, const Cell& cell, const RayLanes& rays, SolveCounters& counters, float* t) {
  uint32_t hits = 0;
  for (size_t i = 0; i < rays.count; ++i) {
    RaySegment segment;
    if (!rays.valid[i] || !clip(cell, rays.ray(i), false, segment) || segment.entry > rays.t_far[i]) continue;
    if (!solve(shape, cell, segment, counters, t[i])) continue;
    t[i] = std::max(t[i], segment.entry);
    hits |= 1u << i;
  }
  return hits;
}

Vec3 cell_gradient(const ShapeCells& shape, const Cell& cell, const Vec3& p) {
  switch (cell.content) {
  case Cell::Content::tree: return tree_gradient(shape, cell, p);
  case Cell::Content::code: return Vec3(gradient(shape.program, shape.code(cell), Vec3d(p)));
  default: return blobs_gradient(shape, cell, p);
  }
}

} // namespace kelpie
