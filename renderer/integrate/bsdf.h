// Reflectance models at a point: evaluated, sampled, and their densities. Directions are unit vectors in
// the local frame of the surface: z is the normal, on the side of the viewer.
#pragma once

#include "base/vec.h"
#include "materials/surfaces.h"

namespace kelpie {

/// An orthonormal frame around a unit normal (Duff et al. 2017).
struct Frame {
  Vec3 x, y, z;

  explicit Frame(const Vec3& n) : z(n) {
    const float sign = std::copysign(1.f, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
    x = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    y = {b, sign + n.y * n.y * a, -n.y};
  }
  Vec3 world_from_local(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
  Vec3 local_from_world(const Vec3& v) const { return {glm::dot(v, x), glm::dot(v, y), glm::dot(v, z)}; }
};

struct BsdfSample {
  Vec3 direction{0};     ///< of the incoming light
  Vec3 weight{0};        ///< bsdf * cosine / pdf
  float pdf = 0;         ///< per solid angle; 0 where the sample is invalid
  bool is_delta = false; ///< a mirror: no light sample can match it
};

/// One surface at one moment.
class Bsdf {
public:
  explicit Bsdf(const SurfaceKinds::Variant<SampledMode>& surface);

  const Vec3& albedo() const { return colour_; }
  /// A mirror reflects one direction only: light sampling is in vain.
  bool is_delta() const { return is_metal_ && alpha_ == 0; }
  bool is_glossy() const { return is_metal_; }

  /// The same with a GGX width of `alpha` or more; matte surfaces as they are.
  Bsdf at_least_as_rough_as(float alpha) const {
    Bsdf b = *this;
    b.alpha_ = std::max(alpha_, alpha);
    return b;
  }

  /// bsdf * cosine of the incoming direction; 0 below the horizon.
  Vec3 evaluate(const Vec3& out, const Vec3& in) const;
  float pdf(const Vec3& out, const Vec3& in) const;
  BsdfSample sample(const Vec3& out, Vec2 u) const;

private:
  Vec3 fresnel(float cosine) const;

  Vec3 colour_;
  bool is_metal_ = false;
  float alpha_ = 0; ///< GGX width; 0: a mirror
};

} // namespace kelpie
