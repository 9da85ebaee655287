// Surfaces that scenes may name, besides all kinds of material: what things are made of. Colours are scene-linear (ACEScg).
//
// Sources: metals (reflectance straight on, and the F82 tint) and indices of refraction are those of physicallybased.info (CC0), as
// OpenPBR's examples have them (Academy Software Foundation); aluminium's after Cheng et al. 2016, others after Polyanskiy's
// refractiveindex.info. Gallium, which neither has, is an estimate: a metal of free electrons. Colours of amber, honey, jade and wax
// are choices that look right; those of milk and skin are the albedos that OpenPBR's examples have for light that is
// scattered below the surface. How far it goes there is for bodies about two units large: scenes have no millimetres.
#pragma once

#include <array>
#include <string_view>

#include "materials/openpbr.h"

namespace kelpie {

struct Preset {
  struct Rgb {
    float r, g, b;
    Colour colour() const { return {Vec3(r, g, b)}; }
  };

  std::string_view name, doc;
  // As in OpenPbr:
  Rgb base_color{0.8f, 0.8f, 0.8f};
  Rgb specular_color{1, 1, 1};
  float specular_roughness = 0;
  float base_metalness = 0;
  float specular_ior = 1.5f;
  float transmission_weight = 0;
  Rgb transmission_color{1, 1, 1};
  float transmission_depth = 0;
  float subsurface_weight = 0;
  Rgb subsurface_color{0.8f, 0.8f, 0.8f};
  float subsurface_radius = 1;
  Rgb subsurface_radius_scale{1, 0.5f, 0.25f};

  template <class Mode = SampledMode>
  OpenPbr<Mode> surface() const {
    OpenPbr<Mode> s;
    s.base_color = base_color.colour(), s.base_metalness = base_metalness;
    s.specular_color = specular_color.colour(), s.specular_roughness = specular_roughness, s.specular_ior = specular_ior;
    s.transmission_weight = transmission_weight, s.transmission_color = transmission_color.colour();
    s.transmission_depth = transmission_depth;
    s.subsurface_weight = subsurface_weight, s.subsurface_color = subsurface_color.colour();
    s.subsurface_radius = subsurface_radius, s.subsurface_radius_scale = subsurface_radius_scale.colour();
    return s;
  }
};

namespace detail {
constexpr Preset metal(std::string_view name, std::string_view doc, Preset::Rgb reflectance, Preset::Rgb tint) {
  return {name, doc, reflectance, tint, 0.02f, 1};
}
constexpr Preset clear(std::string_view name, std::string_view doc, float ior, Preset::Rgb colour = {1, 1, 1}, float depth = 0) {
  return {
      .name = name, .doc = doc, .specular_ior = ior, .transmission_weight = 1, .transmission_color = colour, .transmission_depth = depth};
}
constexpr Preset translucent(std::string_view name, std::string_view doc, Preset::Rgb albedo, float radius, Preset::Rgb scale, float ior,
                             float roughness) {
  return {.name = name,
          .doc = doc,
          .base_color = albedo,
          .specular_roughness = roughness,
          .specular_ior = ior,
          .subsurface_weight = 1,
          .subsurface_color = albedo,
          .subsurface_radius = radius,
          .subsurface_radius_scale = scale};
}
} // namespace detail

inline constexpr std::array k_presets{
    detail::metal("gold", "polished gold", {0.929f, 0.788f, 0.374f}, {0.974f, 1, 0.984f}),
    detail::metal("silver", "polished silver", {0.988f, 0.985f, 0.975f}, {0.995f, 0.995f, 0.998f}),
    detail::metal("copper", "polished copper", {0.861f, 0.706f, 0.486f}, {0.967f, 0.947f, 0.738f}),
    detail::metal("aluminium", "polished aluminium", {0.918f, 0.922f, 0.923f}, {0.921f, 0.934f, 0.955f}),
    detail::metal("chrome", "polished chromium", {0.666f, 0.682f, 0.698f}, {0.706f, 0.726f, 0.788f}),
    detail::metal("iron", "polished iron", {0.523f, 0.514f, 0.497f}, {0.767f, 0.768f, 0.797f}),
    detail::metal("mercury", "liquid mercury", {0.781f, 0.780f, 0.779f}, {0.830f, 0.850f, 0.895f}),
    detail::metal("gallium", "liquid gallium", {0.880f, 0.885f, 0.895f}, {0.950f, 0.955f, 0.965f}),
    detail::clear("water", "clear water, a little blue where it is deep: `transmission_depth` 10", 1.33f, {0.60f, 0.85f, 0.93f}, 10),
    detail::clear("ice", "clear ice, as water", 1.31f, {0.60f, 0.85f, 0.93f}, 10),
    detail::clear("diamond", "cut diamond", 2.42f),
    detail::clear("amber", "amber: deep orange, `transmission_depth` 1", 1.54f, {0.62f, 0.27f, 0.03f}, 1),
    detail::clear("honey", "honey: golden, `transmission_depth` 1", 1.50f, {0.705f, 0.500f, 0.112f}, 1),
    detail::translucent("milk", "milk: light comes out near where it went in, `subsurface_radius` 0.06", {0.808f, 0.811f, 0.699f}, 0.06f,
                        {1, 0.75f, 0.5f}, 1.35f, 0),
    detail::translucent("skin", "fair skin, red where light comes from behind: `subsurface_radius` 0.05", {0.671f, 0.505f, 0.371f}, 0.05f,
                        {1, 0.35f, 0.2f}, 1.4f, 0.5f),
    detail::translucent("jade", "polished jade, deep: `subsurface_radius` 0.2", {0.36f, 0.55f, 0.37f}, 0.2f, {0.8f, 1, 0.8f}, 1.62f, 0.12f),
    detail::translucent("wax", "candle wax, which glows in light: `subsurface_radius` 0.16", {0.9f, 0.8f, 0.62f}, 0.16f, {1, 0.65f, 0.35f},
                        1.44f, 0.35f),
};

/// The preset of a name; null if there is none.
constexpr const Preset* find_preset(std::string_view name) {
  for (const Preset& preset : k_presets)
    if (preset.name == name) return &preset;
  return nullptr;
}

} // namespace kelpie
