#include "renderer/trace/tracer.h"

#include <algorithm>
#include <array>
#include <map>

#include "renderer/program/bound.h"

namespace kelpie {

namespace {

using SharedCells = std::shared_ptr<const ShapeCells>;

/// The moments of a frame that were asked for.
class Moments {
public:
  explicit Moments(const FrameScene& frame) : frame_(frame), exposure_(frame.exposure()) {}

  const FrameScene& at(double time) {
    const auto [found, is_new] = moments_.try_emplace(time);
    if (is_new) found->second = frame_.moment(exposure_.frame_at(time));
    return found->second;
  }

private:
  const FrameScene& frame_;
  Exposure exposure_;
  std::map<double, FrameScene> moments_;
};

Slabs build_moving(Moments& moments, size_t shape, std::span<const double> breaks, const CellLimits& limits) {
  const CompileAt compile_at = [&](std::span<const double> times) {
    std::vector<SampledField> fields;
    std::vector<double> thresholds;
    for (const double t : times) {
      const SampledShape& s = moments.at(t).shapes[shape];
      fields.push_back(s.field), thresholds.push_back(s.threshold);
    }
    return compile(std::move(fields), thresholds);
  };
  return build_slabs(compile_at, breaks, limits);
}

bool is_same_subdivision(const CellLimits& a, const CellLimits& b) {
  return a.elements == b.elements && a.sparse_side == b.sparse_side && a.side_in_radii == b.side_in_radii && a.depth == b.depth;
}

/// Builds the cells of a frame's shapes, or takes those of the last frame.
class CellBuilder {
public:
  CellBuilder(const FrameScene& frame, const CellLimits& limits, const KeptScenes& kept)
      : frame_(frame), exposure_(frame.exposure()), moments_(frame), limits_(limits), kept_(kept.cells) {
    if (exposure_.length > 0) {
      for (const double at : frame.breaks) breaks_.push_back((at - exposure_.start) / exposure_.length);
      looks_ = {0, 0.25, 0.5, 0.75, 1};
      for (const double t : breaks_)
        if (t > 0 && t < 1) looks_.push_back(t);
    }
    const bool fits = kept_ && kept_->shapes().size() == frame.shapes.size() && is_same_subdivision(kept.limits, limits) &&
                      kept.is_exposed == (exposure_.length > 0);
    if (!fits) kept_.reset();
  }

  bool is_unchanged(size_t i) {
    if (!kept_) return false;
    const Slabs& last = kept_->shapes()[i];
    if (last.size() > 1 || last[0]->program.motion || !is_equal(*last[0], frame_.shapes[i])) return false;
    return std::all_of(looks_.begin(), looks_.end(), [&](double t) { return is_equal(*last[0], moments_.at(t).shapes[i]); });
  }
  const Slabs& last(size_t i) const { return kept_->shapes()[i]; }
  /// What has changed makes room first.
  void forget() { kept_.reset(); }

  Slabs build(size_t i) {
    const SampledShape& shape = frame_.shapes[i];
    if (exposure_.length > 0 && !shape.field.nodes.empty()) return build_moving(moments_, i, breaks_, limits_);
    ShapeCells cells;
    if (shape.field.nodes.empty()) // geometry has no cells
      cells.program.threshold = shape.threshold;
    else
      cells = build_cells(compile(shape.field, shape.threshold), limits_);
    return {std::make_shared<const ShapeCells>(std::move(cells))};
  }

private:
  static bool is_equal(const ShapeCells& last, const SampledShape& shape) {
    return last.program.threshold == double(shape.threshold) && kelpie::is_equal(last.program.field, shape.field);
  }

  const FrameScene& frame_;
  Exposure exposure_;
  Moments moments_;
  const CellLimits& limits_;
  std::shared_ptr<const CellScene> kept_;
  std::vector<double> breaks_; ///< in the time of the exposure
  std::vector<double> looks_;  ///< when a shape must be the same to count as unchanged
};

std::shared_ptr<const CellScene> build_cell_scene(const FrameScene& frame, const CellLimits& limits, KeptScenes& kept, size_t& kept_cells) {
  CellBuilder builder(frame, limits, kept);
  std::vector<Slabs> all(frame.shapes.size());
  for (size_t i = 0; i < all.size(); ++i)
    if (builder.is_unchanged(i)) all[i] = builder.last(i);
  builder.forget();
  const bool is_all_kept = std::none_of(all.begin(), all.end(), [](const Slabs& s) { return s.empty(); });
  if (!is_all_kept) kept.cells.reset(); // what has changed makes room first
  for (size_t i = 0; i < all.size(); ++i) {
    if (all[i].empty()) {
      all[i] = builder.build(i);
      continue;
    }
    const ShapeCells& cells = *all[i][0];
    kept_cells += cells.cells.size();
    if (limits.budget) limits.budget->take(cells.bytes() + cells.cells.size() * k_tree_bytes_per_cell);
  }
  if (!is_all_kept || !kept.cells) kept.cells = std::make_shared<const CellScene>(std::move(all));
  kept.limits = limits, kept.limits.budget = nullptr, kept.is_exposed = frame.exposure().length > 0;
  return kept.cells;
}

std::shared_ptr<const MeshScene> build_mesh_scene(const FrameScene& frame, const CellLimits& limits, KeptScenes& kept) {
  std::vector<MovingMesh> meshes;
  const auto place = [&](uint32_t shape, const FrameScene& at) { return std::get<TriangleMesh<SampledMode>>(*at.shapes[shape].geometry); };
  for (uint32_t i = 0; i < frame.shapes.size(); ++i)
    if (const auto& geometry = frame.shapes[i].geometry; geometry && std::holds_alternative<TriangleMesh<SampledMode>>(*geometry))
      meshes.push_back({i, {place(i, frame)}});
  if (const Exposure exposure = frame.exposure(); exposure.length > 0 && !meshes.empty()) {
    for (MovingMesh& mesh : meshes) mesh.states.clear();
    for (int i = 0; i < k_states; ++i) { // all meshes together: a moment of a scene may take a while
      const FrameScene at = frame.moment(exposure.frame_at(double(i) / (k_states - 1)));
      for (MovingMesh& mesh : meshes) mesh.states.push_back(place(mesh.shape, at));
    }
  }
  for (MovingMesh& mesh : meshes) {
    const auto stands = [&](const TriangleMesh<SampledMode>& state) { return is_same(state, mesh.states[0]); };
    if (std::all_of(mesh.states.begin(), mesh.states.end(), stands)) mesh.states.resize(1);
    if (limits.budget) limits.budget->take(estimated_bytes(mesh));
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

Vec3 facing_normal(const Ray& arrived, const Hit& hit) { return glm::dot(hit.normal, arrived.direction) > 0 ? -hit.normal : hit.normal; }

Ray depart(const Ray& arrived, const Hit& hit, const Vec3& direction, Side side) {
  const Vec3 back = facing_normal(arrived, hit);
  Ray ray;
  ray.origin = side == Side::near ? hit.position + hit.lift + hit.epsilon * back : hit.position - hit.epsilon * back;
  ray.direction = direction;
  ray.inside = arrived.inside, ray.time = arrived.time;
  if (side == Side::near) return ray;
  if (hit.is_leaving)
    ray.inside.remove(hit.shape);
  else
    ray.inside.add(hit.shape);
  return ray;
}

Tracer::Tracer(const FrameScene& frame, const CellLimits& limits, KeptScenes* kept)
    : exposure_(frame.exposure().length), media_(frame.shapes) {
  KeptScenes nothing;
  meshes_ = build_mesh_scene(frame, limits, kept ? *kept : nothing);
  cells_ = build_cell_scene(frame, limits, kept ? *kept : nothing, kept_cells_);
  for (uint32_t i = 0; i < frame.shapes.size(); ++i) {
    const SampledShape& shape = frame.shapes[i];
    if (!shape.geometry || !std::holds_alternative<Plane<SampledMode>>(*shape.geometry)) continue;
    const auto plane = [&](const FrameScene& at) { return std::get<Plane<SampledMode>>(*at.shapes[i].geometry); };
    planes_.push_back({states_of(frame, 0, plane), i});
  }
  for (const Slabs& slabs : cells_->shapes())
    for (const SharedCells& s : slabs)
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
  Hit hit;
  if (media_.hides()) {
    Ray onward = ray;
    return intersect(onward, counters, hit) && pass_hidden(onward, counters, hit);
  }
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
  if (media_.hides()) { // what can be seen depends on the way
    for (size_t i = 0; i < rays.size(); ++i) found |= uint32_t(occluded(rays[i], counters)) << i;
    return found;
  }
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
  hit.slab = nullptr, hit.time = ray.time;
  hit.is_leaving = on_mesh.is_leaving, hit.lift = on_mesh.lift;
  hit.epsilon = on_mesh.epsilon + rounding_at(hit.position, hit.t);
  return true;
}

bool Tracer::meet_planes(const Ray& ray, Hit& hit) const {
  bool found = false;
  for (const PlaneShape& shape : planes_) {
    Plane<SampledMode> plane = state_at(shape.states, ray.time);
    plane.normal = glm::normalize(plane.normal);
    const float across = glm::dot(ray.direction, plane.normal);
    const float t = glm::dot(plane.position - ray.origin, plane.normal) / across;
    if (!(t > ray.t_near && t < hit.t)) continue; // false for the NaN of a ray in the plane, too
    found = true;
    hit.t = t, hit.shape = shape.shape, hit.normal = plane.normal, hit.is_leaving = across > 0, hit.lift = Vec3(0);
    hit.slab = nullptr, hit.time = ray.time;
    hit.position = ray.origin + t * ray.direction;
    hit.position -= glm::dot(hit.position - plane.position, plane.normal) * plane.normal;
    hit.epsilon = 1e-5f + rounding_at(hit.position, t);
  }
  return found;
}

void Tracer::complete(const Ray& ray, const CellHit& cell_hit, Hit& hit) const {
  const ShapeCells& shape = cells_->shape(cell_hit.shape, ray.time);
  const Cell& cell = shape.cells[cell_hit.cell];
  hit.t = cell_hit.t;
  hit.shape = cell_hit.shape, hit.cell = cell_hit.cell, hit.slab = &shape, hit.time = ray.time;
  hit.is_leaving = ray.inside.contains(hit.shape);
  hit.lift = Vec3(0);
  hit.position = ray.origin + hit.t * ray.direction;
  const Vec3 g = cell_gradient(shape, cell, hit.position, ray.time);
  const float length = glm::length(g);
  // A vanishing gradient (a crease's exact middle): facing the ray is the best there is.
  hit.normal = length > 0 ? -g / length : -ray.direction;
  hit.epsilon = cell.epsilon + rounding_at(hit.position, hit.t);
}

Vec3 Tracer::velocity(const Hit& hit) const {
  if (exposure_ == 0) return Vec3(0);
  const auto per_frame = static_cast<float>(1 / exposure_);
  for (const PlaneShape& plane : planes_) {
    if (plane.shape != hit.shape) continue;
    // A plane is the field -dot(p - position, normal) about 0.
    constexpr float k_step = 0.5f / (k_states - 1);
    const auto height = [&](float at) {
      const Plane<SampledMode> p = state_at(plane.states, at);
      return glm::dot(hit.position - p.position, glm::normalize(p.normal));
    };
    const float before = std::max(hit.time - k_step, 0.f), after = std::min(hit.time + k_step, 1.f);
    return -(height(after) - height(before)) / (after - before) * per_frame * hit.normal;
  }
  if (const std::optional<Vec3> of_mesh = meshes_->velocity(hit.shape, hit.position, hit.time)) return *of_mesh * per_frame;
  const ShapeCells& shape = *hit.slab;
  const Cell& cell = shape.cells[hit.cell];
  const Vec3 g = cell_gradient(shape, cell, hit.position, hit.time);
  const double rate = cell_rate(shape, cell, hit.position, hit.time);
  // Where the gradient vanishes next to threshold / radius the surface has no velocity: it appears, or tears.
  const double least = 1e-3 * shape.program.threshold / (1e3 * cell.epsilon);
  return static_cast<float>(-rate * shape.slabs * per_frame / (double(glm::dot(g, g)) + square(least))) * g;
}

size_t Tracer::cell_count() const {
  size_t n = 0;
  for (const Slabs& slabs : cells_->shapes())
    for (const SharedCells& s : slabs) n += s->cells.size();
  return n;
}

size_t Tracer::element_count() const {
  size_t n = 0;
  for (const Slabs& slabs : cells_->shapes()) n += slabs[0]->program.element_count();
  return n;
}

Surroundings::Surroundings(const Tracer& tracer, const Box3& where) {
  const Box3d box{Vec3d(where.lower), Vec3d(where.upper)};
  for (const Slabs& slabs : tracer.cells_->shapes()) {
    std::vector<Slab>& shape = shapes_.emplace_back();
    for (const SharedCells& s : slabs) {
      Slab& slab = shape.emplace_back(Slab{s.get(), {}, {}});
      const FieldProgram& program = s->program;
      if (program.code.steps.empty() || intersect(program.support, box).is_empty()) {
        slab.is_inside = false;
        continue;
      }
      std::vector<Interval> ranges;
      const Code code = bound(program, program.code, box, ranges);
      constexpr double k_margin = 1e-5; // bounds of blobs are found in float
      const Interval threshold = threshold_range(program);
      if (ranges.back().hi < threshold.lo * (1 - k_margin)) slab.is_inside = false;
      if (ranges.back().lo > threshold.hi * (1 + k_margin)) slab.is_inside = true;
      if (!slab.is_inside) slab.code = prune(program, code, ranges);
    }
  }
}

ShapeSet Surroundings::shapes_around(const Vec3& p, float time) const {
  ShapeSet around;
  for (size_t i = 0; i < shapes_.size(); ++i) {
    const size_t n = shapes_[i].size();
    const Slab& slab = shapes_[i][std::min(static_cast<size_t>(time * static_cast<float>(n)), n - 1)];
    bool is_inside = slab.is_inside.value_or(false);
    if (!slab.is_inside) {
      const FieldProgram& program = at(slab.cells->program, slab.code, slab.cells->slab_time(time));
      is_inside = evaluate(program, slab.code, Point3<double>{p.x, p.y, p.z}) > program.threshold;
    }
    if (is_inside) around.add(static_cast<uint32_t>(i));
  }
  return around;
}

} // namespace kelpie
