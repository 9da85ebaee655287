#include "cli/scene_sheet.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/file_bytes.h"
#include "cli/failure.h"
#include "cli/random_recipes.h"
#include "renderer/output/sequence.h"

namespace kelpie {

namespace {

/// One value of what is varied, as an option of a rendering.
struct Change {
  std::string label;
  std::string set, frames; ///< one of them
};

/// `PATH=VALUE|VALUE|…`.
std::vector<Change> parse_axis(const std::string& option, const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos)
    throw Error(ExitStatus::usage, fmt::format("{} {}: expected PATH=VALUE|VALUE|…, as in frame=1|24|48", option, text));
  const std::string path = text.substr(0, equals);
  const std::string_view last_step = std::string_view(path).substr(path.rfind('.') == std::string::npos ? 0 : path.rfind('.') + 1);
  std::vector<Change> changes;
  for (size_t from = equals + 1; from <= text.size();) {
    const size_t end = std::min(text.find('|', from), text.size());
    const std::string value = text.substr(from, end - from);
    const bool is_frame = path == "frame";
    changes.push_back({fmt::format("{} {}", last_step, value), is_frame ? "" : path + "=" + value, is_frame ? value : ""});
    from = end + 1;
  }
  return changes;
}

/// What is rendered, for each tile.
struct Plan {
  std::vector<Tile> tiles;
  std::vector<RenderOptions> options;
  int columns = 0;

  void add(Tile tile, const RenderOptions& o) { tiles.push_back(std::move(tile)), options.push_back(o); }
};

void apply(const Change& change, RenderOptions& options) {
  if (!change.set.empty()) options.set.push_back(change.set);
  if (!change.frames.empty()) options.frames = change.frames;
}

/// A table of one or two axes.
void plan_axes(const VariationOptions& v, const RenderOptions& options, Plan& plan) {
  const std::vector<Change> across = v.across.empty() ? std::vector<Change>{{}} : parse_axis("--across", v.across);
  const std::vector<Change> down = v.down.empty() ? std::vector<Change>{{}} : parse_axis("--down", v.down);
  plan.columns = static_cast<int>(across.size());
  for (size_t row = 0; row < down.size(); ++row)
    for (size_t column = 0; column < across.size(); ++column) {
      RenderOptions of_tile = options;
      apply(across[column], of_tile), apply(down[row], of_tile);
      const bool has_both = !across[column].label.empty() && !down[row].label.empty();
      plan.add(
          {fmt::format("row_{:02}_column_{:02}", row + 1, column + 1), across[column].label + (has_both ? ", " : "") + down[row].label},
          of_tile);
    }
}

void plan_recipes(const std::string& scene, const VariationOptions& v, RenderOptions options, const std::string& folder, Plan& plan) {
  std::vector<std::string> names = v.recipes;
  if (v.random > 0) {
    const std::string file = folder + "/recipes.json", drawn = random_recipes(scene, v.random, v.seed);
    write_file_atomically(file, as_bytes(drawn));
    const std::vector<std::string> before = read_recipe_names(scene, options.read_options());
    options.recipes.push_back(file);
    for (const std::string& name : read_recipe_names(scene, options.read_options()))
      if (std::find(before.begin(), before.end(), name) == before.end()) names.push_back(name);
  } else if (v.all_recipes) {
    names = read_recipe_names(scene, options.read_options());
    if (names.empty()) throw Error(ExitStatus::bad_data, fmt::format("{}: it has no recipes", scene));
  }
  for (const std::string& name : names) {
    options.recipe = name;
    plan.add({name, name}, options);
  }
}

} // namespace

bool has_variations(const VariationOptions& v) {
  return !v.recipes.empty() || v.all_recipes || v.random > 0 || !v.across.empty() || !v.down.empty();
}

TileSheet render_tiles(const std::string& scene, const VariationOptions& v, int width, const std::string& folder, RenderOptions options) {
  std::filesystem::create_directories(folder);
  const ProgressMode mode = options.progress;
  options.progress = ProgressMode::none;
  options.skip_existing = true;
  {
    Diagnostics diagnostics; // the scene's own shape of the picture, and its first frame
    const Scene plain = read_scene(scene, options.read_options(), diagnostics);
    const Vec2i size = plain.film.resolution;
    const int height = std::max(1, static_cast<int>(std::lround(double(width) * size.y / size.x)));
    if (options.resolution.empty()) options.resolution = fmt::format("{}x{}", width, height);
    if (!options.frames) options.frames = std::to_string(plain.frames.first);
  }
  Plan plan;
  if (!v.across.empty() || !v.down.empty())
    plan_axes(v, options, plan);
  else
    plan_recipes(scene, v, options, folder, plan);

  Progress progress(mode, double(plan.tiles.size()), "tiles");
  TileSheet sheet{plan.tiles, {}, plan.columns};
  for (size_t i = 0; i < plan.tiles.size(); ++i) {
    RenderOptions& of_tile = plan.options[i];
    of_tile.output = fmt::format("{}/{}.exr", folder, plan.tiles[i].name);
    render_scene(scene, plan.tiles[i].name, of_tile);
    sheet.files.push_back(of_tile.output);
    progress.advance(double(i + 1), fmt::format("wrote {}", of_tile.output));
  }
  return sheet;
}

} // namespace kelpie
