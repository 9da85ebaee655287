// The lights of a frame. Here are those that are infinitely far away: environments and suns.
#pragma once

#include <map>
#include <memory>
#include <variant>
#include <vector>

#include "base/error.h"
#include "renderer/integrate/emitter.h"
#include "renderer/integrate/near_lights.h"
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

/// An environment map, turned and with its strength.
class EnvironmentEmitter {
public:
  EnvironmentEmitter(std::shared_ptr<const EnvironmentMap> map, const EnvironmentLight<SampledMode>&);

  Arrival sample(const Vec3& p, Vec2 u) const;
  Arrival seen_along(const Vec3& p, const Vec3& direction) const;
  bool is_delta() const { return false; }
  bool is_distant() const { return true; }
  bool is_background() const { return true; }
  bool is_visible() const { return false; }
  bool is_narrow() const { return false; }
  bool is_even() const;

private:
  /// From the map's frame by `sine`, into it by -`sine`: a turn about +y, from +z towards +x.
  Vec3 turn(const Vec3& v, float sine) const { return {cos_ * v.x + sine * v.z, v.y, cos_ * v.z - sine * v.x}; }

  std::shared_ptr<const EnvironmentMap> map_;
  float strength_, cos_, sin_;
};

/// A disc in the sky, the same all over; or a direction, where it is too small for float directions to tell it from one.
class SunEmitter {
public:
  explicit SunEmitter(const SunLight<SampledMode>&);

  Arrival sample(const Vec3& p, Vec2 u) const;
  Arrival seen_along(const Vec3& p, const Vec3& direction) const;
  bool is_delta() const { return solid_angle_ == 0; }
  bool is_distant() const { return true; }
  bool is_background() const { return false; }
  bool is_visible() const { return false; }
  bool is_narrow() const { return true; }
  bool is_even() const { return false; }

private:
  Vec3 direction_, radiance_;
  float cos_radius_ = 1, solid_angle_ = 0;
};

// What each kind of light becomes: a kind without such a function does not compile.
EnvironmentEmitter make_emitter(const EnvironmentLight<SampledMode>&, EnvironmentCache&, Diagnostics&);
SunEmitter make_emitter(const SunLight<SampledMode>&, EnvironmentCache&, Diagnostics&);
RectangleEmitter make_emitter(const RectangleLight<SampledMode>&, EnvironmentCache&, Diagnostics&);
DiscEmitter make_emitter(const DiscLight<SampledMode>&, EnvironmentCache&, Diagnostics&);
SphereEmitter make_emitter(const SphereLight<SampledMode>&, EnvironmentCache&, Diagnostics&);
PointEmitter make_emitter(const PointLight<SampledMode>&, EnvironmentCache&, Diagnostics&);

/// Any of the emitters that the kinds of a list become.
template <class Kinds>
struct Emitters;
template <template <class> class... Kinds>
struct Emitters<KindList<Kinds...>> {
  template <class Kind>
  using Of = decltype(make_emitter(std::declval<Kind>(), std::declval<EnvironmentCache&>(), std::declval<Diagnostics&>()));
  using Variant = std::variant<Of<Kinds<SampledMode>>...>;
  static_assert((Emitter<Of<Kinds<SampledMode>>> && ...), "an emitter must answer all of Emitter");
};

/// One light of a frame.
class Light {
public:
  using Any = Emitters<LightKinds>::Variant;
  explicit Light(Any emitter) : emitter_(std::move(emitter)) {}

  Arrival sample(const Vec3& p, Vec2 u) const {
    return std::visit([&](const auto& e) { return e.sample(p, u); }, emitter_);
  }
  Arrival seen_along(const Vec3& p, const Vec3& direction) const {
    return std::visit([&](const auto& e) { return e.seen_along(p, direction); }, emitter_);
  }
  bool is_delta() const {
    return std::visit([](const auto& e) { return e.is_delta(); }, emitter_);
  }
  bool is_distant() const {
    return std::visit([](const auto& e) { return e.is_distant(); }, emitter_);
  }
  bool is_visible() const {
    return std::visit([](const auto& e) { return e.is_visible(); }, emitter_);
  }
  bool is_background() const {
    return std::visit([](const auto& e) { return e.is_background(); }, emitter_);
  }
  bool is_narrow() const {
    return std::visit([](const auto& e) { return e.is_narrow(); }, emitter_);
  }
  bool is_even() const {
    return std::visit([](const auto& e) { return e.is_even(); }, emitter_);
  }

private:
  Any emitter_;
};

static_assert(Emitter<Light>);

std::vector<Light> make_lights(const FrameScene& frame, EnvironmentCache& cache, Diagnostics& diagnostics);

} // namespace kelpie
