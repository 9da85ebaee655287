// Pictures of sampled scenes.
#pragma once

#include <atomic>

#include "renderer/integrate/integrate.h"

namespace kelpie {

/// The part of the picture in a window.
inline IntegrateResult render(const FrameScene& scene, const PixelBox& window) {
  Diagnostics diagnostics;
  EnvironmentCache cache;
  const std::vector<Light> lights = make_lights(scene, cache, diagnostics);
  const std::atomic<bool> stop{false};
  return integrate(
      scene, Tracer(scene), lights, window, [](double) {}, stop);
}
inline IntegrateResult render(const FrameScene& scene) { return render(scene, {0, 0, scene.film.resolution.x, scene.film.resolution.y}); }

} // namespace kelpie
