#include "renderer/integrate/near_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/orthonormal_basis.h"

namespace kelpie {

namespace {

/// From one point to another; down, where they are the same.
Vec3 direction_to(const Vec3& to, const Vec3& from) { return to == from ? Vec3(0, -1, 0) : glm::normalize(to - from); }

/// Where a ray meets a plane in front of it; infinity if it does not, or from behind.
float distance_to_plane(const Vec3& p, const Vec3& direction, const Vec3& on_plane, const Vec3& normal) {
  const float facing = -glm::dot(direction, normal), height = glm::dot(p - on_plane, normal);
  return facing > 0 && height > 0 ? height / facing : k_infinitely_far;
}

} // namespace

/// The rectangle as it is seen from a point: the coordinates of its edges, and the solid angle that it fills. In doubles, because
/// that is a small difference of large angles.
struct RectangleEmitter::View {
  double x0, x1, y0, y1, z; ///< z: the distance of its plane, below 0
  double b0, b1, k, solid_angle;

  View(const RectangleEmitter& r, const Vec3& p) {
    const Vec3d d(r.middle_ - p);
    const double x = glm::dot(d, Vec3d(r.x_)), y = glm::dot(d, Vec3d(r.y_));
    x0 = x - r.width_ / 2, x1 = x + r.width_ / 2, y0 = y - r.height_ / 2, y1 = y + r.height_ / 2;
    z = -std::abs(glm::dot(d, Vec3d(r.normal_)));
    // The normals of the planes through p and an edge, and the angles between these (their appendix).
    const Vec3d n0 = glm::normalize(Vec3d(0, z, -y0)), n1 = glm::normalize(Vec3d(-z, 0, x1));
    const Vec3d n2 = glm::normalize(Vec3d(0, -z, y1)), n3 = glm::normalize(Vec3d(z, 0, -x0));
    const auto angle = [](const Vec3d& a, const Vec3d& b) { return std::acos(std::clamp(-glm::dot(a, b), -1.0, 1.0)); };
    b0 = n0.z, b1 = n2.z, k = 2 * std::numbers::pi - angle(n2, n3) - angle(n3, n0);
    solid_angle = angle(n0, n1) + angle(n1, n2) - k;
  }

  /// Where on the rectangle a point of the unit square lies.
  Vec2d at(Vec2 u) const {
    const double along = u.x * solid_angle + k, f = (std::cos(along) * b0 - b1) / std::sin(along);
    const double c = std::clamp(std::copysign(1 / std::sqrt(f * f + b0 * b0), f), -1.0, 1.0);
    const double x = std::clamp(-c * z / std::sqrt(std::max(1e-300, 1 - c * c)), x0, x1);
    const double d = std::sqrt(x * x + z * z), h0 = y0 / std::hypot(d, y0), h1 = y1 / std::hypot(d, y1), h = h0 + u.y * (h1 - h0);
    return {x, std::clamp(h * d / std::sqrt(std::max(1e-300, 1 - h * h)), y0, y1)};
  }
};

RectangleEmitter::RectangleEmitter(const RectangleLight<SampledMode>& light)
    : NearEmitter(light, light.width * light.height), middle_(light.position), normal_(direction_to(light.target, light.position)),
      width_(light.width), height_(light.height) {
  const Vec3 across = glm::cross(light.up, normal_);
  x_ = glm::length(across) > 1e-6f * glm::length(light.up) ? glm::normalize(across) : OrthonormalBasis(normal_).x;
  y_ = glm::cross(normal_, x_);
}

Arrival RectangleEmitter::sample(const Vec3& p, Vec2 u) const {
  if (glm::dot(p - middle_, normal_) <= 0) return {};
  const View view(*this, p);
  if (!(view.solid_angle > 0)) return {};
  const Vec2d at = view.at(u);
  const Vec3 way(Vec3d(x_) * at.x + Vec3d(y_) * at.y + Vec3d(normal_) * view.z);
  const float distance = glm::length(way);
  return {way / distance, radiance_, float(1 / view.solid_angle), false, distance};
}

Arrival RectangleEmitter::seen_along(const Vec3& p, const Vec3& direction) const {
  const float distance = distance_to_plane(p, direction, middle_, normal_);
  if (distance == k_infinitely_far) return {direction, Vec3(0), 0, false};
  const Vec3 at = p + distance * direction - middle_;
  if (std::abs(glm::dot(at, x_)) > width_ / 2 || std::abs(glm::dot(at, y_)) > height_ / 2) return {direction, Vec3(0), 0, false};
  const double solid_angle = View(*this, p).solid_angle;
  return {direction, radiance_, solid_angle > 0 ? float(1 / solid_angle) : 0, false, distance};
}

DiscEmitter::DiscEmitter(const DiscLight<SampledMode>& light)
    : NearEmitter(light, std::numbers::pi_v<float> * light.radius * light.radius), middle_(light.position),
      normal_(direction_to(light.target, light.position)), radius_(light.radius) {}

/// Light from the disc's front; the density of area is 1 / (pi radius^2).
Arrival DiscEmitter::arrive(const Vec3& direction, float distance) const {
  const float facing = -glm::dot(direction, normal_);
  if (facing <= 0) return {direction, Vec3(0), 0, false};
  return {direction, radiance_, distance * distance / (facing * std::numbers::pi_v<float> * radius_ * radius_), false, distance};
}

Arrival DiscEmitter::sample(const Vec3& p, Vec2 u) const {
  const float r = radius_ * std::sqrt(u.x), phi = 2 * std::numbers::pi_v<float> * u.y;
  const Vec3 way = middle_ + OrthonormalBasis(normal_).world_from_local({r * std::cos(phi), r * std::sin(phi), 0}) - p;
  const float distance = glm::length(way);
  return distance > 0 ? arrive(way / distance, distance) : Arrival{};
}

Arrival DiscEmitter::seen_along(const Vec3& p, const Vec3& direction) const {
  const float distance = distance_to_plane(p, direction, middle_, normal_);
  if (distance == k_infinitely_far || glm::distance(p + distance * direction, middle_) > radius_) return {direction, Vec3(0), 0, false};
  return arrive(direction, distance);
}

SphereEmitter::SphereEmitter(const SphereLight<SampledMode>& light)
    : NearEmitter(light, std::numbers::pi_v<float> * light.radius * light.radius), middle_(light.position), radius_(light.radius) {}

Arrival SphereEmitter::sample(const Vec3& p, Vec2 u) const {
  const Vec3 to_middle = middle_ - p;
  const float d = glm::length(to_middle);
  if (d <= radius_) return {};
  const float sine = radius_ / d, sine2 = sine * sine, cap = sine2 / (1 + std::sqrt(1 - sine2)); // 1 - the cosine of the cone
  const float below = u.x * cap, cosine = 1 - below, phi = 2 * std::numbers::pi_v<float> * u.y, away2 = below * (2 - below); // away: a sine
  const Vec3 local(std::sqrt(away2) * std::cos(phi), std::sqrt(away2) * std::sin(phi), cosine);
  const float distance = d * cosine - std::sqrt(std::max(0.f, radius_ * radius_ - d * d * away2));
  return {OrthonormalBasis(to_middle / d).world_from_local(local), radiance_, 1 / (2 * std::numbers::pi_v<float> * cap), false, distance};
}

Arrival SphereEmitter::seen_along(const Vec3& p, const Vec3& direction) const {
  const Vec3 to_middle = middle_ - p;
  const float d = glm::length(to_middle), along = glm::dot(to_middle, direction);
  const float passes = glm::length(to_middle - along * direction);
  if (d <= radius_ || along <= 0 || passes > radius_) return {direction, Vec3(0), 0, false};
  const float sine = radius_ / d, sine2 = sine * sine, cap = sine2 / (1 + std::sqrt(1 - sine2));
  const float distance = along - std::sqrt((radius_ - passes) * (radius_ + passes));
  return {direction, radiance_, 1 / (2 * std::numbers::pi_v<float> * cap), false, distance};
}

Arrival PointEmitter::sample(const Vec3& p, Vec2) const {
  const Vec3 way = position_ - p;
  const float distance = glm::length(way);
  if (distance == 0) return {};
  return {way / distance, intensity_ / (distance * distance), 1, true, distance};
}

} // namespace kelpie
