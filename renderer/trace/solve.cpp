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
  case Cell::Content::blobs: ++counters.blobs.cells; return solve_blobs(shape, cell, ray, counters.blobs, t);
  case Cell::Content::tree: ++counters.trees.cells; return solve_tree(shape, cell, ray, counters.trees, t);
  case Cell::Content::moving_tree: ++counters.trees.cells; return solve_moving_tree(shape, cell, ray, counters.trees, t);
  case Cell::Content::code: ++counters.code.cells; return solve_code(shape, cell, ray, counters.code, t);
  }
  __builtin_unreachable();
}

uint32_t solve_lanes(const ShapeCells& shape, const Cell& cell, const RayLanes& rays, SolveCounters& counters, float* t) {
  switch (cell.content) {
  case Cell::Content::blobs: return solve_blobs_lanes(shape, cell, rays, counters, t);
  case Cell::Content::tree: return solve_tree_lanes(shape, cell, rays, counters, t);
  case Cell::Content::moving_tree:
  case Cell::Content::code: return solve_one_by_one(shape, cell, rays, counters, t);
  }
  __builtin_unreachable();
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
  case Cell::Content::blobs: return blobs_gradient(shape, cell, p, time);
  case Cell::Content::tree: return tree_gradient(shape, cell, p);
  case Cell::Content::moving_tree:
  case Cell::Content::code: {
    const CodeView& code = shape.code(cell);
    return Vec3(gradient(at(shape.program, code, shape.slab_time(time)), code, Vec3d(p)));
  }
  }
  __builtin_unreachable();
}

namespace {

/// The matrix of an ellipsoid at a time of the slab, and how it changes.
std::pair<Mat3d, Mat3d> shape_of(const BlobList& blobs, size_t i, double u) {
  const BlobForm& form = blobs.form;
  std::array<double, k_shape_rows> now{}, rate{};
  for (uint32_t r = 0; r < k_shape_rows; ++r) {
    const auto row = static_cast<BlobShapeRow>(r);
    rate[r] = form.moves && !form.is_pure ? double(blobs.row(form.change_of(row))[i]) : 0;
    now[r] = double(blobs.row(form.row_of(row))[i]) + u * rate[r];
  }
  const auto matrix = [](const std::array<double, k_shape_rows>& m) {
    return Mat3d{{m[shape_xx], m[shape_xy], m[shape_xz]}, {m[shape_xy], m[shape_yy], m[shape_yz]}, {m[shape_xz], m[shape_yz], m[shape_zz]}};
  };
  return {matrix(now), matrix(rate)};
}

/// The derivative of a sum of blobs by the slab's time, from the formulas of blob_list.h.
double blobs_rate(const BlobList& blobs, const Vec3d& p, double u) {
  if (!blobs.form.moves) return 0;
  double sum = 0;
  for (size_t i = 0; i < blobs.count && !blobs.is_padding(i); ++i) {
    const auto start = [&](BlobRow row) { return double(blobs.row(row)[i]); };
    const auto change = [&](BlobRow row) { return double(blobs.row(blobs.form.change_of(row))[i]); };
    const Vec3d way(change(blob_x), change(blob_y), change(blob_z));
    const Vec3d d = p - (Vec3d(start(blob_x), start(blob_y), start(blob_z)) + u * way);
    double q = start(blob_s), q_rate = 0;
    if (blobs.form.is_round) {
      const double k_rate = blobs.form.is_pure ? 0 : change(blob_k), k = start(blob_k) + u * k_rate;
      q -= k * glm::dot(d, d), q_rate = 2 * k * glm::dot(d, way) - k_rate * glm::dot(d, d);
    } else {
      const auto [m, m_rate] = shape_of(blobs, i, u);
      const Vec3d in_ball = m * d;
      q -= glm::dot(in_ball, in_ball), q_rate = 2 * glm::dot(in_ball, m * way - m_rate * d);
    }
    if (q <= 0) continue;
    if (blobs.form.is_pure) {
      sum += 2 * q * q_rate;
    } else {
      const double a = start(blob_a) + u * change(blob_a), b = start(blob_b) + u * change(blob_b);
      sum += q * (2 * q_rate * (a + b * q) + q * (change(blob_a) + change(blob_b) * q + b * q_rate));
    }
  }
  return sum;
}

/// By differences over a part of the slab.
double code_rate(const ShapeCells& shape, const Cell& cell, const Vec3d& p, double u) {
  constexpr double k_step = 1.0 / 16;
  const CodeView& code = shape.code(cell);
  const double before = std::max(u - k_step, 0.0), after = std::min(u + k_step, 1.0);
  const auto value = [&](double when) { return evaluate(at(shape.program, code, when), code, Point3<double>{p.x, p.y, p.z}); };
  return (value(after) - value(before)) / (after - before);
}

} // namespace

double cell_rate(const ShapeCells& shape, const Cell& cell, const Vec3& p, float time) {
  if (!shape.program.motion) return 0;
  const double u = shape.slab_time(time), threshold_rate = shape.program.motion->end.threshold - shape.program.threshold;
  switch (cell.content) {
  case Cell::Content::blobs: return blobs_rate(cell.blobs, Vec3d(p), u) - threshold_rate;
  case Cell::Content::tree: return -threshold_rate;
  case Cell::Content::moving_tree:
  case Cell::Content::code: return code_rate(shape, cell, Vec3d(p), u) - threshold_rate;
  }
  __builtin_unreachable();
}

} // namespace kelpie
