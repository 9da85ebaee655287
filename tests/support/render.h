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
inline IntegrateResult render(const FrameScene& scene) { return render(scene, {0, 0, scene.film.resolution.x, scene.film.resolution.y}); }

} // namespace kelpie
