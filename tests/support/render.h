// Pictures of sampled scenes.
#pragma once

#include "renderer/integrate/integrate.h"

namespace kelpie {

/// The part of the picture in a window.
inline IntegrateResult render(const FrameScene& scene, const PixelBox& window) {
  Diagnostics diagnostics;
  EnvironmentCache cache;
  const std::vector<Light> lights = make_lights(scene, cache, diagnostics);
  return integrate(scene, Tracer(scene), lights, window, [](double) {});
}
/// Gives a shape a surface of its own.
inline void set_surface(FrameScene& scene, size_t shape, MaterialKinds::Variant<SampledMode> surface) {
  scene.shapes[shape].surface = {static_cast<uint32_t>(scene.materials.size())};
  scene.materials.push_back(std::move(surface));
}

/// A shape of one node, in an environment that is white all over.
inline FrameScene in_white(FieldKinds::Variant<SampledMode> node, MaterialKinds::Variant<SampledMode> surface) {
  FrameScene scene;
  SampledShape shape;
  shape.field.nodes.push_back(std::move(node));
  scene.shapes.push_back(std::move(shape));
  set_surface(scene, 0, std::move(surface));
  EnvironmentLight<SampledMode> light;
  light.preset = EnvironmentPreset::white;
  scene.lights.emplace_back(light);
  return scene;
}

inline IntegrateResult render(const FrameScene& scene) { return render(scene, {0, 0, scene.film.resolution.x, scene.film.resolution.y}); }

} // namespace kelpie
