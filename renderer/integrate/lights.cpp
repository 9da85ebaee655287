#include "renderer/integrate/lights.h"

#include <cmath>
#include <numbers>

#include "base/orthonormal_basis.h"

namespace kelpie {

namespace {} // namespace

std::shared_ptr<const EnvironmentMap> EnvironmentCache::get(const EnvironmentLight<SampledMode>& light, Diagnostics& diagnostics) {
  auto& map = maps_[{light.file.resolved, light.preset}];
  if (!map)
    map = std::make_shared<const EnvironmentMap>(light.file.is_set() ? EnvironmentMap::load(light.file.resolved, diagnostics)
                                                                     : EnvironmentMap::make(light.preset));
  return map;
}

EnvironmentEmitter::EnvironmentEmitter(std::shared_ptr<const EnvironmentMap> map, const EnvironmentLight<SampledMode>& light)
    : map_(std::move(map)), strength_(light.strength), cos_(std::cos(glm::radians(light.rotation))),
      sin_(std::sin(glm::radians(light.rotation))) {}

Arrival EnvironmentEmitter::sample(const Vec3&, Vec2 u) const {
  const LightSample s = map_->sample(u);
  return {turn(s.direction, sin_), strength_ * s.radiance, s.pdf, false};
}

Arrival EnvironmentEmitter::seen_along(const Vec3&, const Vec3& d) const {
  const Vec3 in_map = turn(d, -sin_);
  return {d, strength_ * map_->radiance(in_map), map_->pdf(in_map), false};
}

// Where a half of the sphere shines alike it is 0.5. The presets: white 1, sky 0.68, studio 0.15, which samples of lights serve better.
bool EnvironmentEmitter::is_even() const { return map_->evenness() > 0.25f; }

SunEmitter::SunEmitter(const SunLight<SampledMode>& sun) : direction_(glm::normalize(sun.direction)) {
  const Vec3 irradiance = sun.colour.rgb * sun.strength;
  const float radius = glm::radians(sun.angle) / 2;
  radiance_ = irradiance, cos_radius_ = std::cos(radius);
  if (cos_radius_ >= 1) return; // a disc that float directions cannot resolve
  // Of the disc's radiance L, a facing surface gets L pi sin^2(radius); 1 - cos by the half angle, which cancels nothing.
  solid_angle_ = 4 * std::numbers::pi_v<float> * std::pow(std::sin(radius / 2), 2.f);
  radiance_ = irradiance / (std::numbers::pi_v<float> * std::pow(std::sin(radius), 2.f));
}

Arrival SunEmitter::sample(const Vec3&, Vec2 u) const {
  if (is_delta()) return {direction_, radiance_, 1, true};
  const float cosine = 1 - u.x * solid_angle_ / (2 * std::numbers::pi_v<float>), sine = std::sqrt(std::max(0.f, 1 - cosine * cosine)),
              phi = 2 * std::numbers::pi_v<float> * u.y;
  const Vec3 local(sine * std::cos(phi), sine * std::sin(phi), cosine);
  return {OrthonormalBasis(direction_).world_from_local(local), radiance_, 1 / solid_angle_, false};
}

Arrival SunEmitter::seen_along(const Vec3&, const Vec3& d) const {
  if (is_delta() || glm::dot(d, direction_) < cos_radius_) return {d, Vec3(0), 0, false};
  return {d, radiance_, 1 / solid_angle_, false};
}

EnvironmentEmitter make_emitter(const EnvironmentLight<SampledMode>& light, EnvironmentCache& cache, Diagnostics& diagnostics) {
  return {cache.get(light, diagnostics), light};
}

SunEmitter make_emitter(const SunLight<SampledMode>& sun, EnvironmentCache&, Diagnostics&) { return SunEmitter(sun); }

RectangleEmitter make_emitter(const RectangleLight<SampledMode>& light, EnvironmentCache&, Diagnostics&) { return RectangleEmitter(light); }

DiscEmitter make_emitter(const DiscLight<SampledMode>& light, EnvironmentCache&, Diagnostics&) { return DiscEmitter(light); }

SphereEmitter make_emitter(const SphereLight<SampledMode>& light, EnvironmentCache&, Diagnostics&) { return SphereEmitter(light); }

PointEmitter make_emitter(const PointLight<SampledMode>& light, EnvironmentCache&, Diagnostics&) { return PointEmitter(light); }

std::vector<Light> make_lights(const FrameScene& frame, EnvironmentCache& cache, Diagnostics& diagnostics) {
  std::vector<Light> lights;
  for (const auto& light : frame.lights)
    lights.push_back(std::visit([&](const auto& kind) { return Light(make_emitter(kind, cache, diagnostics)); }, light));
  return lights;
}

} // namespace kelpie
