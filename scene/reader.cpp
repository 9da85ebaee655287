#include "scene/reader.h"

#include "scene/check_axes.h"
#include "scene/check_distances.h"
#include "scene/check_scene.h"
#include "scene/grow_trees.h"
#include "scene/include_files.h"
#include "scene/library.h"
#include "scene/link_parts.h"
#include "scene/load_assets.h"
#include "scene/overrides.h"
#include "scene/recipes.h"
#include "scene/record_reader.h"

namespace kelpie {

namespace {

/// What is left of an included file.
void check_library(const JsonValue& v, const Scene& scene, RecordReader& reader) {
  Library library;
  reader.read(library, v, ParameterRules{"the library", {}});
  if (library.units && *library.units != scene.units)
    reader.fail(*v.find("units"), fmt::format("units are {} here, but {} in the scene", *library.units, scene.units));
}

/// As if the scene's own list named them, too.
void add_libraries(Document& document, const std::vector<std::string>& files) {
  auto* members = std::get_if<JsonValue::Object>(&document.root.data);
  if (!members) return;
  for (const std::string& file : files) {
    const TextPosition at{0, 0, static_cast<std::uint32_t>(document.sources.size())};
    document.sources.push_back({"--recipes " + file, {}, true});
    if (!document.root.find("include")) members->push_back({"include", at, {JsonValue::Array{}, at}});
    for (JsonMember& m : *members)
      if (auto* list = m.key == "include" ? std::get_if<JsonValue::Array>(&m.value.data) : nullptr)
        list->push_back({std::filesystem::absolute(file).string(), at}); // where the program runs, not where the scene lies
  }
}

/// Changes of the command line: to what is included, which may be changed as well once it is there, and the rest.
struct Changes {
  std::vector<std::string> of_include, rest;

  explicit Changes(const std::vector<std::string>& set) {
    for (const std::string& assignment : set) (assignment.starts_with("include") ? of_include : rest).push_back(assignment);
  }
};

/// Brings what the scene includes into it; returns the rest of the files.
std::vector<JsonValue> include(Document& document, const AssetFolder& folder, const ReadOptions& options, ProblemList& problems) {
  apply_overrides(document, Changes(options.set).of_include, problems);
  add_libraries(document, options.libraries);
  return include_files(document, folder, problems);
}

} // namespace

std::vector<std::string> read_recipe_names(const std::string& path, const ReadOptions& options) {
  ProblemList problems;
  Document document = read_document(path, problems);
  include(document, AssetFolder(path, options.allow_paths), options, problems);
  problems.throw_if_any();
  return recipe_names(document);
}

Scene read_scene_and_trees(const std::string& path, const ReadOptions& options, Diagnostics& diagnostics, std::vector<GrownTree>& trees) {
  ProblemList problems;
  Document document = read_document(path, problems);
  const AssetFolder folder(path, options.allow_paths);
  const std::vector<JsonValue> libraries = include(document, folder, options, problems);
  if (!options.recipe.empty()) apply_recipe(document, options.recipe, problems);
  apply_overrides(document, Changes(options.set).rest, problems);

  RecordReader reader(document, folder, problems);
  Scene scene;
  reader.read(scene, document.root, ParameterRules{"the scene", {}});
  for (const JsonValue& v : libraries) check_library(v, scene, reader);
  check_names(document, problems);
  link_parts(reader.nodes(), scene, document, problems);
  if (problems.is_empty()) check_scene(scene, document, problems), check_distances(scene, problems);
  check_axes(reader.nodes(), document, problems);
  load_assets(reader, scene, options.use_cache, problems, diagnostics);
  if (problems.is_empty() && !reader.tree_makers().empty()) {
    trees = grow_trees(reader.tree_makers(), scene, problems, diagnostics);
    check_distances(scene, problems);
  }
  if (problems.is_empty()) check_size(scene, problems);
  problems.throw_if_any();
  warn_of_folds(reader.nodes(), document, diagnostics);
  reader.warn_of_unused_variables(diagnostics);

  // A picture is never black because nobody thought of light.
  if (scene.lights.empty()) scene.lights.push_back(EnvironmentLight<AnimatedMode>{});
  remove_recipes(document);
  scene.hash = hash_scene(canonical_text(document.root), reader.asset_files());
  return scene;
}

Scene read_scene(const std::string& path, const ReadOptions& options, Diagnostics& diagnostics) {
  std::vector<GrownTree> trees;
  return read_scene_and_trees(path, options, diagnostics, trees);
}

} // namespace kelpie
