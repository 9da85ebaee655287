#include "renderer/integrate/path.h"

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
/// From here on, dim paths are ended by chance.
constexpr int k_roulette_from = 4;

} // namespace

/// A point of a path, with the side of the surface that the path is on.
struct PathTracer::Vertex {
  Vertex(const Hit& h, const Vec3& direction, const Bsdf& b, int inside_before)
      : hit(h), is_back(glm::dot(h.normal, direction) > 0), frame(is_back ? -h.normal : h.normal), out(frame.local_from_world(-direction)),
        bsdf(b), inside(inside_before) {}

  /// A ray that leaves the vertex on the side on which the path came.
  Ray leave(const Vec3& direction) const {
    Ray ray;
    ray.origin = hit.position + hit.epsilon * frame.z;
    ray.direction = direction;
    ray.inside = inside;
    return ray;
  }

  const Hit& hit;
  bool is_back;
  Frame frame;
  Vec3 out; ///< towards the viewer, local
  Bsdf bsdf;
  int inside;
};

PathTracer::PathTracer(const Tracer& tracer, const std::vector<Light>& lights, const FrameScene& frame)
    : tracer_(tracer), lights_(lights), background_(frame.film.background), bounces_(frame.film.bounces) {
  for (const SampledShape& shape : frame.shapes) bsdfs_.emplace_back(shape.surface);
  for (const Light& light : lights_) has_extended_light_ |= !light.is_delta();
}

PathResult PathTracer::trace(Ray ray, Sampler& sampler, RayCounters& counters) const {
  PathResult result;
  Vec3 throughput(1);
  BsdfSample scattered;
  bool seeks_light = false; // whether the scattered ray's light counts
  bool after_matte = false;
  ++counters.camera;
  for (int bounce = 0;; ++bounce) {
    Hit hit;
    if (!tracer_.intersect(ray, counters.solve, hit)) {
      if (bounce == 0) result.radiance = background(ray.direction);
      if (seeks_light) result.radiance += throughput * escaped(ray.direction, scattered);
      return result;
    }
    const Bsdf& surface = bsdfs_[hit.shape];
    const Vertex vertex(hit, ray.direction, after_matte ? surface.at_least_as_rough_as(k_alpha_after_matte) : surface, ray.inside);
    after_matte = after_matte || !surface.is_glossy();
    if (bounce == 0) result.is_hit = true, result.hit = hit, result.albedo = vertex.bsdf.albedo();

    // On a matte surface the samples of lights alone are the best estimate of direct light (their density
    // follows the radiance, so only the cosine varies): a scattered ray that finds light adds noise. On a
    // glossy one both are weighed, even on the last vertex: highlights are direct light.
    const bool is_last = bounce >= bounces_;
    seeks_light = vertex.bsdf.is_glossy() && has_extended_light_;
    result.radiance += throughput * direct_light(vertex, seeks_light, sampler, counters);
    if (is_last && !seeks_light) return result;

    scattered = vertex.bsdf.sample(vertex.out, sampler.next_pair());
    if (scattered.pdf <= 0) return result;
    throughput *= scattered.weight;
    ray = vertex.leave(vertex.frame.world_from_local(scattered.direction));
    if (is_last) {
      ++counters.shadow;
      if (!tracer_.occluded(ray, counters.solve)) result.radiance += throughput * escaped(ray.direction, scattered);
      return result;
    }
    if (bounce >= k_roulette_from) {
      const float survival = std::min(0.95f, std::max({throughput.x, throughput.y, throughput.z}));
      if (!(sampler.next_pair().x < survival)) return result;
      throughput /= survival;
    }
    ++counters.scatter;
  }
}

Vec3 PathTracer::background(const Vec3& direction) const {
  if (background_.kind == Background::Kind::transparent) return Vec3(0);
  if (background_.kind == Background::Kind::colour) return background_.colour.rgb;
  Vec3 sum(0);
  for (const Light& light : lights_)
    if (light.is_environment()) sum += light.seen_along(direction).radiance;
  return sum;
}

Vec3 PathTracer::direct_light(const Vertex& vertex, bool competes, Sampler& sampler, RayCounters& counters) const {
  Vec3 sum(0);
  for (const Light& light : lights_) {
    const Vec2 u = light.is_delta() ? Vec2(0) : sampler.next_pair();
    if (vertex.bsdf.is_delta()) continue;
    const Arrival arrival = light.sample(u);
    if (!(arrival.pdf > 0)) continue;
    const Vec3 in = vertex.frame.local_from_world(arrival.direction);
    const Vec3 reflected = vertex.bsdf.evaluate(vertex.out, in) * arrival.radiance;
    if (reflected == Vec3(0)) continue;
    ++counters.shadow;
    if (tracer_.occluded(vertex.leave(arrival.direction), counters.solve)) continue;
    sum += reflected * ((competes && !arrival.is_delta ? mis_weight(arrival.pdf, vertex.bsdf.pdf(vertex.out, in)) : 1.f) / arrival.pdf);
  }
  return sum;
}

/// Light found by a scattered ray that met nothing.
Vec3 PathTracer::escaped(const Vec3& direction, const BsdfSample& scattered) const {
  Vec3 sum(0);
  for (const Light& light : lights_) {
    const Arrival arrival = light.seen_along(direction);
    sum += arrival.radiance * (scattered.is_delta ? 1.f : mis_weight(scattered.pdf, arrival.pdf));
  }
  return sum;
}

} // namespace kelpie
