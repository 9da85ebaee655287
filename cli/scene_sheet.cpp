#include "cli/scene_sheet.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/file_bytes.h"
#include "cli/failure.h"
#include "cli/make_recipes.h"
#include "cli/read_options.h"
#include "renderer/output/sequence.h"

namespace kelpie {

namespace {

/// One value of what is varied: of a parameter, of `frame` or of `recipe`.
struct Change {
  std::string label;
  std::string path, value;
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
    changes.push_back({path == "recipe" ? value : fmt::format("{} {}", last_step, value), path, value});
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
  if (change.path == "frame")
    options.frames = change.value;
  else if (change.path == "recipe")
    options.read.recipe = change.value;
  else if (!change.path.empty())
    options.read.set.push_back(change.path + "=" + change.value);
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
    const std::vector<std::string> before = read_recipe_names(scene, options.read);
    options.read.libraries.push_back(file);
    for (const std::string& name : read_recipe_names(scene, options.read))
      if (std::find(before.begin(), before.end(), name) == before.end()) names.push_back(name);
  } else if (v.all_recipes) {
    names = read_recipe_names(scene, options.read);
    if (names.empty()) throw Error(ExitStatus::bad_data, fmt::format("{}: it has no recipes", scene));
  }
  for (const std::string& name : names) {
    options.read.recipe = name;
    plan.add({name, name}, options);
  }
}

/// Each two objects of a metamorphosis: a row and a column each.
void plan_pairs(const std::string& scene, RenderOptions options, const std::string& folder, Plan& plan) {
  const PairRecipes pairs = pair_recipes(scene);
  const std::string file = folder + "/recipes.json";
  write_file_atomically(file, as_bytes(pairs.library));
  options.read.libraries.push_back(file);
  const size_t count = pairs.names.size();
  plan.columns = static_cast<int>(count);
  for (size_t i = 0; i < count; ++i)
    for (size_t j = 0; j < count; ++j) {
      options.read.recipe = fmt::format("pair_{}_{}", i + 1, j + 1);
      plan.add({options.read.recipe, i == j ? pairs.names[i] : pairs.names[i] + ", " + pairs.names[j]}, options);
    }
}

} // namespace

void add_variation_options(CLI::App& command, VariationOptions& o, RenderOptions& scene) {
  CLI::Option* const recipe =
      command.add_option("--recipe", o.recipes, "of a scene: this recipe (may be repeated)")->allow_extra_args(false)->option_text("NAME");
  CLI::Option* const all = command.add_flag("--all-recipes", o.all_recipes, "of a scene: all its recipes");
  CLI::Option* const random =
      command
          .add_option("--random", o.random,
                      "of a scene with a metamorphosis: so many recipes drawn at random, kept in SHEET_tiles/recipes.json")
          ->check(CLI::Range(1, 2000))
          ->option_text("N");
  command.add_option("--seed", o.seed, "which random ones [1]")->needs(random)->option_text("N");
  CLI::Option* const pairs =
      command.add_flag("--pairs", o.pairs,
                       "of a scene with a metamorphosis: a table of its objects, two parts of the row's and one of the column's in each");
  CLI::Option* const across =
      command
          .add_option("--across", o.across,
                      "of a scene: a column for each value; the path `frame` is the frame, and `recipe` a recipe by name")
          ->option_text("PATH=V|V|…");
  CLI::Option* const down = command.add_option("--down", o.down, "of a scene: a row for each value")->option_text("PATH=V|V|…");
  all->excludes(recipe), random->excludes(recipe)->excludes(all), pairs->excludes(recipe)->excludes(all)->excludes(random);
  for (CLI::Option* const table : {across, down}) table->excludes(recipe)->excludes(all)->excludes(random)->excludes(pairs);
  command.add_option("--spp", scene.spp, "of a scene: samples per pixel")->check(CLI::Range(1, 1 << 20))->option_text("N");
  add_read_options(command, scene.read);
}

bool is_changed(const RenderOptions& o) {
  return o.spp > 0 || !o.read.set.empty() || !o.read.libraries.empty() || !o.read.allow_paths.empty();
}

bool has_variations(const VariationOptions& v) {
  return !v.recipes.empty() || v.all_recipes || v.random > 0 || v.pairs || !v.across.empty() || !v.down.empty();
}

TileSheet render_tiles(const std::string& scene, const VariationOptions& v, int width, const std::string& folder, RenderOptions options) {
  const ProgressMode mode = options.progress;
  options.progress = ProgressMode::none;
  options.skip_existing = true;
  {
    Diagnostics diagnostics; // the scene's own shape of the picture, and its first frame
    const Scene plain = read_scene(scene, options.read, diagnostics);
    const Vec2i size = plain.film.resolution;
    const int height = std::max(1, static_cast<int>(std::lround(double(width) * size.y / size.x)));
    if (options.resolution.empty()) options.resolution = fmt::format("{}x{}", width, height);
    if (!options.frames) options.frames = std::to_string(plain.frames.first);
  }
  Plan plan;
  if (!v.across.empty() || !v.down.empty())
    plan_axes(v, options, plan);
  else if (v.pairs)
    plan_pairs(scene, options, folder, plan);
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
