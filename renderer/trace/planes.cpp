#include "renderer/trace/planes.h"

#include "renderer/trace/exposure_states.h"

namespace kelpie {

Planes::Planes(const FrameScene& frame) {
  for (uint32_t i = 0; i < frame.shapes.size(); ++i) {
    const SampledShape& shape = frame.shapes[i];
    if (!shape.geometry || !std::holds_alternative<Plane<SampledMode>>(*shape.geometry)) continue;
    const auto plane = [&](const FrameScene& at) { return std::get<Plane<SampledMode>>(*at.shapes[i].geometry); };
    planes_.push_back({states_of(frame, 0, plane), i});
  }
}

bool Planes::meet(const Ray& ray, Hit& hit) const {
  bool found = false;
  for (const PlaneShape& shape : planes_) {
    Plane<SampledMode> plane = state_at(shape.states, ray.time);
    plane.normal = glm::normalize(plane.normal);
    const float across = glm::dot(ray.direction, plane.normal);
    const float t = glm::dot(plane.position - ray.origin, plane.normal) / across;
    if (!(t > ray.t_near && t < hit.t)) continue; // false for the NaN of a ray in the plane, too
    found = true;
    hit.t = t, hit.shape = shape.shape, hit.normal = plane.normal, hit.is_leaving = across > 0, hit.lift = Vec3(0);
    hit.slab = nullptr, hit.time = ray.time;
    hit.position = ray.origin + t * ray.direction;
    hit.position -= glm::dot(hit.position - plane.position, plane.normal) * plane.normal;
    hit.epsilon = 1e-5f + rounding_at(hit.position, t);
  }
  return found;
}

std::optional<Vec3> Planes::velocity(const Hit& hit) const {
  for (const PlaneShape& plane : planes_) {
    if (plane.shape != hit.shape) continue;
    // A plane is the field -dot(p - position, normal) about 0.
    constexpr float k_step = 0.5f / (k_states - 1);
    const auto height = [&](float at) {
      const Plane<SampledMode> p = state_at(plane.states, at);
      return glm::dot(hit.position - p.position, glm::normalize(p.normal));
    };
    const float before = std::max(hit.time - k_step, 0.f), after = std::min(hit.time + k_step, 1.f);
    return -(height(after) - height(before)) / (after - before) * hit.normal;
  }
  return {};
}

} // namespace kelpie
