// One frame: scene in, picture out. The renderer's whole way of the data, in one function.
#pragma once

#include "renderer/cpu_time.h"
#include "renderer/integrate/integrate.h"

namespace kelpie {

struct FrameStats {
  double frame = 0, wall_s = 0;
  double build_cpu_s = 0;  ///< from the sampled scene to Embree's commit, all threads
  double render_cpu_s = 0; ///< tracing, shading and film, all threads
  RayCounters rays;
  uint64_t nonfinite = 0;
  size_t cells = 0, elements = 0, engine_bytes = 0;
  size_t kept_cells = 0;        ///< of `cells`: as the last frame left them
  int coarsenings = 0;          ///< how often cells were made twice as long, to fit into the memory
  BuildBudget::Share costliest; ///< the shape of which most was built
};

struct RenderedFrame {
  FrameImage image;
  FrameStats stats;
  Camera<SampledMode> camera; ///< at this frame
};

/// How far building and rendering may go where only their cost is asked for.
struct FrameTrial {
  BuildBudget::Clock::time_point deadline;
  size_t most_bytes = 0; ///< of what is built
  FrameStats stats;      ///< what was found out, once the frame is built
};

/// What a frame needs besides the scene.
struct FrameContext {
  EnvironmentCache& environments; ///< kept from frame to frame
  Diagnostics& diagnostics;       ///< receives warnings
  const std::function<void(double)>& progress;
  size_t max_memory = 0;       ///< what building may take before cells become coarser, bytes; 0: they never do
  KeptScenes* kept = nullptr;  ///< kept from frame to frame
  FrameTrial* trial = nullptr; ///< if set, render_frame() throws BuildBudget::OutOfMemory and OutOfTime where it would go further
};

/// Renders the pixels of `window` of one frame in the current TBB arena. Throws Error out_of_memory, which names the shape that takes most,
/// where even the coarsest cells take more than context.max_memory, or what is built more than usable_memory(); and where the picture does.
RenderedFrame render_frame(const Scene& scene, double frame, const PixelBox& window, const FrameContext& context);

/// A shape and what it takes, in words: `"fin" (512 MB)`.
std::string describe(const BuildBudget::Share&, const Scene&);

} // namespace kelpie
