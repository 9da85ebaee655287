// Path tracing with multiple importance sampling.
#pragma once

#include "renderer/integrate/bsdf.h"
#include "renderer/integrate/lights.h"
#include "renderer/integrate/sampler.h"
#include "renderer/trace/tracer.h"

namespace kelpie {

struct RayCounters {
  uint64_t camera = 0, shadow = 0, scatter = 0;
  SolveCounters solve;

  void add(const RayCounters& other) {
    camera += other.camera, shadow += other.shadow, scatter += other.scatter;
    solve.cells += other.solve.cells, solve.evaluations += other.solve.evaluations;
  }
};

/// What one camera ray found.
struct PathResult {
  Vec3 radiance{0};
  bool is_hit = false; ///< the camera ray met a surface
  Hit hit;             ///< where
  Vec3 albedo{0};
};

/// All that a path needs; constant during a frame.
class PathTracer {
public:
  PathTracer(const Tracer& tracer, const std::vector<Light>& lights, const FrameScene& frame);

  /// Follows a camera ray.
  PathResult trace(Ray ray, Sampler& sampler, RayCounters& counters) const;

private:
  struct Vertex;

  Vec3 background(const Vec3& direction) const;
  Vec3 direct_light(const Vertex& vertex, bool competes, Sampler& sampler, RayCounters& counters) const;
  Vec3 escaped(const Vec3& direction, const BsdfSample& scattered) const;

  const Tracer& tracer_;
  const std::vector<Light>& lights_;
  const Background& background_;
  std::vector<Bsdf> bsdfs_; ///< by shape
  int bounces_;
  bool has_extended_light_ = false; ///< one that a scattered ray can find
};

} // namespace kelpie
