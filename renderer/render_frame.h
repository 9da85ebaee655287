// One frame: scene in, picture out. The renderer's whole way of the data, in one function.
#pragma once

#include "renderer/integrate/integrate.h"

namespace kelpie {

struct FrameStats {
  double frame = 0, wall_s = 0;
  double build_cpu_s = 0;  ///< from the sampled scene to Embree's commit, all threads
  double render_cpu_s = 0; ///< tracing, shading and film, all threads
  RayCounters rays;
  uint64_t nonfinite = 0;
  size_t cells = 0, elements = 0, engine_bytes = 0;
};

struct RenderedFrame {
  FrameImage image;
  FrameStats stats;
  Camera<SampledMode> camera; ///< at this frame
  bool was_stopped = false;
};

/// What a frame needs besides the scene.
struct FrameContext {
  EnvironmentCache& environments; ///< kept from frame to frame
  Diagnostics& diagnostics;       ///< receives warnings
  const std::function<void(double)>& progress;
  const std::atomic<bool>& stop;
};

/// Renders the pixels of `window` of one frame in the current TBB arena.
RenderedFrame render_frame(const Scene& scene, double frame, const PixelBox& window, const FrameContext& context);

/// CPU seconds of all threads of this process so far.
double process_cpu_s();

} // namespace kelpie
