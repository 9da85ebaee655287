#include "renderer/trace/solve.h"

namespace kelpie {

Ray RayLanes::ray(size_t i) const {
  Ray r;
  r.origin = {origin_x[i], origin_y[i], origin_z[i]}, r.direction = {direction_x[i], direction_y[i], direction_z[i]};
  r.t_near = t_near[i], r.t_far = t_far[i], r.time = time[i];
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
  out = {ray.origin, ray.direction, std::max(t0 - pad, ray.t_near), t1 + pad, t0, from_inside, ray.time};
  return true;
}

bool solve(const ShapeCells& shape, const Cell& cell, const RaySegment& ray, SolveCounters& counters, float& t) {
  switch (cell.content) {
  case Cell::Content::tree: ++counters.trees.cells; return solve_tree(shape, cell, ray, counters.trees, t);
  case Cell::Content::moving_tree: ++counters.trees.cells; return solve_moving_tree(shape, cell, ray, counters.trees, t);
  case Cell::Content::code: ++counters.code.cells; return solve_code(shape, cell, ray, counters.code, t);
  default: ++counters.blobs.cells; return solve_blobs(shape, cell, ray, counters.blobs, t);
  }
}

uint32_t solve_lanes(const ShapeCells& shape, const Cell& cell, const RayLanes& rays, SolveCounters& counters, float* t) {
  switch (cell.content) {
  case Cell::Content::tree: return solve_tree_lanes(shape, cell, rays, counters, t);
  case Cell::Content::moving_tree:
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

Vec3 cell_gradient(const ShapeCells& shape, const Cell& cell, const Vec3& p, float time) {
  switch (cell.content) {
  case Cell::Content::tree: return tree_gradient(shape, cell, p);
  case Cell::Content::moving_tree:
  case Cell::Content::code: {
    const CodeView code = shape.code(cell);
    return Vec3(gradient(at(shape.program, code, shape.slab_time(time)), code, Vec3d(p)));
  }
  default: return blobs_gradient(shape, cell, p, time);
  }
}

namespace {

/// The derivative of a sum of moving blobs by the slab's time, from the formulas of cells.h.
double blobs_rate(const float* data, size_t n, bool is_pure, const Vec3d& p, double u) {
  double sum = 0;
  for (size_t i = 0; i < n; ++i) {
    const auto start = [&](size_t array) { return double(data[array * n + i]); };
    const auto change = [&](size_t array) { return double(data[((is_pure ? 5 : 7) + array) * n + i]); };
    const Vec3d way(change(0), change(1), change(2)), d = p - (Vec3d(start(0), start(1), start(2)) + u * way);
    const double k_rate = is_pure ? 0 : change(3), k = start(4) + u * k_rate, q = start(3) - k * glm::dot(d, d);
    if (q <= 0) continue;
    const double q_rate = 2 * k * glm::dot(d, way) - k_rate * glm::dot(d, d);
    if (is_pure) {
      sum += 2 * q * q_rate;
    } else {
      const double a = start(5) + u * change(4), b = start(6) + u * change(5);
      sum += q * (2 * q_rate * (a + b * q) + q * (change(4) + change(5) * q + b * q_rate));
    }
  }
  return sum;
}

/// By differences over a part of the slab.
double code_rate(const ShapeCells& shape, const Cell& cell, const Vec3d& p, double u) {
  constexpr double k_step = 1.0 / 16;
  const CodeView code = shape.code(cell);
  const double before = std::max(u - k_step, 0.0), after = std::min(u + k_step, 1.0);
  const auto value = [&](double when) { return evaluate(at(shape.program, code, when), code, Point3<double>{p.x, p.y, p.z}); };
  return (value(after) - value(before)) / (after - before);
}

} // namespace

double cell_rate(const ShapeCells& shape, const Cell& cell, const Vec3& p, float time) {
  if (!shape.program.motion) return 0;
  const double u = shape.slab_time(time), threshold_rate = shape.program.motion->end.threshold - shape.program.threshold;
  switch (cell.content) {
  case Cell::Content::moving_pure_blobs:
  case Cell::Content::moving_mixed_blobs:
    return blobs_rate(cell.data, cell.count, cell.content == Cell::Content::moving_pure_blobs, Vec3d(p), u) - threshold_rate;
  case Cell::Content::moving_tree:
  case Cell::Content::code: return code_rate(shape, cell, Vec3d(p), u) - threshold_rate;
  default: return -threshold_rate;
  }
}

} // namespace kelpie
