#include "renderer/trace/tracer.h"

#include <algorithm>
#include <array>

namespace kelpie {

namespace {

/// Adds to the counters what work this thread has with axes while this lives.
class CountAxisWork {
public:
  explicit CountAxisWork(SolveCounters& counters) : counters_(counters), before_(axis_work()) {}
  ~CountAxisWork() { counters_.axis += axis_work() - before_; }
  CountAxisWork(const CountAxisWork&) = delete;

private:
  SolveCounters& counters_;
  AxisWork before_;
};

/// The gradient at a point of the surface. Exactly on a flat face of a solid there is none, neither that of the outside nor that of the
/// inside: then it is that of a point next to it, along `aside`.
Vec3 surface_gradient(const ShapeCells& shape, const Cell& cell, const Vec3& p, const Vec3& aside, float time) {
  const Vec3 g = cell_gradient(shape, cell, p, time);
  return g != Vec3(0) ? g : cell_gradient(shape, cell, p + cell.epsilon * aside, time);
}

} // namespace

Tracer::Tracer(const FrameScene& frame, const CellLimits& limits, KeptScenes* kept)
    : exposure_(frame.exposure().length), media_(frame.shapes), planes_(frame) {
  KeptScenes nothing;
  meshes_ = build_mesh_scene(frame, limits, kept ? *kept : nothing);
  cells_ = build_cell_scene(frame, limits, kept ? *kept : nothing, kept_cells_);
  for (const Slabs& slabs : cells_->shapes())
    for (const std::shared_ptr<const ShapeCells>& s : slabs)
      for (const Cell& cell : s->cells) bounds_.extend(cell.box);
}

bool Tracer::intersect(const Ray& ray, SolveCounters& counters, Hit& hit) const {
  const CountAxisWork count(counters);
  hit.t = ray.t_far;
  const bool on_geometry = meet_geometry(ray, hit);
  Ray shortened = ray;
  shortened.t_far = hit.t;
  CellHit cell_hit;
  if (!cells_->intersect(shortened, counters, cell_hit)) return on_geometry;
  complete(ray, cell_hit, hit);
  return true;
}

bool Tracer::pass_hidden(Ray& ray, SolveCounters& counters, Hit& hit) const {
  constexpr int k_most = 100; // whatever runs in a surface and crosses it for ever has then arrived
  for (int i = 0; i < k_most && !media_.is_seen(hit.shape, ray.inside); ++i) {
    const float rest = ray.t_far - hit.t;
    ray = depart(ray, hit, ray.direction, Side::far);
    ray.t_far = rest;
    if (!intersect(ray, counters, hit)) return false;
  }
  return true;
}

bool Tracer::occluded(const Ray& ray, SolveCounters& counters) const {
  const CountAxisWork count(counters);
  Hit hit;
  if (media_.hides()) {
    Ray onward = ray;
    return intersect(onward, counters, hit) && pass_hidden(onward, counters, hit);
  }
  hit.t = ray.t_far;
  return planes_.meet(ray, hit) || meshes_->occluded(ray) || cells_->occluded(ray, counters);
}

uint32_t Tracer::intersect(std::span<const Ray> rays, SolveCounters& counters, Hit* hits) const {
  const CountAxisWork count(counters);
  std::array<Ray, k_packet> shortened;
  std::array<CellHit, k_packet> cell_hits;
  uint32_t found = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    hits[i].t = rays[i].t_far;
    found |= uint32_t(meet_geometry(rays[i], hits[i])) << i;
    shortened[i] = rays[i];
    shortened[i].t_far = hits[i].t;
  }
  const uint32_t in_cells = cells_->intersect(std::span(shortened).first(rays.size()), counters, cell_hits.data());
  for (size_t i = 0; i < rays.size(); ++i)
    if (in_cells >> i & 1) complete(rays[i], cell_hits[i], hits[i]);
  return found | in_cells;
}

uint32_t Tracer::occluded(std::span<const Ray> rays, SolveCounters& counters) const {
  const CountAxisWork count(counters);
  uint32_t found = 0;
  if (media_.hides()) { // what can be seen depends on the way
    for (size_t i = 0; i < rays.size(); ++i) found |= uint32_t(occluded(rays[i], counters)) << i;
    return found;
  }
  for (size_t i = 0; i < rays.size(); ++i) {
    Hit hit;
    hit.t = rays[i].t_far;
    found |= uint32_t(planes_.meet(rays[i], hit) || meshes_->occluded(rays[i])) << i;
  }
  return found | cells_->occluded(rays, counters);
}

/// What is not a field; one by one, as Embree's answers about triangles may differ with the rays of a packet.
bool Tracer::meet_geometry(const Ray& ray, Hit& hit) const {
  const bool on_plane = planes_.meet(ray, hit);
  if (meshes_->is_empty()) return on_plane;
  Ray shortened = ray;
  shortened.t_far = hit.t;
  MeshHit on_mesh;
  if (!meshes_->intersect(shortened, on_mesh)) return on_plane;
  hit.t = on_mesh.t, hit.shape = on_mesh.shape, hit.position = on_mesh.position, hit.normal = on_mesh.normal;
  hit.slab = nullptr, hit.time = ray.time;
  hit.is_leaving = on_mesh.is_leaving, hit.lift = on_mesh.lift;
  hit.epsilon = on_mesh.epsilon + rounding_at(hit.position, hit.t);
  return true;
}

void Tracer::complete(const Ray& ray, const CellHit& cell_hit, Hit& hit) const {
  const ShapeCells& shape = cells_->shape(cell_hit.shape, ray.time);
  const Cell& cell = shape.cells[cell_hit.cell];
  hit.t = cell_hit.t;
  hit.shape = cell_hit.shape, hit.cell = cell_hit.cell, hit.slab = &shape, hit.time = ray.time;
  hit.is_leaving = ray.inside.contains(hit.shape);
  hit.lift = Vec3(0);
  hit.position = ray.origin + hit.t * ray.direction;
  const Vec3 g = surface_gradient(shape, cell, hit.position, -ray.direction, ray.time);
  const float length = glm::length(g);
  // A vanishing gradient (a crease's exact middle): facing the ray is the best there is.
  hit.normal = length > 0 ? -g / length : -ray.direction;
  hit.epsilon = cell.epsilon + rounding_at(hit.position, hit.t);
}

Vec3 Tracer::velocity(const Hit& hit) const {
  if (exposure_ == 0) return Vec3(0);
  const auto per_frame = static_cast<float>(1 / exposure_);
  if (const std::optional<Vec3> of_plane = planes_.velocity(hit)) return *of_plane * per_frame;
  if (const std::optional<Vec3> of_mesh = meshes_->velocity(hit.shape, hit.position, hit.time)) return *of_mesh * per_frame;
  const ShapeCells& shape = *hit.slab;
  const Cell& cell = shape.cells[hit.cell];
  const Vec3 g = surface_gradient(shape, cell, hit.position, hit.normal, hit.time);
  const double rate = cell_rate(shape, cell, hit.position, hit.time);
  // Where the gradient vanishes next to threshold / radius the surface has no velocity: it appears, or tears.
  const double least = 1e-3 * shape.program.threshold / (1e3 * cell.epsilon);
  return static_cast<float>(-rate * shape.slabs * per_frame / (double(glm::dot(g, g)) + square(least))) * g;
}

Vec3 Tracer::normal_near(const Hit& hit, const Vec3& p) const {
  if (!hit.slab) return hit.normal;
  const Vec3 g = cell_gradient(*hit.slab, hit.slab->cells[hit.cell], p, hit.time);
  const float length = glm::length(g);
  return length > 0 ? -g / length : hit.normal;
}

void Tracer::leaves_at(const Hit& hit, std::vector<LeafAt>& out) const {
  const ShapeCells& shape = *hit.slab;
  const CodeView& code = *shape.cells[hit.cell].code;
  kelpie::leaves_at(at(shape.program, code, shape.slab_time(hit.time)), code, Vec3d(hit.position), out);
}

size_t Tracer::cell_count() const {
  size_t n = 0;
  for (const Slabs& slabs : cells_->shapes())
    for (const std::shared_ptr<const ShapeCells>& s : slabs) n += s->cells.size();
  return n;
}

size_t Tracer::element_count() const {
  size_t n = 0;
  for (const Slabs& slabs : cells_->shapes()) n += slabs[0]->program.element_count();
  return n;
}

} // namespace kelpie
