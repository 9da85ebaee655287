#include "renderer/trace/cell_scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <deque>
#include <exception>
#include <utility>

#include "base/parallel.h"
#include "renderer/trace/embree_device.h"

namespace kelpie {

namespace {

/// The slab, of a number of them, that a time of the open shutter lies in.
size_t slab_of(float time, size_t slabs) { return std::min(static_cast<size_t>(time * static_cast<float>(slabs)), slabs - 1); }

} // namespace

/// What Embree has of a shape in a window of time; its primitives are the window's cells.
struct Window {
  const ShapeCells* shape;
  uint32_t first; ///< of ShapeCells::cells
  std::span<const Cell> cells;
  mutable HandOver to_builders, from_builders; ///< to the threads in which Embree asks for bounds, and back
};

struct CellScene::State {
  std::vector<Slabs> shapes;
  EmbreeDevice device;
  std::deque<Window> windows;
  std::vector<RTCScene> scenes; ///< one for each window of time of the shape with most of them

  ~State() {
    for (RTCScene scene : scenes) rtcReleaseScene(scene);
  }

  RTCScene at(float time) const { return scenes[slab_of(time, scenes.size())]; }
};

namespace {

/// What a query passes to the callbacks behind Embree's own context.
struct Query {
  RTCIntersectContext embree; // first, so that Embree's pointer to it is a pointer to this
  const Ray* rays;            ///< by RTCRay::id
  bool any_inside;            ///< whether one of them starts inside a shape
  SolveCounters* counters;
  std::exception_ptr failure{}; ///< what a solver threw

  Query(std::span<const Ray> of, SolveCounters& to) : rays(of.data()), counters(&to) {
    any_inside = std::any_of(of.begin(), of.end(), [](const Ray& r) { return !r.inside.is_empty(); });
    rtcInitIntersectContext(&embree);
  }

  /// Does the work of a callback. Nothing may be thrown through Embree: it is kept, and nothing more is done.
  template <class Work>
  void attempt(Work&& work) noexcept {
    if (failure) return;
    try {
      work();
    } catch (...) {
      failure = std::current_exception();
    }
  }
  /// Throws what was kept.
  void finish() const {
    if (failure) std::rethrow_exception(failure);
  }
};

void cell_bounds(const RTCBoundsFunctionArguments* args) noexcept {
  const Window& window = *static_cast<const Window*>(args->geometryUserPtr);
  window.to_builders.take();
  const Box3& box = window.cells[args->primID].box;
  // A hair wider: where Embree does not look, clip() must not either, in or out of a packet.
  const Vec3 pad = 1e-6f * glm::max(glm::abs(box.lower), glm::abs(box.upper)) + 1e-12f;
  RTCBounds& out = *args->bounds_o;
  out.lower_x = box.lower.x - pad.x, out.lower_y = box.lower.y - pad.y, out.lower_z = box.lower.z - pad.z;
  out.upper_x = box.upper.x + pad.x, out.upper_y = box.upper.y + pad.y, out.upper_z = box.upper.z + pad.z;
  window.from_builders.give();
}

/// Solves one cell for one ray.
bool meet(const ShapeCells& shape, unsigned shape_index, unsigned cell_index, const Ray& ray, float t_far, SolveCounters& counters,
          float& t) {
  const Cell& cell = shape.cells[cell_index];
  RaySegment segment;
  const bool from_inside = ray.inside.contains(shape_index);
  if (!clip(cell, ray, from_inside, segment) || segment.entry > t_far || !solve(shape, cell, segment, counters, t)) return false;
  t = std::max(t, segment.entry);
  return t <= t_far;
}

/// Solves one cell for the rays of a packet; returns the lanes that hit before their t_far.
uint32_t meet(const ShapeCells& shape, unsigned shape_index, unsigned cell_index, const Query& query, const int* valid, RTCRayN* packet,
              unsigned n, bool any, float* t) {
  RayLanes rays{n,
                valid,
                &RTCRayN_org_x(packet, n, 0),
                &RTCRayN_org_y(packet, n, 0),
                &RTCRayN_org_z(packet, n, 0),
                &RTCRayN_dir_x(packet, n, 0),
                &RTCRayN_dir_y(packet, n, 0),
                &RTCRayN_dir_z(packet, n, 0),
                &RTCRayN_tnear(packet, n, 0),
                &RTCRayN_tfar(packet, n, 0),
                &RTCRayN_time(packet, n, 0),
                any};
  uint32_t inside = 0;
  alignas(64) std::array<int, k_packet> outside;
  if (query.any_inside) {
    for (unsigned i = 0; i < n; ++i) {
      const bool is_inside = valid[i] && query.rays[RTCRayN_id(packet, n, i)].inside.contains(shape_index);
      inside |= uint32_t(is_inside) << i;
      outside[i] = is_inside ? 0 : valid[i];
    }
    rays.valid = outside.data();
  }
  uint32_t hits = solve_lanes(shape, shape.cells[cell_index], rays, *query.counters, t);
  for (uint32_t left = hits; left; left &= left - 1) {
    const auto i = static_cast<unsigned>(std::countr_zero(left));
    if (!(t[i] <= rays.t_far[i])) hits &= ~(1u << i);
  }
  for (; inside; inside &= inside - 1) { // rare: one by one
    const auto i = static_cast<unsigned>(std::countr_zero(inside));
    const Ray& ray = query.rays[RTCRayN_id(packet, n, i)];
    if (meet(shape, shape_index, cell_index, ray, rays.t_far[i], *query.counters, t[i])) hits |= 1u << i;
  }
  return hits;
}

/// Whether a hit at t comes before what the ray has met: of equals the first cell counts, whichever was visited first.
bool is_nearer(float t, unsigned shape, unsigned cell, float t_far, unsigned met_shape, unsigned met_cell) {
  if (t != t_far || met_shape == RTC_INVALID_GEOMETRY_ID) return true;
  return shape != met_shape ? shape < met_shape : cell < met_cell;
}

/// A cell that Embree asks about.
struct Asked {
  const ShapeCells& shape;
  unsigned shape_index, cell;
  Query& query;

  template <class Arguments>
  explicit Asked(const Arguments* args)
      : shape(*static_cast<const Window*>(args->geometryUserPtr)->shape), shape_index(args->geomID),
        cell(static_cast<const Window*>(args->geometryUserPtr)->first + args->primID), query(*reinterpret_cast<Query*>(args->context)) {}

  /// Solves it; returns the rays (bits) that hit before their t_far, and where.
  uint32_t meet(const int* valid, RTCRayN* rays, unsigned n, bool any, float* t) const {
    if (n > 1) return kelpie::meet(shape, shape_index, cell, query, valid, rays, n, any, t);
    return valid[0] && kelpie::meet(shape, shape_index, cell, *query.rays, RTCRayN_tfar(rays, 1, 0), *query.counters, t[0]);
  }
};

/// Shortens the rays that hit, so that farther cells are culled.
void cell_intersect(const RTCIntersectFunctionNArguments* args) noexcept {
  const Asked asked(args);
  asked.query.attempt([&] {
    const unsigned n = args->N;
    RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, n);
    RTCHitN* found = RTCRayHitN_HitN(args->rayhit, n);
    alignas(64) std::array<float, k_packet> t;
    for (uint32_t hits = asked.meet(args->valid, rays, n, false, t.data()); hits; hits &= hits - 1) {
      const auto i = static_cast<unsigned>(std::countr_zero(hits));
      if (!is_nearer(t[i], args->geomID, asked.cell, RTCRayN_tfar(rays, n, i), RTCHitN_geomID(found, n, i), RTCHitN_primID(found, n, i)))
        continue;
      RTCRayN_tfar(rays, n, i) = t[i];
      RTCHitN_geomID(found, n, i) = args->geomID;
      RTCHitN_primID(found, n, i) = asked.cell;
    }
  });
}

void cell_occluded(const RTCOccludedFunctionNArguments* args) noexcept {
  const Asked asked(args);
  asked.query.attempt([&] {
    const unsigned n = args->N;
    alignas(64) std::array<float, k_packet> t;
    for (uint32_t hits = asked.meet(args->valid, args->ray, n, true, t.data()); hits; hits &= hits - 1)
      RTCRayN_tfar(args->ray, n, static_cast<unsigned>(std::countr_zero(hits))) = -std::numeric_limits<float>::infinity();
  });
}

/// Up to 16 rays into a packet; the other lanes take no part, nor do those whose ray is none. Embree looks at the numbers of all lanes,
/// so these hold a ray like any other.
template <class Packet>
void fill(std::span<const Ray> rays, Packet& out) {
  Ray idle;
  idle.origin = Vec3(0), idle.direction = Vec3(0, 0, 1);
  for (size_t i = 0; i < k_packet; ++i) {
    const Ray& ray = i < rays.size() && is_traceable(rays[i]) ? rays[i] : idle;
    out.org_x[i] = ray.origin.x, out.org_y[i] = ray.origin.y, out.org_z[i] = ray.origin.z;
    out.dir_x[i] = ray.direction.x, out.dir_y[i] = ray.direction.y, out.dir_z[i] = ray.direction.z;
    out.tnear[i] = ray.t_near, out.tfar[i] = ray.t_far, out.time[i] = ray.time;
    out.mask[i] = ~0u, out.id[i] = static_cast<unsigned>(i), out.flags[i] = 0;
  }
}

Query packet_query(std::span<const Ray> rays, SolveCounters& counters) {
  Query query(rays, counters);
  query.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return query;
}

/// Calls trace(scene, valid) for each window of time that some of the rays are in, with those that are. Where Embree has no packets as
/// wide as these (without AVX-512) it does not look at `valid`: to it the other rays end before they begin.
template <class Trace>
void for_each_slab(std::span<const Ray> rays, std::span<const RTCScene> scenes, float* t_far, Trace&& trace) {
  alignas(64) std::array<int, k_packet> valid;
  std::array<float, k_packet> kept;
  uint32_t left = 0;
  for (size_t i = 0; i < rays.size(); ++i) left |= uint32_t(is_traceable(rays[i])) << i;
  while (left) {
    const size_t slab = slab_of(rays[size_t(std::countr_zero(left))].time, scenes.size());
    for (size_t i = 0; i < k_packet; ++i) {
      const bool is_in = left >> i & 1 && slab_of(rays[i].time, scenes.size()) == slab;
      valid[i] = is_in ? -1 : 0;
      if (is_in) left &= ~(1u << i);
      if (!is_in) kept[i] = std::exchange(t_far[i], -1.f);
    }
    trace(scenes[slab], valid.data());
    for (size_t i = 0; i < k_packet; ++i)
      if (!valid[i]) t_far[i] = kept[i];
  }
}

/// The cells of a shape in one window of time, for all scenes of that time.
void attach(RTCDevice device, std::span<const RTCScene> scenes, const Window& window, unsigned index) {
  if (window.cells.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  window.to_builders.give();
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(window.cells.size()));
  rtcSetGeometryUserData(geometry, const_cast<Window*>(&window));
  rtcSetGeometryBoundsFunction(geometry, cell_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, cell_intersect);
  rtcSetGeometryOccludedFunction(geometry, cell_occluded);
  rtcCommitGeometry(geometry);
  for (RTCScene scene : scenes) rtcAttachGeometryByID(scene, geometry, index);
  rtcReleaseGeometry(geometry);
}

} // namespace

CellScene::CellScene(std::vector<Slabs> shapes) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.shapes = std::move(shapes);
  const auto windows_of = [](const Slabs& slabs) { return slabs.size() * slabs[0]->windows(); };
  size_t windows = 1;
  for (const Slabs& shape : s.shapes) windows = std::max(windows, windows_of(shape));
  for (size_t i = 0; i < windows; ++i) s.scenes.push_back(s.device.new_scene());
  for (unsigned i = 0; i < s.shapes.size(); ++i) {
    const size_t share = windows / windows_of(s.shapes[i]);
    size_t first_scene = 0;
    for (const auto& shape : s.shapes[i])
      for (size_t j = 0; j < shape->windows(); ++j, first_scene += share) {
        const std::span<const Cell> cells = shape->cells_in(j);
        s.windows.push_back({shape.get(), static_cast<uint32_t>(cells.data() - shape->cells.data()), cells, {}, {}});
        attach(s.device, std::span(s.scenes).subspan(first_scene, share), s.windows.back(), i);
      }
  }
  for (RTCScene scene : s.scenes) rtcCommitScene(scene);
  for (Window& window : s.windows) window.from_builders.take();
  s.device.check();
}

CellScene::~CellScene() = default;
CellScene::CellScene(CellScene&&) noexcept = default;
CellScene& CellScene::operator=(CellScene&&) noexcept = default;

bool CellScene::intersect(const Ray& ray, SolveCounters& counters, CellHit& hit) const {
  if (!is_traceable(ray)) return false;
  Query query(std::span(&ray, 1), counters);
  RTCRayHit r;
  r.ray = to_embree(ray);
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->at(ray.time), &query.embree, &r);
  query.finish();
  if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit = {r.ray.tfar, r.hit.geomID, r.hit.primID};
  return true;
}

bool CellScene::occluded(const Ray& ray, SolveCounters& counters) const {
  if (!is_traceable(ray)) return false;
  Query query(std::span(&ray, 1), counters);
  RTCRay r = to_embree(ray);
  rtcOccluded1(state_->at(ray.time), &query.embree, &r);
  query.finish();
  return r.tfar < 0;
}

uint32_t CellScene::intersect(std::span<const Ray> rays, SolveCounters& counters, CellHit* hits) const {
  if (rays.empty()) return 0;
  Query query = packet_query(rays, counters);
  RTCRayHit16 r;
  fill(rays, r.ray);
  std::fill(std::begin(r.hit.geomID), std::end(r.hit.geomID), RTC_INVALID_GEOMETRY_ID);
  for_each_slab(rays, state_->scenes, r.ray.tfar,
                [&](RTCScene scene, const int* valid) { rtcIntersect16(valid, scene, &query.embree, &r); });
  query.finish();
  uint32_t found = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    if (r.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    hits[i] = {r.ray.tfar[i], r.hit.geomID[i], r.hit.primID[i]};
    found |= 1u << i;
  }
  return found;
}

uint32_t CellScene::occluded(std::span<const Ray> rays, SolveCounters& counters) const {
  if (rays.empty()) return 0;
  Query query = packet_query(rays, counters);
  RTCRay16 r;
  fill(rays, r);
  for_each_slab(rays, state_->scenes, r.tfar, [&](RTCScene scene, const int* valid) { rtcOccluded16(valid, scene, &query.embree, &r); });
  query.finish();
  uint32_t found = 0;
  for (size_t i = 0; i < rays.size(); ++i) found |= uint32_t(r.tfar[i] < 0) << i;
  return found;
}

const std::vector<Slabs>& CellScene::shapes() const { return state_->shapes; }
const ShapeCells& CellScene::shape(size_t index, float time) const {
  const Slabs& slabs = state_->shapes[index];
  return *slabs[slab_of(time, slabs.size())];
}
size_t CellScene::slab_count() const {
  size_t most = 1;
  for (const Slabs& slabs : state_->shapes) most = std::max(most, slabs.size());
  return most;
}
size_t CellScene::window_count() const { return state_->scenes.size(); }

size_t CellScene::bytes() const {
  size_t n = state_->device.bytes();
  for (const auto& slabs : state_->shapes)
    for (const auto& s : slabs) n += s->bytes();
  return n;
}

} // namespace kelpie
