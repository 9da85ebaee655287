#include "cli/read_options.h"

namespace kelpie {

void add_read_options(CLI::App& command, ReadOptions& o) {
  command.add_option("--set", o.set, "change a value of the scene: shapes.drop.threshold=1.1 (may be repeated)")
      ->allow_extra_args(false)
      ->option_text("PATH=VALUE");
  command.add_option("--recipes", o.libraries, "a file with further recipes (may be repeated)")
      ->allow_extra_args(false)
      ->option_text("FILE");
  command.add_option("--allow-path", o.allow_paths, "a folder outside the scene's own that its files may lie in (may be repeated)")
      ->allow_extra_args(false);
  command.add_flag_callback(
      "--no-cache", [&o] { o.use_cache = false; }, "make the distances of meshes anew, and keep nothing in ~/.cache/kelpie");
}

void add_recipe_option(CLI::App& command, ReadOptions& o) {
  command.add_option("--recipe", o.recipe, "one of the scene's recipes: values that it changes, before --set does")->option_text("NAME");
}

} // namespace kelpie
