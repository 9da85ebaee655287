#include "renderer/integrate/path.h"

#include <array>
#include <optional>

#include "renderer/integrate/vertex.h"
#include "renderer/integrate/wavelength.h"

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

/// Geometric specular antialiasing (Tokuyoshi and Kaplanyan 2019, "Improved Geometric Specular Antialiasing"): normals that differ within
/// a footprint widen the microfacets' alpha^2 by this part of the square of the difference, and at most by so much. A footprint is half a
/// pixel wide; each sample stands for normals that spread by a quarter of a pixel (standard deviation), half of what the pixel's filter
/// blurs: alpha^2 is twice that squared, for the mean of both sides.
constexpr float k_bend_share = 0.25f, k_most_bend = 0.18f;

/// By how much the normals of a field differ within a footprint: the square, from one side of it to the other, summed over both sides.
float spread_of_normals(const Tracer& tracer, const Hit& hit, const Footprint& footprint) {
  if (!hit.slab) return 0;
  const auto along = [&](const Vec3& v) {
    const Vec3 half = tracer.normal_near(hit, hit.position + 0.5f * v) - hit.normal;
    return 4 * glm::dot(half, half);
  };
  return along(footprint.u) + along(footprint.v);
}

} // namespace

PathTracer::PathTracer(const Tracer& tracer, const std::vector<Light>& lights, const FrameScene& frame)
    : tracer_(tracer), lights_(lights), background_(frame.film.background), surfaces_(frame, tracer), bounces_(frame.film.bounces),
      antialiases_(frame.film.specular_antialiasing), tints_shadows_(frame.film.tinted_shadows) {
  for (const Light& light : lights_) {
    if (light.is_even()) for_matte_ = Sought::even;
    if (!light.is_delta()) for_glossy_ = Sought::all;
    has_near_light_ |= !light.is_distant();
  }
}

void PathTracer::trace(std::span<Path> paths, RayCounters& counters) const {
  counters.camera += paths.size();
  std::array<Hit, k_packet> hits;
  std::array<Hit, k_packet> exits;
  std::vector<Vertex> vertices, emerged;
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
    going.clear(), emerged.clear();
    for (Vertex& vertex : vertices) {
      Hit& exit = exits[emerged.size()];
      const Onward onward = scatter(vertex, bounce, counters, exit);
      if (onward == Onward::goes) going.push_back(&vertex.path);
      if (onward == Onward::emerges) emerged.push_back(emerge(vertex.path, exit));
    }
    if (emerged.empty()) continue;
    add_direct_light(emerged, bounce, counters);
    for (Vertex& vertex : emerged) {
      Hit none; // a ground, below which is nothing
      if (scatter(vertex, bounce, counters, none) == Onward::goes) going.push_back(&vertex.path);
    }
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
  const Footprint footprint = path.cone.on_surface(path.ray.direction, normal, hit.t);
  std::optional<SurfaceParameters> memory;
  const SurfaceParameters& surface = surfaces_.at(hit, footprint, memory);
  if (has_near_light_) path.result.radiance += path.throughput * found(path, glm::distance(path.start, hit.position), bounce);
  path.throughput *= left_of_light(path.ray.inside, path.start, hit);
  const bool from_inside = hit.is_leaving && surface.transmission_weight > 0;
  if (!from_inside) path.result.radiance += path.throughput * (surface.emission_color.rgb * surface.emission_luminance);
  if (path.wavelength == 0 && is_dispersive(surface)) {
    const Monochrome light = monochrome(path.sampler.next_pair().x);
    path.wavelength = light.wavelength, path.throughput *= light.weight;
  }
  const Relief relief = surfaces_.is_bumpy(hit) ? surfaces_.relief_at(hit, footprint) : Relief{};
  Vertex vertex(path, hit, normal, basis_at(path.ray, hit, normal, surface, relief.slope));
  vertex.is_clear = surface.transmission_weight > 0, vertex.is_bumped = vertex.basis.z != normal;
  vertex.shared = path.ray.inside.is_empty() ? surfaces_.opaque_in_air(hit) : nullptr;
  if (!vertex.shared) vertex.own.emplace(surface, boundary_at(path.ray, hit, surface, path.wavelength));
  widen(vertex, footprint, relief.unseen);
  if (vertex.bsdf().lets_below() && !hit.is_leaving) vertex.medium.emplace(surface);
  if (bounce == 0) {
    path.result.is_hit = true, path.result.hit = hit, path.result.albedo = vertex.bsdf().albedo();
    if (vertex.is_bumped) path.result.hit.normal = hit.normal == normal ? vertex.basis.z : -vertex.basis.z;
  }
  // On a glossy surface samples of lights and scattered rays are both weighed, even on the last vertex: highlights are direct light. On a
  // matte one a scattered ray that finds light adds noise to what samples found (their density follows the radiance, so only the cosine
  // varies), unless the light is about as even as the cosine.
  path.sought = vertex.bsdf().is_glossy() ? for_glossy_ : for_matte_;
  return vertex;
}

/// Blurs a glossy surface by what the footprint does not show of it: bumps (the square of their slope), how it bends, and where light is
/// focused onto what was seen before.
void PathTracer::widen(Vertex& vertex, const Footprint& footprint, float unseen) const {
  const SurfaceBsdf& bsdf = vertex.bsdf();
  if (!bsdf.is_glossy()) return;
  float by = unseen;
  // What matte surfaces see is wide already. Polished glass stays polished: in it a path goes on by one ray, without samples of lights.
  if (antialiases_ && !vertex.path.after_matte && !(vertex.is_clear && bsdf.is_delta())) {
    const float differ2 = spread_of_normals(tracer_, vertex.hit, footprint);
    vertex.bend = std::sqrt(0.5f * differ2), by += std::min(k_bend_share * differ2, k_most_bend);
  }
  constexpr float k_least = 1e-8f; // makes no difference
  if (by > k_least) vertex.own = bsdf.widened(by);
  if (vertex.path.after_matte) vertex.own = vertex.bsdf().at_least_as_rough_as(k_alpha_after_matte);
}

/// What a shape that a ray is in is made of, about a hit of that ray.
const SurfaceParameters& PathTracer::medium_at(uint32_t shape, const Hit& hit, std::optional<SurfaceParameters>& memory) const {
  Hit there = hit;
  if (shape != hit.shape) there.shape = shape, there.slab = nullptr; // of its field nothing is known here
  return surfaces_.at(there, {}, memory);
}

/// The media on both sides of a surface. Nested dielectrics: what fills a place is what has the highest priority there.
Boundary PathTracer::boundary_at(const Ray& arrived, const Hit& hit, const SurfaceParameters& surface, float wavelength) const {
  if (surface.transmission_weight == 0 && arrived.inside.is_empty()) return {1, surface.specular_ior, false};
  ShapeSet beyond = arrived.inside;
  if (hit.is_leaving)
    beyond.remove(hit.shape);
  else
    beyond.add(hit.shape);
  const auto ior_in = [&](const ShapeSet& shapes) {
    const std::optional<uint32_t> filling = tracer_.media().filling(shapes);
    if (!filling) return 1.f;
    if (*filling == hit.shape) return ior_at(surface, wavelength);
    std::optional<SurfaceParameters> memory;
    return ior_at(medium_at(*filling, hit, memory), wavelength);
  };
  return {ior_in(arrived.inside), ior_in(beyond), hit.is_leaving && surface.transmission_weight > 0};
}

/// Of the light along a ray in some shapes up to a hit, what the medium there leaves (Beer and Lambert).
Vec3 PathTracer::left_of_light(const ShapeSet& inside, const Vec3& start, const Hit& hit) const {
  const std::optional<uint32_t> filling = tracer_.media().filling(inside);
  if (!filling) return Vec3(1);
  std::optional<SurfaceParameters> memory;
  const SurfaceParameters& medium = medium_at(*filling, hit, memory);
  if (medium.transmission_weight == 0 || medium.transmission_depth == 0) return Vec3(1);
  return glm::pow(glm::max(medium.transmission_color.rgb, Vec3(1e-6f)),
                  Vec3(glm::distance(start, hit.position) / medium.transmission_depth));
}

/// Of light that a shadow ray looks for, what clear shapes in its way leave if they do not bend it. Both faces of a plate reflect alike
/// then: as seen from the thinner medium.
Vec3 PathTracer::let_through(Ray ray, RayCounters& counters) const {
  constexpr int k_most = 64; // faces
  Vec3 left(1);
  for (int i = 0; i < k_most; ++i) {
    const Vec3 start = ray.origin;
    Hit hit;
    ++counters.shadow;
    if (!tracer_.intersect(ray, counters.solve, hit) || !tracer_.pass_hidden(ray, counters.solve, hit)) return left;
    std::optional<SurfaceParameters> memory;
    const SurfaceParameters& surface = surfaces_.at(hit, {}, memory);
    Boundary boundary = boundary_at(ray, hit, surface, 0);
    if (boundary.ior_near > boundary.ior_far) std::swap(boundary.ior_near, boundary.ior_far);
    boundary.from_inside = false;
    left *= left_of_light(ray.inside, start, hit);
    left *= SurfaceBsdf(surface, boundary).passing(std::min(1.f, std::abs(glm::dot(ray.direction, hit.normal))));
    if (left == Vec3(0)) return left;
    const float rest = ray.t_far - hit.t;
    ray = depart(ray, hit, ray.direction, Side::far), ray.t_far = rest;
  }
  return Vec3(0);
}

/// The path's ray met nothing.
void PathTracer::escape(Path& path, int bounce) const {
  if (bounce == 0) path.result.radiance = background(path.ray.direction);
  path.result.radiance += path.throughput * found(path, k_infinitely_far, bounce);
}

/// Gives a path its next ray, or an `exit`.
PathTracer::Onward PathTracer::scatter(Vertex& vertex, int bounce, RayCounters& counters, Hit& exit) const {
  Path& path = vertex.path;
  path.result.radiance += path.throughput * vertex.direct;
  const bool is_last = bounce >= bounces_;
  if (is_last && path.sought == Sought::none && !vertex.medium) return Onward::ends;
  const Vec3 u = path.sampler.next_triple();
  path.scattered = vertex.bsdf().sample(vertex.out, u.z, Vec2(u.x, u.y));
  if (path.scattered.pdf <= 0) return Onward::ends;
  if (path.scattered.goes_below) return vertex.medium && wander(vertex, counters, exit) ? Onward::emerges : Onward::ends;
  if (is_last && path.sought == Sought::none) return Onward::ends;
  const bool is_wide = !path.scattered.is_delta && path.scattered.pdf < k_matte_density;
  path.after_matte |= is_wide;
  path.is_counted = vertex.is_counted(path.scattered.direction);
  path.is_lit_through = tints_shadows_ && is_wide && !path.is_counted;
  const Vec3 direction = vertex.basis.world_from_local(path.scattered.direction);
  path.throughput *= path.scattered.weight * vertex.past_bumps(path.scattered.direction, direction), path.eta *= path.scattered.eta;
  if (path.throughput == Vec3(0)) return Onward::ends;
  path.cone = path.cone.scattered(vertex.hit.t, path.scattered.pdf, path.scattered.is_delta, vertex.bend);
  path.ray = vertex.leave(path.scattered.direction, direction);
  if (is_last) {
    path.result.radiance += path.throughput * found_at_last(path, counters);
    return Onward::ends;
  }
  if (bounce >= k_roulette_from) {
    // While a path is in a medium its throughput has a factor 1 / eta^2, which it loses again: that says nothing of its worth.
    const Vec3 worth = path.throughput * (path.eta * path.eta);
    const float survival = std::min(0.95f, std::max({worth.x, worth.y, worth.z}));
    if (!(path.sampler.next_pair().x < survival)) return Onward::ends;
    path.throughput /= survival;
  }
  ++counters.scatter;
  return Onward::goes;
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
    std::array<Vec3, k_packet> gains, gains_behind_clear;
    std::array<Vertex*, k_packet> takers;
    size_t n = 0;
    for (Vertex& vertex : vertices) {
      const Vec2 u = light.is_delta() ? Vec2(0) : vertex.path.sampler.next_pair();
      if (vertex.bsdf().is_delta()) continue;
      const Arrival arrival = light.sample(vertex.hit.position, u);
      if (!(arrival.pdf > 0)) continue;
      const Vec3 in = vertex.basis.local_from_world(arrival.direction);
      if (vertex.is_counted(in)) continue;
      const Vec3 scattered = vertex.bsdf().evaluate(vertex.out, in) * arrival.radiance * vertex.past_bumps(in, arrival.direction);
      if (scattered == Vec3(0)) continue;
      const bool competes = vertex.path.seeks(light) && !arrival.is_delta;
      const float pdf = competes || tints_shadows_ ? vertex.bsdf().pdf(vertex.out, in) : 0;
      rays[n] = vertex.leave(in, arrival.direction), rays[n].t_far = arrival.distance, takers[n] = &vertex;
      gains_behind_clear[n] = pdf < k_matte_density ? scattered / arrival.pdf : Vec3(0);
      gains[n++] = scattered * ((competes ? mis_weight(arrival.pdf, pdf) : 1.f) / arrival.pdf);
    }
    counters.shadow += n;
    // Rays that part at once, as those to an environment, take 1.7 times as long in packets as alone.
    const bool side_by_side = bounce == 0 && light.is_narrow();
    const uint32_t dark = shadowed(std::span<const Ray>(rays).first(n), side_by_side, counters.solve);
    for (size_t i = 0; i < n; ++i) {
      if (!(dark >> i & 1))
        takers[i]->direct += gains[i];
      else if (tints_shadows_ && gains_behind_clear[i] != Vec3(0))
        takers[i]->direct += gains_behind_clear[i] * let_through(rays[i], counters);
    }
  }
}

/// Light that a path's ray finds on its way, which nothing hides as far as `reach`: what the camera sees of it, or what samples of
/// lights leave to a scattered ray.
Vec3 PathTracer::found(const Path& path, float reach, int bounce) const {
  Vec3 sum(0);
  if (bounce > 0 && (path.sought == Sought::none || path.is_counted)) return sum;
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
  if (path.is_counted) return sum;
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
