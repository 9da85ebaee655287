#include "renderer/integrate/lights.h"

#include "renderer/integrate/bsdf.h"

namespace kelpie {

namespace {
constexpr float k_pi = 3.14159265358979f;
} // namespace

std::shared_ptr<const EnvironmentMap> EnvironmentCache::get(const EnvironmentLight<SampledMode>& light, Diagnostics& diagnostics) {
  auto& map = maps_[{light.file.resolved, light.preset}];
  if (!map)
    map = std::make_shared<const EnvironmentMap>(light.file.is_set() ? EnvironmentMap::load(light.file.resolved, diagnostics)
                                                                     : EnvironmentMap::make(light.preset));
  return map;
}

Light::Light(std::shared_ptr<const EnvironmentMap> map, const EnvironmentLight<SampledMode>& light)
    : map_(std::move(map)), strength_(light.strength), cos_(std::cos(glm::radians(light.rotation))),
      sin_(std::sin(glm::radians(light.rotation))) {}

Light::Light(const SunLight<SampledMode>& sun) : direction_(glm::normalize(sun.direction)) {
  const Vec3 irradiance = sun.colour.rgb * sun.strength;
  const float radius = glm::radians(sun.angle) / 2;
  radiance_ = irradiance;
  if (radius < 1e-4f) return; // a disc that float directions cannot resolve
  cos_radius_ = std::cos(radius);
  // Of the disc's radiance L, a facing surface gets L pi sin^2(radius); 1 - cos by the half angle, which cancels nothing.
  solid_angle_ = 4 * k_pi * std::pow(std::sin(radius / 2), 2.f);
  radiance_ = irradiance / (k_pi * std::pow(std::sin(radius), 2.f));
}

Arrival Light::sample(Vec2 u) const {
  if (map_) {
    const LightSample s = map_->sample(u);
    return {turn(s.direction, sin_), strength_ * s.radiance, s.pdf, false};
  }
  if (is_delta()) return {direction_, radiance_, 1, true};
  const float cosine = 1 - u.x * solid_angle_ / (2 * k_pi), sine = std::sqrt(std::max(0.f, 1 - cosine * cosine)), phi = 2 * k_pi * u.y;
  return {Frame(direction_).world_from_local({sine * std::cos(phi), sine * std::sin(phi), cosine}), radiance_, 1 / solid_angle_, false};
}

Arrival Light::seen_along(const Vec3& d) const {
  if (map_) {
    const Vec3 in_map = turn(d, -sin_);
    return {d, strength_ * map_->radiance(in_map), map_->pdf(in_map), false};
  }
  if (is_delta() || glm::dot(d, direction_) < cos_radius_) return {d, Vec3(0), 0, false};
  return {d, radiance_, 1 / solid_angle_, false};
}

std::vector<Light> make_lights(const FrameScene& frame, EnvironmentCache& cache, Diagnostics& diagnostics) {
  std::vector<Light> lights;
  for (const auto& light : frame.lights) {
    if (const auto* environment = std::get_if<EnvironmentLight<SampledMode>>(&light))
      lights.emplace_back(cache.get(*environment, diagnostics), *environment);
    else
      lights.emplace_back(std::get<SunLight<SampledMode>>(light));
  }
  return lights;
}

} // namespace kelpie
