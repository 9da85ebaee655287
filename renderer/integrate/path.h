// Path tracing with multiple importance sampling.
#pragma once

#include <span>

#include "renderer/integrate/lights.h"
#include "renderer/integrate/ray_cone.h"
#include "renderer/integrate/sampler.h"
#include "renderer/integrate/surfaces.h"
#include "renderer/trace/tracer.h"

namespace kelpie {

struct RayCounters {
  uint64_t camera = 0, shadow = 0, scatter = 0;
  SolveCounters solve;

  void add(const RayCounters& other) {
    camera += other.camera, shadow += other.shadow, scatter += other.scatter;
    solve += other.solve;
  }
};

/// What one camera ray found.
struct PathResult {
  Vec3 radiance{0};
  bool is_hit = false; ///< the camera ray met a surface
  Hit hit;             ///< where
  Vec3 albedo{0};
};

/// Which lights count where a scattered ray finds them; of all others only samples do.
enum class Sought { none, even, all };

/// A path on its way; at first a camera ray.
struct Path {
  Path(const Ray& camera_ray, const Sampler& s, const RayCone& c) : ray(camera_ray), cone(c), sampler(s) {}

  Ray ray;                 ///< to its next vertex
  Vec3 start = ray.origin; ///< of the ray, before it passed what cannot be seen
  RayCone cone;            ///< around it
  Sampler sampler;
  Vec3 throughput{1};           ///< radiance at the camera, of a unit of radiance along `ray`
  float eta = 1;                ///< refractive index around `ray` over that around the camera
  BsdfSample scattered;         ///< how `ray` left the last vertex
  Sought sought = Sought::none; ///< what counts of the light that `ray` finds
  bool after_matte = false;     ///< whether a vertex was matte, or as good as that
  float wavelength = 0;         ///< in nanometres, once it has met what parts colours; 0: all
  /// Where shadows are tinted: samples of lights at the last vertex counted what comes straight through clear shapes in the ray's
  /// direction.
  bool is_lit_through = false;
  /// Since such a vertex the path went through clear shapes only, or to and fro in one: the light that it finds was counted there.
  bool is_counted = false;
  PathResult result;

  bool seeks(const Light& light) const { return sought == Sought::all || (sought == Sought::even && light.is_even()); }
};

/// All that a path needs; constant during a frame.
class PathTracer {
public:
  PathTracer(const Tracer& tracer, const std::vector<Light>& lights, const FrameScene& frame);

  /// Follows up to k_packet camera rays to their ends. They go in step, so that rays that run side by side are
  /// traced as packets; no path's result depends on the others.
  void trace(std::span<Path> paths, RayCounters& counters) const;

private:
  struct Vertex;
  /// What becomes of a path at a vertex: it ends, has a next ray, or comes out of what it wandered through, elsewhere.
  enum class Onward { ends, goes, emerges };

  uint32_t meet(std::span<Path* const> paths, bool side_by_side, SolveCounters& counters, Hit* hits) const;
  uint32_t shadowed(std::span<const Ray> rays, bool side_by_side, SolveCounters& counters) const;
  Vertex arrive(Path& path, const Hit& hit, int bounce) const;
  const SurfaceParameters& medium_at(uint32_t shape, const Hit& hit, std::optional<SurfaceParameters>& memory) const;
  Boundary boundary_at(const Ray& arrived, const Hit& hit, const SurfaceParameters& surface, float wavelength) const;
  void widen(Vertex& vertex, const Footprint& footprint, float unseen) const;
  Vec3 left_of_light(const ShapeSet& inside, const Vec3& start, const Hit& hit) const;
  Vec3 let_through(Ray ray, RayCounters& counters) const;
  void escape(Path& path, int bounce) const;
  void add_direct_light(std::span<Vertex> vertices, int bounce, RayCounters& counters) const;
  Onward scatter(Vertex& vertex, int bounce, RayCounters& counters, Hit& exit) const;
  bool wander(Vertex& vertex, RayCounters& counters, Hit& exit) const;
  Vertex emerge(Path& path, const Hit& exit) const;

  Vec3 background(const Vec3& direction) const;
  Vec3 found(const Path&, float reach, int bounce) const;
  Vec3 found_at_last(const Path&, RayCounters& counters) const;

  const Tracer& tracer_;
  const std::vector<Light>& lights_;
  const Background& background_;
  Surfaces surfaces_;
  int bounces_;
  bool antialiases_, tints_shadows_;
  Sought for_matte_ = Sought::none, for_glossy_ = Sought::none; ///< what scattered rays can find
  bool has_near_light_ = false;                                 ///< one that may lie before what a ray meets
};

} // namespace kelpie
