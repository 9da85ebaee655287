// What rendering will cost, found out by rendering a little of it.
#pragma once

#include "renderer/render_frame.h"

namespace kelpie {

struct Forecast {
  size_t elements = 0, cells = 0; ///< the most of the frames that were tried
  double cpu_s_per_frame = 0;     ///< the mean of them, all threads: building, rendering, output
  double wall_s_per_frame = 0;    ///< on as many threads as the current arena has
  double memory_mb = 0;           ///< peak
  double engine_mb = 0;           ///< of it: what building takes, the most of the frames
  int coarsenings = 0;            ///< see FrameStats; the most of the frames
};

/// Tries the first, the middle and the last of `frames`: builds each as it is and renders it small.
/// Sound because a sample costs about the same in a small picture as in a large one.
Forecast forecast(const Scene& scene, const std::vector<int>& frames, const PixelBox& window, const FrameContext& context);

} // namespace kelpie
