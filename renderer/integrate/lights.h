// The lights of a frame, all of them infinitely far away: environments and suns.
#pragma once

#include <map>
#include <memory>
#include <variant>
#include <vector>

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

/// What a kind of light answers once it is ready for a frame.
template <class T>
concept Emitter = requires(const T& emitter, Vec2 u, const Vec3& direction) {
  /// Light from a direction by importance, for u in [0, 1)^2.
  { emitter.sample(u) } -> std::same_as<Arrival>;
  /// What a ray that misses everything sees of this light, and how likely `sample` is to choose its direction.
  { emitter.seen_along(direction) } -> std::same_as<Arrival>;
  /// Whether all light comes from one direction, which no ray finds by chance.
  { emitter.is_delta() } -> std::same_as<bool>;
  /// Whether the camera sees it behind everything, where the film's background is `environment`.
  { emitter.is_background() } -> std::same_as<bool>;
  /// Whether rays towards it run side by side where they start side by side: such rays are traced as packets.
  { emitter.is_narrow() } -> std::same_as<bool>;
};

/// An environment map, turned and with its strength.
class EnvironmentEmitter {
public:
  EnvironmentEmitter(std::shared_ptr<const EnvironmentMap> map, const EnvironmentLight<SampledMode>&);

  Arrival sample(Vec2 u) const;
  Arrival seen_along(const Vec3& direction) const;
  bool is_delta() const { return false; }
  bool is_background() const { return true; }
  bool is_narrow() const { return false; }

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

  Arrival sample(Vec2 u) const;
  Arrival seen_along(const Vec3& direction) const;
  bool is_delta() const { return solid_angle_ == 0; }
  bool is_background() const { return false; }
  bool is_narrow() const { return true; }

private:
  Vec3 direction_, radiance_;
  float cos_radius_ = 1, solid_angle_ = 0;
};

// What each kind of light becomes: a kind without such a function does not compile.
EnvironmentEmitter make_emitter(const EnvironmentLight<SampledMode>&, EnvironmentCache&, Diagnostics&);
SunEmitter make_emitter(const SunLight<SampledMode>&, EnvironmentCache&, Diagnostics&);

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

  Arrival sample(Vec2 u) const {
    return std::visit([&](const auto& e) { return e.sample(u); }, emitter_);
  }
  Arrival seen_along(const Vec3& direction) const {
    return std::visit([&](const auto& e) { return e.seen_along(direction); }, emitter_);
  }
  bool is_delta() const {
    return std::visit([](const auto& e) { return e.is_delta(); }, emitter_);
  }
  bool is_background() const {
    return std::visit([](const auto& e) { return e.is_background(); }, emitter_);
  }
  bool is_narrow() const {
    return std::visit([](const auto& e) { return e.is_narrow(); }, emitter_);
  }

private:
  Any emitter_;
};

static_assert(Emitter<Light>);

std::vector<Light> make_lights(const FrameScene& frame, EnvironmentCache& cache, Diagnostics& diagnostics);

} // namespace kelpie
