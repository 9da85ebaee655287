// What rendering will cost, found out by rendering a little of it.
#pragma once

#include "renderer/render_frame.h"

namespace kelpie {

struct Forecast {
  enum class Stopped {
    no,
    building_out_of_memory, ///< it takes more than k_most_trial_bytes: then there are only bounds
    building_out_of_time,   ///< it takes longer than k_trial_s: the same
    rendering_out_of_time,  ///< the time of a frame follows from the part that was rendered
  };

  Stopped stopped = Stopped::no;
  size_t elements = 0, cells = 0; ///< the most of the frames that were tried
  double cpu_s_per_frame = 0;     ///< the mean of them, all threads: building, rendering, output
  double wall_s_per_frame = 0;    ///< on as many threads as the current arena has
  double memory_mb = 0;           ///< peak
  double engine_mb = 0;           ///< of it: what building takes, the most of the frames
  int coarsenings = 0;            ///< see FrameStats; the most of the frames
  BuildBudget::Share costliest;   ///< the shape that takes most of what is built in any of the frames
};

/// How long trials go on, all together, and how much each may build.
inline constexpr double k_trial_s = 4;
inline constexpr size_t k_most_trial_bytes = size_t(600) << 20;

/// Tries the first, the middle and the last of `frames`: builds each as it is and renders it small.
/// Sound because a sample costs about the same in a small picture as in a large one. Throws Error out_of_memory where less memory is
/// there than building takes.
Forecast forecast(const Scene& scene, const std::vector<int>& frames, const PixelBox& window, const FrameContext& context);

} // namespace kelpie
