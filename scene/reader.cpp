#include "scene/reader.h"

#include <algorithm>

#include "scene/check_axes.h"
#include "scene/check_distances.h"
#include "scene/check_scene.h"
#include "scene/include_files.h"
#include "scene/library.h"
#include "scene/link_parts.h"
#include "scene/load_assets.h"
#include "scene/overrides.h"
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

} // namespace

Scene read_scene(const std::string& path, const ReadOptions& options, Diagnostics& diagnostics) {
  ProblemList problems;
  Document document = read_document(path, problems);
  const AssetFolder folder(path, options.allow_paths);
  // What is included may be set as well, once it is there.
  const auto is_of_include = [](const std::string& assignment) { return std::string_view(assignment).substr(0, 7) == "include"; };
  std::vector<std::string> set = options.set;
  const auto rest = std::stable_partition(set.begin(), set.end(), is_of_include);
  apply_overrides(document, {set.begin(), rest}, problems);
  const std::vector<JsonValue> libraries = include_files(document, folder, problems);
  apply_overrides(document, {rest, set.end()}, problems);

  RecordReader reader(document, folder, problems);
  Scene scene;
  reader.read(scene, document.root, ParameterRules{"the scene", {}});
  for (const JsonValue& v : libraries) check_library(v, scene, reader);
  check_names(document, problems);
  link_parts(reader.nodes(), scene, document, problems);
  if (problems.is_empty()) check_scene(scene, document, problems), check_distances(scene, problems);
  check_axes(reader.nodes(), document, problems);
  load_assets(reader, scene, options.use_cache, problems, diagnostics);
  if (problems.is_empty()) check_size(scene, problems);
  problems.throw_if_any();
  warn_of_folds(reader.nodes(), document, diagnostics);

  // A picture is never black because nobody thought of light.
  if (scene.lights.empty()) scene.lights.push_back(EnvironmentLight<AnimatedMode>{});
  scene.hash = hash_scene(canonical_text(document.root), reader.asset_files());
  return scene;
}

} // namespace kelpie
