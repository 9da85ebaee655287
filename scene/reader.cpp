#include "scene/reader.h"

#include "scene/check_scene.h"
#include "scene/load_assets.h"
#include "scene/overrides.h"
#include "scene/record_reader.h"

namespace kelpie {

Scene read_scene(const std::string& path, const ReadOptions& options, Diagnostics& diagnostics) {
  ProblemList problems;
  Document document = read_document(path, problems);
  apply_overrides(document, options.set, problems);

  const AssetFolder folder(path, options.allow_paths);
  RecordReader reader(document, folder, problems);
  Scene scene;
  reader.read(scene, document.root, ParameterRules{"the scene", {}});
  check_names(document, problems);
  if (problems.is_empty()) check_scene(scene, document, problems);
  load_assets(reader.nodes(), scene, document, problems, diagnostics);
  problems.throw_if_any();

  // A picture is never black because nobody thought of light.
  if (scene.lights.empty()) scene.lights.push_back(EnvironmentLight<AnimatedMode>{});
  scene.hash = hash_scene(canonical_text(document.root), reader.asset_files());
  return scene;
}

} // namespace kelpie
