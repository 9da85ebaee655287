// A frame's pixels.
#pragma once

#include <functional>

#include "renderer/film/frame_image.h"
#include "renderer/integrate/path.h"

namespace kelpie {

struct IntegrateResult {
  FrameImage image;
  RayCounters rays;
  uint64_t nonfinite = 0;        ///< samples that were NaN or infinite, counted as black
  Vec2i first_nonfinite{-1, -1}; ///< the pixel of one of them
};

/// Renders the pixels of `window` in the current TBB arena. A pixel depends on the scene, its place, the
/// frame and nothing else. `progress` is called with the share of the frame that is newly finished, a few pixels at a time, by any
/// thread; what it throws ends the rendering.
IntegrateResult integrate(const FrameScene& frame, const Tracer& tracer, const std::vector<Light>& lights, const PixelBox& window,
                          const std::function<void(double)>& progress);

} // namespace kelpie
