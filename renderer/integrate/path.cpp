#include "renderer/integrate/path.h"

#include <array>
#include <optional>

#include "renderer/integrate/orthonormal_basis.h"

namespace kelpie {

namespace {

/// The power heuristic (Veach 1997) for one sample of each of two strategies.
float mis_weight(float pdf, float other) {
  const float a = pdf * pdf, b = other * other;
  return a / (a + b);
}

/// Seen from a matte surface, a polished metal focuses light into caustics that a path finds once in a
/// thousand tries: fireflies. There its lobe is widened to this (path regularisation, after Kaplanyan and
/// Dachsbacher 2013): caustics become softer, light is neither lost nor made.
constexpr float k_alpha_after_matte = 0.3f;
/// A direction that was chosen with less than this density came from a lobe that is at least as wide: then the vertex was matte.
constexpr float k_matte_density = 0.9f;
/// From here on, dim paths are ended by chance.
constexpr int k_roulette_from = 4;

} // namespace

/// A point of a path on a surface. Local coordinates have the normal on the side of the viewer as z.
struct PathTracer::Vertex {
  Vertex(Path& p, const Hit& h, const Vec3& facing) : path(p), hit(h), basis(facing), out(basis.local_from_world(-p.ray.direction)) {}

  const SurfaceBsdf& bsdf() const { return own ? *own : *shared; }

  /// A ray towards where light comes from, the same direction in local coordinates and in the world. It starts on the side of
  /// the surface that the shading normal says. Where a facet of a mesh lies on the other side of it, the ray meets that facet
  /// next, and goes through it or is shadowed as by any other.
  Ray leave(const Vec3& in, const Vec3& direction) const { return depart(path.ray, hit, direction, in.z < 0 ? Side::far : Side::near); }

  Path& path;
  const Hit& hit;
  OrthonormalBasis basis;
  Vec3 out;                            ///< towards the viewer, local
  const SurfaceBsdf* shared = nullptr; ///< of all hits on the shape, unless this one has its
  std::optional<SurfaceBsdf> own;
  Vec3 direct{0}; ///< light that samples of lights found
};

PathTracer::PathTracer(const Tracer& tracer, const std::vector<Light>& lights, const FrameScene& frame)
    : tracer_(tracer), lights_(lights), background_(frame.film.background), surfaces_(frame, tracer), bounces_(frame.film.bounces) {
  for (const Light& light : lights_) {
    if (light.is_even()) for_matte_ = Sought::even;
    if (!light.is_delta()) for_glossy_ = Sought::all;
    has_near_light_ |= !light.is_distant();
  }
}

void PathTracer::trace(std::span<Path> paths, RayCounters& counters) const {
  counters.camera += paths.size();
  std::array<Hit, k_packet> hits;
  std::vector<Vertex> vertices;
  std::vector<Path*> going;
  vertices.reserve(paths.size()), going.reserve(paths.size());
  for (Path& path : paths) going.push_back(&path);
  for (int bounce = 0; !going.empty(); ++bounce) {
    const uint32_t met = meet(going, bounce == 0, counters.solve, hits.data());
    vertices.clear();
    for (size_t i = 0; i < going.size(); ++i) {
      if (met >> i & 1)
        vertices.push_back(arrive(*going[i], hits[i], bounce));
      else
        escape(*going[i], bounce);
    }
    add_direct_light(vertices, bounce, counters);
    going.clear();
    for (Vertex& vertex : vertices)
      if (scatter(vertex, bounce, counters)) going.push_back(&vertex.path);
  }
}

/// The paths (bits) whose rays meet a surface that can be seen.
uint32_t PathTracer::meet(std::span<Path* const> paths, bool side_by_side, SolveCounters& counters, Hit* hits) const {
  uint32_t met = 0;
  for (Path* path : paths) path->start = path->ray.origin;
  if (side_by_side) {
    std::array<Ray, k_packet> rays;
    for (size_t i = 0; i < paths.size(); ++i) rays[i] = paths[i]->ray;
    met = tracer_.intersect(std::span<const Ray>(rays).first(paths.size()), counters, hits);
  } else {
    for (size_t i = 0; i < paths.size(); ++i) met |= uint32_t(tracer_.intersect(paths[i]->ray, counters, hits[i])) << i;
  }
  if (!tracer_.media().hides()) return met;
  for (size_t i = 0; i < paths.size(); ++i)
    if (met >> i & 1 && !tracer_.pass_hidden(paths[i]->ray, counters, hits[i])) met &= ~(1u << i);
  return met;
}

/// The rays (bits) that do not reach the light.
uint32_t PathTracer::shadowed(std::span<const Ray> rays, bool side_by_side, SolveCounters& counters) const {
  if (side_by_side) return tracer_.occluded(rays, counters);
  uint32_t dark = 0;
  for (size_t i = 0; i < rays.size(); ++i) dark |= uint32_t(tracer_.occluded(rays[i], counters)) << i;
  return dark;
}

PathTracer::Vertex PathTracer::arrive(Path& path, const Hit& hit, int bounce) const {
  const Vec3 normal = facing_normal(path.ray, hit);
  const Footprint footprint = surfaces_.is_uniform(hit) ? Footprint{} : path.cone.on_surface(path.ray.direction, normal, hit.t);
  std::optional<SurfaceParameters> memory;
  const SurfaceParameters& surface = surfaces_.at(hit, footprint, memory);
  if (has_near_light_) path.result.radiance += path.throughput * found(path, glm::distance(path.start, hit.position), bounce);
  path.throughput *= left_of_light(path, hit);
  const bool from_inside = hit.is_leaving && surface.transmission_weight > 0;
  if (!from_inside) path.result.radiance += path.throughput * (surface.emission_color.rgb * surface.emission_luminance);
  Vertex vertex(path, hit, normal);
  vertex.shared = path.ray.inside.is_empty() ? surfaces_.opaque_in_air(hit) : nullptr;
  if (!vertex.shared) vertex.own.emplace(surface, boundary_at(path.ray, hit, surface));
  if (path.after_matte && vertex.bsdf().is_glossy()) vertex.own = vertex.bsdf().at_least_as_rough_as(k_alpha_after_matte);
  if (bounce == 0) path.result.is_hit = true, path.result.hit = hit, path.result.albedo = vertex.bsdf().albedo();
  // On a glossy surface samples of lights and scattered rays are both weighed, even on the last vertex: highlights are direct light. On a
  // matte one a scattered ray that finds light adds noise to what samples found (their density follows the radiance, so only the cosine
  // varies), unless the light is about as even as the cosine.
  path.sought = vertex.bsdf().is_glossy() ? for_glossy_ : for_matte_;
  return vertex;
}

/// What a shape that a ray is in is made of, about a hit of that ray.
const SurfaceParameters& PathTracer::medium_at(uint32_t shape, const Hit& hit, std::optional<SurfaceParameters>& memory) const {
  Hit there = hit;
  if (shape != hit.shape) there.shape = shape, there.slab = nullptr; // of its field nothing is known here
  return surfaces_.at(there, {}, memory);
}

/// The media on both sides of a surface. Nested dielectrics: what fills a place is what has the highest priority there.
Boundary PathTracer::boundary_at(const Ray& arrived, const Hit& hit, const SurfaceParameters& surface) const {
  if (surface.transmission_weight == 0 && arrived.inside.is_empty()) return {1, surface.specular_ior, false};
  ShapeSet beyond = arrived.inside;
  if (hit.is_leaving)
    beyond.remove(hit.shape);
  else
    beyond.add(hit.shape);
  const auto ior_in = [&](const ShapeSet& shapes) {
    const std::optional<uint32_t> filling = tracer_.media().filling(shapes);
    if (!filling) return 1.f;
    if (*filling == hit.shape) return surface.specular_ior;
    std::optional<SurfaceParameters> memory;
    return medium_at(*filling, hit, memory).specular_ior;
  };
  return {ior_in(arrived.inside), ior_in(beyond), hit.is_leaving && surface.transmission_weight > 0};
}

/// Of the light along a ray up to a hit, what the medium that it lies in leaves (Beer and Lambert).
Vec3 PathTracer::left_of_light(const Path& path, const Hit& hit) const {
  const std::optional<uint32_t> filling = tracer_.media().filling(path.ray.inside);
  if (!filling) return Vec3(1);
  std::optional<SurfaceParameters> memory;
  const SurfaceParameters& medium = medium_at(*filling, hit, memory);
  if (medium.transmission_weight == 0 || medium.transmission_depth == 0) return Vec3(1);
  return glm::pow(glm::max(medium.transmission_color.rgb, Vec3(1e-6f)),
                  Vec3(glm::distance(path.start, hit.position) / medium.transmission_depth));
}

/// The path's ray met nothing.
void PathTracer::escape(Path& path, int bounce) const {
  if (bounce == 0) path.result.radiance = background(path.ray.direction);
  path.result.radiance += path.throughput * found(path, k_infinitely_far, bounce);
}

/// Gives a path its next ray; false if it ends here.
bool PathTracer::scatter(Vertex& vertex, int bounce, RayCounters& counters) const {
  Path& path = vertex.path;
  path.result.radiance += path.throughput * vertex.direct;
  const bool is_last = bounce >= bounces_;
  if (is_last && path.sought == Sought::none) return false;
  const Vec3 u = path.sampler.next_triple();
  path.scattered = vertex.bsdf().sample(vertex.out, u.z, Vec2(u.x, u.y));
  if (path.scattered.pdf <= 0) return false;
  path.after_matte = path.after_matte || (!path.scattered.is_delta && path.scattered.pdf < k_matte_density);
  path.throughput *= path.scattered.weight, path.eta *= path.scattered.eta;
  path.cone = path.cone.scattered(vertex.hit.t, path.scattered.pdf, path.scattered.is_delta);
  path.ray = vertex.leave(path.scattered.direction, vertex.basis.world_from_local(path.scattered.direction));
  if (is_last) {
    path.result.radiance += path.throughput * found_at_last(path, counters);
    return false;
  }
  if (bounce >= k_roulette_from) {
    // While a path is in a medium its throughput has a factor 1 / eta^2, which it loses again: that says nothing of its worth.
    const Vec3 worth = path.throughput * (path.eta * path.eta);
    const float survival = std::min(0.95f, std::max({worth.x, worth.y, worth.z}));
    if (!(path.sampler.next_pair().x < survival)) return false;
    path.throughput /= survival;
  }
  ++counters.scatter;
  return true;
}

Vec3 PathTracer::background(const Vec3& direction) const {
  if (background_.kind == Background::Kind::transparent) return Vec3(0);
  if (background_.kind == Background::Kind::colour) return background_.colour.rgb;
  Vec3 sum(0);
  for (const Light& light : lights_)
    if (light.is_background()) sum += light.seen_along(Vec3(0), direction).radiance;
  return sum;
}

void PathTracer::add_direct_light(std::span<Vertex> vertices, int bounce, RayCounters& counters) const {
  for (const Light& light : lights_) {
    std::array<Ray, k_packet> rays;
    std::array<Vec3, k_packet> gains;
    std::array<Vertex*, k_packet> takers;
    size_t n = 0;
    for (Vertex& vertex : vertices) {
      const Vec2 u = light.is_delta() ? Vec2(0) : vertex.path.sampler.next_pair();
      if (vertex.bsdf().is_delta()) continue;
      const Arrival arrival = light.sample(vertex.hit.position, u);
      if (!(arrival.pdf > 0)) continue;
      const Vec3 in = vertex.basis.local_from_world(arrival.direction);
      const Vec3 scattered = vertex.bsdf().evaluate(vertex.out, in) * arrival.radiance;
      if (scattered == Vec3(0)) continue;
      const bool competes = vertex.path.seeks(light) && !arrival.is_delta;
      rays[n] = vertex.leave(in, arrival.direction), rays[n].t_far = arrival.distance, takers[n] = &vertex;
      gains[n++] = scattered * ((competes ? mis_weight(arrival.pdf, vertex.bsdf().pdf(vertex.out, in)) : 1.f) / arrival.pdf);
    }
    counters.shadow += n;
    // Rays that part at once, as those to an environment, take 1.7 times as long in packets as alone.
    const bool side_by_side = bounce == 0 && light.is_narrow();
    const uint32_t dark = shadowed(std::span<const Ray>(rays).first(n), side_by_side, counters.solve);
    for (size_t i = 0; i < n; ++i)
      if (!(dark >> i & 1)) takers[i]->direct += gains[i];
  }
}

/// Light that a path's ray finds on its way, which nothing hides as far as `reach`: what the camera sees of it, or what samples of
/// lights leave to a scattered ray.
Vec3 PathTracer::found(const Path& path, float reach, int bounce) const {
  Vec3 sum(0);
  if (bounce > 0 && path.sought == Sought::none) return sum;
  for (const Light& light : lights_) {
    if (bounce == 0 ? !light.is_visible() : !path.seeks(light) || (light.is_distant() && reach < k_infinitely_far)) continue;
    const Arrival arrival = light.seen_along(path.start, path.ray.direction);
    if (!(arrival.distance <= reach)) continue;
    sum += arrival.radiance * (bounce == 0 || path.scattered.is_delta ? 1.f : mis_weight(path.scattered.pdf, arrival.pdf));
  }
  return sum;
}

/// The same for a scattered ray that is not followed to what it meets.
Vec3 PathTracer::found_at_last(const Path& path, RayCounters& counters) const {
  Vec3 sum(0);
  Ray ray = path.ray;
  ray.t_far = 0; // as far as was looked
  bool is_hidden = false;
  for (const Light& light : lights_) {
    if (!path.seeks(light)) continue;
    const Arrival arrival = light.seen_along(ray.origin, ray.direction);
    if (arrival.radiance == Vec3(0)) continue;
    if (arrival.distance != ray.t_far) {
      ray.t_far = arrival.distance, is_hidden = tracer_.occluded(ray, counters.solve);
      ++counters.shadow;
    }
    if (!is_hidden) sum += arrival.radiance * (path.scattered.is_delta ? 1.f : mis_weight(path.scattered.pdf, arrival.pdf));
  }
  return sum;
}

} // namespace kelpie
