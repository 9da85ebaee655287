#include "renderer/trace/tracer.h"

#include <algorithm>
#include <array>

namespace kelpie {

namespace {

using SharedCells = std::shared_ptr<const ShapeCells>;

bool is_same_subdivision(const CellLimits& a, const CellLimits& b) {
  return a.elements == b.elements && a.sparse_side == b.sparse_side && a.side_in_radii == b.side_in_radii && a.depth == b.depth;
}

/// The cells of the last frame, for the shapes that have not changed since.
std::vector<SharedCells> unchanged_cells(const FrameScene& frame, const CellLimits& limits, const KeptScenes& kept) {
  std::vector<SharedCells> all(frame.shapes.size());
  if (!kept.cells || kept.cells->shapes().size() != all.size() || !is_same_subdivision(kept.limits, limits)) return all;
  for (size_t i = 0; i < all.size(); ++i) {
    const SharedCells& last = kept.cells->shapes()[i];
    const SampledShape& shape = frame.shapes[i];
    if (last->program.threshold == double(shape.threshold) && is_equal(last->program.field, shape.field)) all[i] = last;
  }
  return all;
}

std::shared_ptr<const CellScene> build_cell_scene(const FrameScene& frame, const CellLimits& limits, KeptScenes& kept, size_t& kept_cells) {
  std::vector<SharedCells> all = unchanged_cells(frame, limits, kept);
  const bool is_all_kept = std::all_of(all.begin(), all.end(), [](const SharedCells& c) { return c != nullptr; });
  if (!is_all_kept) kept.cells.reset(); // what has changed makes room first
  for (size_t i = 0; i < all.size(); ++i) {
    const SampledShape& shape = frame.shapes[i];
    if (all[i]) {
      kept_cells += all[i]->cells.size();
      if (limits.budget) limits.budget->take(all[i]->bytes() + all[i]->cells.size() * k_tree_bytes_per_cell);
    } else if (shape.field.nodes.empty()) { // geometry has no cells
      auto none = std::make_shared<ShapeCells>();
      none->program.threshold = shape.threshold;
      all[i] = std::move(none);
    } else {
      all[i] = std::make_shared<const ShapeCells>(build_cells(compile(shape.field, shape.threshold), limits));
    }
  }
  if (!is_all_kept || !kept.cells) kept.cells = std::make_shared<const CellScene>(std::move(all));
  kept.limits = limits, kept.limits.budget = nullptr;
  return kept.cells;
}

std::shared_ptr<const MeshScene> build_mesh_scene(const FrameScene& frame, const CellLimits& limits, KeptScenes& kept) {
  std::vector<std::pair<uint32_t, TriangleMesh<SampledMode>>> meshes;
  for (uint32_t i = 0; i < frame.shapes.size(); ++i)
    if (const auto& geometry = frame.shapes[i].geometry)
      if (const auto* mesh = std::get_if<TriangleMesh<SampledMode>>(&*geometry)) {
        meshes.emplace_back(i, *mesh);
        if (limits.budget) limits.budget->take(mesh->mesh->triangles.size() * k_tree_bytes_per_triangle);
      }
  if (!kept.meshes || !kept.meshes->is_of(meshes)) {
    kept.meshes.reset();
    kept.meshes = std::make_shared<const MeshScene>(meshes);
  }
  return kept.meshes;
}

/// Positions are rounded to float; an offset must not drown in that.
float rounding_at(const Vec3& p, float t) { return 5e-7f * (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) + t); }

} // namespace

Ray depart(const Ray& arrived, const Hit& hit, const Vec3& direction, Side side) {
  const Vec3 back = glm::dot(hit.normal, arrived.direction) > 0 ? -hit.normal : hit.normal;
  Ray ray;
  ray.origin = side == Side::near ? hit.position + hit.lift + hit.epsilon * back : hit.position - hit.epsilon * back;
  ray.direction = direction;
  ray.inside = arrived.inside;
  if (side == Side::near) return ray;
  if (hit.is_leaving)
    ray.inside.remove(hit.shape);
  else
    ray.inside.add(hit.shape);
  return ray;
}

Tracer::Tracer(const FrameScene& frame, const CellLimits& limits, KeptScenes* kept) {
  KeptScenes nothing;
  meshes_ = build_mesh_scene(frame, limits, kept ? *kept : nothing);
  cells_ = build_cell_scene(frame, limits, kept ? *kept : nothing, kept_cells_);
  for (uint32_t i = 0; i < frame.shapes.size(); ++i) {
    const SampledShape& shape = frame.shapes[i];
    if (!shape.geometry) continue;
    if (const auto* plane = std::get_if<Plane<SampledMode>>(&*shape.geometry))
      planes_.push_back({plane->position, glm::normalize(plane->normal), i});
  }
  for (const SharedCells& s : cells_->shapes())
    for (const Cell& cell : s->cells) bounds_.extend(cell.box);
}

bool Tracer::intersect(const Ray& ray, SolveCounters& counters, Hit& hit) const {
  hit.t = ray.t_far;
  const bool on_geometry = meet_geometry(ray, hit);
  Ray shortened = ray;
  shortened.t_far = hit.t;
  CellHit cell_hit;
  if (!cells_->intersect(shortened, counters, cell_hit)) return on_geometry;
  complete(ray, cell_hit, hit);
  return true;
}

bool Tracer::occluded(const Ray& ray, SolveCounters& counters) const {
  Hit hit;
  hit.t = ray.t_far;
  return meet_planes(ray, hit) || meshes_->occluded(ray) || cells_->occluded(ray, counters);
}

uint32_t Tracer::intersect(std::span<const Ray> rays, SolveCounters& counters, Hit* hits) const {
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
  uint32_t found = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    Hit hit;
    hit.t = rays[i].t_far;
    found |= uint32_t(meet_planes(rays[i], hit) || meshes_->occluded(rays[i])) << i;
  }
  return found | cells_->occluded(rays, counters);
}

/// What is not a field; one by one, as Embree's answers about triangles may differ with the rays of a packet.
bool Tracer::meet_geometry(const Ray& ray, Hit& hit) const {
  const bool on_plane = meet_planes(ray, hit);
  if (meshes_->is_empty()) return on_plane;
  Ray shortened = ray;
  shortened.t_far = hit.t;
  MeshHit on_mesh;
  if (!meshes_->intersect(shortened, on_mesh)) return on_plane;
  hit.t = on_mesh.t, hit.shape = on_mesh.shape, hit.position = on_mesh.position, hit.normal = on_mesh.normal;
  hit.is_leaving = on_mesh.is_leaving, hit.lift = on_mesh.lift;
  hit.epsilon = on_mesh.epsilon + rounding_at(hit.position, hit.t);
  return true;
}

bool Tracer::meet_planes(const Ray& ray, Hit& hit) const {
  bool found = false;
  for (const PlaneShape& plane : planes_) {
    const float across = glm::dot(ray.direction, plane.normal);
    const float t = glm::dot(plane.position - ray.origin, plane.normal) / across;
    if (!(t > ray.t_near && t < hit.t)) continue; // false for the NaN of a ray in the plane, too
    found = true;
    hit.t = t, hit.shape = plane.shape, hit.normal = plane.normal, hit.is_leaving = across > 0, hit.lift = Vec3(0);
    hit.position = ray.origin + t * ray.direction;
    hit.position -= glm::dot(hit.position - plane.position, plane.normal) * plane.normal;
    hit.epsilon = 1e-5f + rounding_at(hit.position, t);
  }
  return found;
}

void Tracer::complete(const Ray& ray, const CellHit& cell_hit, Hit& hit) const {
  const ShapeCells& shape = *cells_->shapes()[cell_hit.shape];
  const Cell& cell = shape.cells[cell_hit.cell];
  hit.t = cell_hit.t;
  hit.shape = cell_hit.shape;
  hit.is_leaving = ray.inside.contains(hit.shape);
  hit.lift = Vec3(0);
  hit.position = ray.origin + hit.t * ray.direction;
  const Vec3 g = cell_gradient(shape, cell, hit.position);
  const float length = glm::length(g);
  // A vanishing gradient (a crease's exact middle): facing the ray is the best there is.
  hit.normal = length > 0 ? -g / length : -ray.direction;
  hit.epsilon = cell.epsilon + rounding_at(hit.position, hit.t);
}

ShapeSet Tracer::shapes_around(const Vec3& p) const {
  ShapeSet around;
  for (size_t i = 0; i < cells_->shapes().size(); ++i) {
    const FieldProgram& program = cells_->shapes()[i]->program;
    if (program.code.steps.empty() || !program.support.contains(Vec3d(p))) continue;
    if (evaluate(program, program.code, Point3<double>{p.x, p.y, p.z}) > program.threshold) around.add(static_cast<uint32_t>(i));
  }
  return around;
}

size_t Tracer::cell_count() const {
  size_t n = 0;
  for (const SharedCells& s : cells_->shapes()) n += s->cells.size();
  return n;
}

size_t Tracer::element_count() const {
  size_t n = 0;
  for (const SharedCells& s : cells_->shapes()) n += s->program.element_count();
  return n;
}

} // namespace kelpie
