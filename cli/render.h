// Rendering a scene file's frames: what `kelpie render` and `kelpie liquid` share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/progress.h"
#include "scene/reader.h"

namespace kelpie {

struct RenderOptions {
  std::optional<std::string> frames; ///< a range as in `1-96x2,100`; none: all frames of the scene
  std::string output;                ///< a pattern; empty: NAME.####.exr in the current folder
  std::string resolution;            ///< `1280x720`, `50%`, or empty
  std::string crop;                  ///< `x0,x1,y0,y1`, or empty
  std::string quality;               ///< `draft`, `final`, or empty
  int spp = 0;                       ///< 0: as in the scene
  int threads = 0;                   ///< 0: all cores
  bool skip_existing = false;
  bool heatmap = false; ///< add the channel `cost`
  std::string stats;    ///< a JSON file, or empty
  ProgressMode progress = ProgressMode::automatic;
  uint64_t max_memory = 0; ///< what building a frame may take, bytes; 0: no cap
  std::string ocio;        ///< an OCIO config, or empty
  ReadOptions read;
};

/// Adds the options of RenderOptions to a command, with their help.
void add_render_options(CLI::App& command, RenderOptions& options);

/// Renders the frames of a scene file. `name` stands for it in default output names.
/// Throws Error; returns only when every requested frame exists and was verified.
void render_scene(const std::string& scene_path, const std::string& name, const RenderOptions& options);

} // namespace kelpie
