// Contact sheets of a scene's variations: recipes, random ones, or values of one or two of its numbers.
#pragma once

#include <string>
#include <vector>

#include "cli/render.h"

namespace kelpie {

/// What to vary.
struct VariationOptions {
  std::vector<std::string> recipes; ///< names; empty with `all_recipes`: all
  bool all_recipes = false;
  int random = 0; ///< how many recipes to draw
  unsigned seed = 1;
  bool pairs = false;
  std::string across, down; ///< `PATH=VALUE|VALUE|…`; the paths `frame` and `recipe` are those
};

/// One picture of the sheet.
struct Tile {
  std::string name, label; ///< of its file, and on the sheet
};

struct TileSheet {
  std::vector<Tile> tiles;
  std::vector<std::string> files; ///< an EXR each
  int columns = 0;                ///< 0: as it fits
};

/// Adds the options of what to vary, and those of the scene that is.
void add_variation_options(CLI::App& command, VariationOptions&, RenderOptions& scene);

/// Whether anything is to be varied.
bool has_variations(const VariationOptions&);

/// Whether anything was said of the scene.
bool is_changed(const RenderOptions& scene);

/// Renders the tiles of a scene, `width` pixels wide, into `folder`, but those that are there and complete. Recipes that were made are
/// written to `folder`/recipes.json first. Throws Error.
TileSheet render_tiles(const std::string& scene, const VariationOptions&, int width, const std::string& folder, RenderOptions);

} // namespace kelpie
