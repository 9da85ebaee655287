// The lights of a frame, all of them infinitely far away: environments and suns.
#pragma once

#include <map>
#include <memory>
#include <span>

#include "base/error.h"
#include "renderer/light/environment_map.h"
#include "scene/scene.h"

namespace kelpie {

/// Maps that are read once and used in every frame.
class EnvironmentCache {
public:
  /// Throws Error when the file cannot be used; warnings (cleaned pixels) go to `diagnostics`.
  std::shared_ptr<const EnvironmentMap> get(const EnvironmentLight<SampledMode>&, Diagnostics& diagnostics);

private:
  std::map<std::pair<std::string, EnvironmentPreset>, std::shared_ptr<const EnvironmentMap>> maps_;
};

/// Light that arrives from one direction.
struct Arrival {
  Vec3 direction{0}; ///< towards the light, unit
  Vec3 radiance{0};  ///< irradiance across the direction, where `is_delta`
  float pdf = 0;     ///< of sampling the direction, per solid angle; 0: no sample
  bool is_delta = false;
};

/// One light: an environment map or a sun.
class Light {
public:
  Light(std::shared_ptr<const EnvironmentMap> map, const EnvironmentLight<SampledMode>&);
  explicit Light(const SunLight<SampledMode>&);

  Arrival sample(Vec2 u) const;
  /// What a ray that misses everything sees of this light, and how likely `sample` is to choose its direction.
  Arrival seen_along(const Vec3& direction) const;
  bool is_environment() const { return map_ != nullptr; }
  bool is_delta() const { return !map_ && cos_radius_ >= 1; }

private:
  /// From the map's frame by `sine`, into it by -`sine`: a turn about +y, from +z towards +x.
  Vec3 turn(const Vec3& v, float sine) const { return {cos_ * v.x + sine * v.z, v.y, cos_ * v.z - sine * v.x}; }

  std::shared_ptr<const EnvironmentMap> map_; ///< null: a sun
  float strength_ = 1, cos_ = 1, sin_ = 0;
  Vec3 direction_{0, 1, 0}, radiance_{0}; ///< of a sun
  float cos_radius_ = 1, solid_angle_ = 0;
};

std::vector<Light> make_lights(const FrameScene& frame, EnvironmentCache& cache, Diagnostics& diagnostics);

} // namespace kelpie
