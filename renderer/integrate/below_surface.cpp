// Light that wanders below a surface.
#include "renderer/integrate/vertex.h"

namespace kelpie {

/// Follows light below a surface to its `exit`, as it would be met from outside. False if it is lost: in the medium, or in another shape
/// that reaches into this one.
bool PathTracer::wander(Vertex& vertex, RayCounters& counters, Hit& exit) const {
  constexpr int k_most_steps = 2048;
  constexpr float k_resolved = 8; // ways are this many times as long as rays start off their surface
  constexpr float k_dim = 0.1f;   // from here on, walks are ended by chance
  Path& path = vertex.path;
  const Vec3 inward = OrthonormalBasis(vertex.true_normal).world_from_local(path.scattered.direction);
  SubsurfaceWalk walk(vertex.medium->no_denser_than(k_resolved * vertex.hit.epsilon), vertex.true_normal, inward);
  Ray ray = depart(path.ray, vertex.hit, inward, Side::far);
  Vec3 from = vertex.hit.position;
  for (int step = 0; step < k_most_steps; ++step) {
    const float distance = walk.next_distance(path.sampler.next_pair());
    ray.t_far = distance;
    ++counters.scatter;
    Hit hit;
    if (tracer_.intersect(ray, counters.solve, hit) && tracer_.pass_hidden(ray, counters.solve, hit)) {
      if (hit.shape != vertex.hit.shape || !hit.is_leaving) return false;
      walk.leave(glm::distance(from, hit.position));
      path.throughput *= path.scattered.weight * walk.throughput();
      exit = hit, exit.t = vertex.hit.t, exit.lift = Vec3(0), exit.is_leaving = false;
      ray.inside.remove(hit.shape);
      path.ray.inside = ray.inside, path.ray.direction = -exit.normal;
      path.after_matte = true, path.is_lit_through = path.is_counted = false;
      return path.throughput != Vec3(0);
    }
    const Vec3 u = path.sampler.next_triple();
    ray.origin = from += distance * walk.direction();
    walk.collide(distance, Vec2(u.x, u.y), u.z);
    ray.direction = walk.direction();
    const float left = largest(walk.throughput());
    if (left >= k_dim) continue;
    if (!(path.sampler.next() < left / k_dim)) return false;
    walk.strengthen(k_dim / left);
  }
  return false;
}

/// Where light comes out it is spread as by a white ground.
PathTracer::Vertex PathTracer::emerge(Path& path, const Hit& exit) const {
  static const SurfaceBsdf k_ground = [] {
    Matte<SampledMode> white;
    white.colour.rgb = Vec3(1);
    return SurfaceBsdf(white.surface());
  }();
  const Footprint footprint = path.cone.on_surface(path.ray.direction, exit.normal, exit.t);
  const Vec3 slope = surfaces_.is_bumpy(exit) ? surfaces_.relief_at(exit, footprint).slope : Vec3(0);
  Vertex vertex(path, exit, exit.normal, basis_at(path.ray, exit, exit.normal, {}, slope));
  vertex.is_bumped = vertex.basis.z != exit.normal, vertex.shared = &k_ground;
  path.sought = for_matte_;
  return vertex;
}

} // namespace kelpie
