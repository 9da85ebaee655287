// Rays from the camera through the film.
#pragma once

#include "renderer/integrate/ray_cone.h"
#include "renderer/trace/exposure_states.h"
#include "renderer/trace/solve.h"

namespace kelpie {

/// A thin lens looking along `forward`.
class CameraRays {
public:
  CameraRays(const Camera<SampledMode>& camera, Vec2i resolution)
      : position_(camera.position), forward_(glm::normalize(camera.look_at - camera.position)),
        right_(glm::normalize(glm::cross(forward_, camera.up))), up_(glm::cross(right_, forward_)),
        pixel_(2 * std::tan(glm::radians(camera.fov) / 2) / static_cast<float>(resolution.y)), middle_(Vec2(resolution) * 0.5f),
        lens_radius_(camera.aperture / 2), focus_(camera.focus) {}

  /// The ray through a point of the film, in pixels from the top left (the first pixel's centre is 0.5, 0.5).
  /// `lens`: an even point of the unit square, used where the lens has an aperture.
  Ray through(Vec2 film, Vec2 lens) const {
    const Vec3 direction = forward_ + right_ * ((film.x - middle_.x) * pixel_) + up_ * ((middle_.y - film.y) * pixel_);
    Ray ray;
    ray.origin = position_;
    ray.direction = glm::normalize(direction);
    if (lens_radius_ > 0) {
      const float r = lens_radius_ * std::sqrt(lens.x), phi = 6.2831853f * lens.y;
      const Vec3 shift = right_ * (r * std::cos(phi)) + up_ * (r * std::sin(phi));
      ray.origin = position_ + shift;
      ray.direction = glm::normalize(focus_ * direction - shift);
    }
    return ray;
  }

  /// Around each of so many rays through a pixel: what it stands for. Half a pixel at least, as the pixel's filter is wider than that.
  RayCone cone(int spp) const { return {0, pixel_ * std::max(0.5f, 1 / std::sqrt(static_cast<float>(spp)))}; }

  /// Where the film sees a point that lies in front of the camera, in pixels.
  Vec2 film_of(const Vec3& p) const {
    const Vec3 d = p - position_;
    const float scale = 1 / (glm::dot(d, forward_) * pixel_);
    return middle_ + Vec2(glm::dot(d, right_), -glm::dot(d, up_)) * scale;
  }
  /// Distance along the camera's axis.
  float depth(const Vec3& p) const { return glm::dot(p - position_, forward_); }
  const Vec3& position() const { return position_; }

private:
  Vec3 position_, forward_, right_, up_;
  float pixel_;
  Vec2 middle_;
  float lens_radius_, focus_;
};

/// The camera while the shutter is open.
class MovingCamera {
public:
  /// So many frames after the exposure.
  explicit MovingCamera(const FrameScene& frame, double later = 0)
      : states_(frame.camera_stands ? std::vector{frame.camera} : states_of(frame, later, [](const FrameScene& at) { return at.camera; })),
        resolution_(frame.film.resolution), standing_(states_[0], resolution_) {}

  CameraRays at(float time) const { return states_.size() == 1 ? standing_ : CameraRays(state_at(states_, time), resolution_); }
  RayCone cone(int spp) const { return standing_.cone(spp); }
  /// Around all its positions.
  Box3 bounds() const {
    Box3 box;
    for (const Camera<SampledMode>& c : states_) box.extend(c.position);
    return box;
  }

private:
  std::vector<Camera<SampledMode>> states_;
  Vec2i resolution_;
  CameraRays standing_;
};

} // namespace kelpie
