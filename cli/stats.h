// The statistics file of a rendering (docs/manual.md).
#pragma once

#include <string>
#include <vector>

#include "renderer/render_frame.h"

namespace kelpie {

struct FrameReport {
  FrameStats frame;
  double output_cpu_s = 0; ///< encode, verify, write
  double peak_rss_mb = 0;
};

/// Writes the reports as JSON, all or nothing.
void write_render_stats(const std::string& path, unsigned threads, const std::vector<FrameReport>& reports);

} // namespace kelpie
