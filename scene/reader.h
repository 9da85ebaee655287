// Scene files into scenes.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "scene/scene.h"

namespace kelpie {

struct ReadOptions {
  std::vector<std::string> set;         ///< `path=value`, applied before anything is read
  std::vector<std::string> allow_paths; ///< folders or files outside the scene's folder that it may read
  bool use_cache = true;                ///< what is costly to make of assets is kept for the next run
  std::string recipe{};                 ///< one of the scene's, applied before `set`; empty: none
  std::vector<std::string> libraries{}; ///< files that it includes besides its own
};

/// Reads a scene and its assets. Throws one Error that lists every problem of the file with its position;
/// missing_input where the scene itself, or nothing but assets, is missing. `diagnostics` gets warnings.
Scene read_scene(const std::string& path, const ReadOptions&, Diagnostics& diagnostics);

/// The names of its recipes, and of those that it includes, in their order. Throws as read_scene does, if the file cannot be read as JSON.
std::vector<std::string> read_recipe_names(const std::string& path, const ReadOptions&);

} // namespace kelpie
