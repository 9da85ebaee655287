#include <algorithm>
#include <cstdio>
#include <filesystem>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include "base/temporary_folder.h"
#include "cli/command.h"
#include "cli/film_options.h"
#include "cli/fit_options.h"
#include "cli/liquid_end.h"
#include "cli/liquid_scene.h"
#include "cli/number_check.h"
#include "cli/render.h"
#include "materials/presets.h"
#include "renderer/output/sequence.h"
#include "scene/parameter_types.h"

namespace kelpie {

namespace {

struct LiquidArguments : FitCommandOptions {
  std::string from, to, from_up = "+y", to_up = "+y", turn = "auto", ends = "mesh", surface = "metal", camera = "orbit", save_scene;
  RenderOptions render;
};

std::string stem_of(const std::string& path) { return std::filesystem::path(path).stem().string(); }

/// Usage errors come before minutes of work.
void check_usage(const RenderOptions& o, const LiquidSceneOptions& scene) {
  Film<AnimatedMode> film;
  apply_film_options(o, film);
  if (o.output.empty()) return;
  require_numbered(FramePattern(o.output), parse_frames(o.frames.value_or(fmt::format("{}-{}", scene.first, scene.last))));
}

/// The frames asked for span the morph; a single one is a frame of the usual length.
LiquidSceneOptions scene_options(const LiquidArguments& o) {
  LiquidSceneOptions s;
  s.surface = o.surface;
  for (const auto& [name, move] : EnumNames<CameraMove>::values)
    if (name == o.camera) s.camera = move;
  s.ends_are_meshes = o.ends == "mesh";
  if (o.render.frames) {
    const std::vector<int> frames = parse_frames(*o.render.frames);
    const auto [first, last] = std::minmax_element(frames.begin(), frames.end());
    const bool is_one = *first == *last;
    s.first = is_one ? std::min(*first, s.first) : *first;
    s.last = is_one ? std::max(*last, s.last) : *last;
  }
  int width = 0, height = 0;
  if (std::sscanf(o.render.resolution.c_str(), "%dx%d", &width, &height) == 2 && width > 0 && height > 0) s.aspect = double(width) / height;
  return s;
}

LiquidEnd make_end(const std::string& path, const std::string& up, const FitCommandOptions& o) {
  LiquidEnd end{path, o.weld, {}, fit_and_report(path, o).blobs, {up}};
  Diagnostics quiet; // what there is to say was said when blobs were fitted
  end.mesh = load_mesh(path, quiet, {o.weld});
  return end;
}

void make_both(const LiquidArguments& o, LiquidEnd& from, LiquidEnd& to) {
  const int threads = o.render.threads > 0 ? o.render.threads : tbb::this_task_arena::max_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads));
  tbb::parallel_invoke([&] { from = make_end(o.from, o.from_up, o); }, [&] { to = make_end(o.to, o.to_up, o); });
  place_together(from, to, o.turn == "auto" ? std::optional<double>() : std::stod(o.turn));
}

void liquid(const LiquidArguments& o) {
  const LiquidSceneOptions options = scene_options(o);
  check_usage(o.render, options);
  if (!o.save_scene.empty()) require_writable(o.save_scene);
  LiquidEnd from, to;
  make_both(o, from, to);
  const std::string name = stem_of(o.from) + "_to_" + stem_of(o.to);
  if (!o.save_scene.empty()) {
    write_files_atomically(liquid_scene_files(o.save_scene, from, to, options));
    if (!o.render.output.empty()) render_scene(o.save_scene, name, o.render);
    return;
  }
  TemporaryFolder folder;
  std::vector<FileToWrite> files = liquid_scene_files("liquid.json", from, to, options);
  for (FileToWrite& f : files) f.target = folder.file(f.target.string());
  write_files_atomically(files);
  render_scene(files.back().target.string(), name, o.render);
}

} // namespace

void add_liquid(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("liquid", "turn one mesh into another as liquid, and render it");
  auto options = std::make_shared<LiquidArguments>();
  const CLI::IsMember is_axis(std::vector<std::string>(std::begin(k_up_axes), std::end(k_up_axes)));
  command.add_option("FROM", options->from, "the mesh at the beginning: OBJ, PLY, OFF or STL")->required();
  command.add_option("TO", options->to, "the mesh at the end")->required();
  add_fit_options(command, *options);
  command.add_option("--from-up", options->from_up, "the direction that is up in the first mesh")->check(is_axis)->capture_default_str();
  command.add_option("--to-up", options->to_up, "the direction that is up in the second mesh")->check(is_axis)->capture_default_str();
  command
      .add_option("--turn", options->turn,
                  "how far the second mesh is turned about the vertical: degrees, or `auto`: so that it lies best in the first")
      ->check([](const std::string& text) { return text == "auto" ? std::string() : number_between(-360, 360)(text); })
      ->capture_default_str();
  command
      .add_option("--ends", options->ends,
                  "what it is at either end: `mesh`: the mesh itself, which melts and sets; `fit`: the blobs fitted to it")
      ->check(CLI::IsMember({"mesh", "fit"}))
      ->capture_default_str();
  std::vector<std::string> materials;
  for (const std::string_view kind : kind_names<PlainMaterialKinds>()) materials.emplace_back(kind);
  for (const Preset& preset : k_presets) materials.emplace_back(preset.name);
  command.add_option("--surface", options->surface, "what it is made of: a surface, a preset or a pattern (`kelpie swatches`)")
      ->check(CLI::IsMember(materials))
      ->capture_default_str();
  std::vector<std::string> moves;
  for (const auto& [name, move] : EnumNames<CameraMove>::values) moves.emplace_back(name);
  command
      .add_option("--camera", options->camera,
                  "how the camera follows: orbit (a slow arc), dolly (a slow approach) or still (one place for the whole morph)")
      ->check(CLI::IsMember(moves))
      ->capture_default_str();
  command
      .add_option("--save-scene", options->save_scene,
                  "write the scene to edit, and its clouds beside it; rendered as well only where -o says so")
      ->check(ends_in(".json"));
  add_render_options(command, options->render);
  command.footer(
      "Examples:\n"
      "  kelpie liquid bunny.obj armadillo.obj -f 1-96 -o 'out/flow.####.exr'\n"
      "  kelpie liquid drop.ply dino.off --to-up +z --save-scene flow.json\n"
      "The morph lasts from the first to the last of the frames; to render some of them only, save the scene, or --skip-existing.");
  command.callback([options, &command] {
    options->no_cache = command.count("--no-cache") > 0;
    const bool is_bar = options->render.progress == ProgressMode::automatic || options->render.progress == ProgressMode::bar;
    options->progress = is_bar ? ProgressMode::plain : options->render.progress; // two fits at once cannot share a bar
    liquid(*options);
  });
}

} // namespace kelpie
