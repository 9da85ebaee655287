// Lights that have a place in the scene. They shine, but hide nothing.
#pragma once

#include "renderer/integrate/emitter.h"
#include "scene/lights.h"

namespace kelpie {

/// What those with a size have in common.
class NearEmitter {
public:
  bool is_delta() const { return false; }
  bool is_distant() const { return false; }
  bool is_background() const { return false; }
  bool is_visible() const { return is_visible_; }
  bool is_narrow() const { return false; }
  bool is_even() const { return false; }

protected:
  template <class Light>
  NearEmitter(const Light& light, float area) : radiance_(light.colour.rgb * (light.strength / area)), is_visible_(light.visible) {}

  Vec3 radiance_;

private:
  bool is_visible_;
};

/// A rectangle, sampled evenly over the solid angle that it fills (Ureña, Fajardo and King 2013).
class RectangleEmitter : public NearEmitter {
public:
  explicit RectangleEmitter(const RectangleLight<SampledMode>&);

  Arrival sample(const Vec3& p, Vec2 u) const;
  Arrival seen_along(const Vec3& p, const Vec3& direction) const;

private:
  struct View;

  Vec3 middle_, normal_, x_, y_; ///< it shines along its normal; unit vectors across and up
  float width_, height_;
};

/// A disc, sampled evenly over its area.
class DiscEmitter : public NearEmitter {
public:
  explicit DiscEmitter(const DiscLight<SampledMode>&);

  Arrival sample(const Vec3& p, Vec2 u) const;
  Arrival seen_along(const Vec3& p, const Vec3& direction) const;

private:
  Arrival arrive(const Vec3& direction, float distance) const;

  Vec3 middle_, normal_;
  float radius_;
};

/// A ball, sampled evenly over the cone that it fills.
class SphereEmitter : public NearEmitter {
public:
  explicit SphereEmitter(const SphereLight<SampledMode>&);

  Arrival sample(const Vec3& p, Vec2 u) const;
  Arrival seen_along(const Vec3& p, const Vec3& direction) const;

private:
  Vec3 middle_;
  float radius_;
};

class PointEmitter {
public:
  explicit PointEmitter(const PointLight<SampledMode>& light) : position_(light.position), intensity_(light.colour.rgb * light.strength) {}

  Arrival sample(const Vec3& p, Vec2) const;
  Arrival seen_along(const Vec3&, const Vec3& direction) const { return {direction, Vec3(0), 0, false}; }
  bool is_delta() const { return true; }
  bool is_distant() const { return false; }
  bool is_background() const { return false; }
  bool is_visible() const { return false; }
  bool is_narrow() const { return true; }
  bool is_even() const { return false; }

private:
  Vec3 position_, intensity_;
};

} // namespace kelpie
