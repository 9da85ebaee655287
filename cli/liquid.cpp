#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "base/parallel.h"
#include "base/temporary_folder.h"
#include "cli/command.h"
#include "cli/film_options.h"
#include "cli/fit_options.h"
#include "cli/liquid_end.h"
#include "cli/liquid_scene.h"
#include "cli/number_check.h"
#include "cli/render.h"
#include "colour/spaces.h"
#include "materials/presets.h"
#include "renderer/output/sequence.h"
#include "scene/parameter_types.h"

namespace kelpie {

namespace {

struct LiquidArguments : FitCommandOptions {
  std::vector<std::string> meshes, up;
  std::string from_up, to_up, turn = "auto", ends = "mesh", surface = "metal", camera = "orbit", save_scene;
  bool is_loop = false;
  RenderOptions render;
};

constexpr const char* k_usual_up = "+y";
constexpr int k_frames_of_passage = 96;

/// What is up in each mesh.
std::vector<std::string> ups_of(const LiquidArguments& o) {
  const size_t count = o.meshes.size();
  if (!o.from_up.empty() || !o.to_up.empty()) {
    if (!o.up.empty()) throw Error(ExitStatus::usage, "--from-up and --to-up say what --up says: use one or the other");
    if (count != 2)
      throw Error(ExitStatus::usage, fmt::format("--from-up and --to-up are of two meshes, not of {}: say --up once for each", count));
    const auto or_usual = [](const std::string& up) { return up.empty() ? std::string(k_usual_up) : up; };
    return {or_usual(o.from_up), or_usual(o.to_up)};
  }
  if (o.up.size() < 2) return std::vector<std::string>(count, o.up.empty() ? k_usual_up : o.up[0]);
  if (o.up.size() != count)
    throw Error(ExitStatus::usage,
                fmt::format("--up: say it once for all, or once for each of the {} meshes; found {}", count, o.up.size()));
  return o.up;
}

/// What the frames are called.
std::string name_of(const std::vector<LiquidEnd>& ends, bool is_loop) {
  constexpr size_t k_longest = 100;
  std::string name = ends[0].name;
  for (size_t i = 1; i < ends.size(); ++i) name += "_to_" + ends[i].name;
  if (name.size() > k_longest) name = ends.front().name + "_to_" + ends.back().name;
  return is_loop ? name + "_loop" : name;
}

/// Usage errors come before minutes of work.
void check_usage(const LiquidArguments& o, const LiquidSceneOptions& scene) {
  Film<AnimatedMode> film;
  apply_film_options(o.render, film);
  const size_t passages = scene.passages(o.meshes.size());
  if (size_t(scene.length()) < passages)
    throw Error(ExitStatus::usage, fmt::format("{} meshes{} take at least {} frames: -f says {} to {}", o.meshes.size(),
                                               o.is_loop ? " in a loop" : "", passages + (o.is_loop ? 0 : 1), scene.first, scene.last));
  if (o.render.output.empty()) return;
  require_numbered(FramePattern(o.render.output), parse_frames(o.render.frames.value_or(fmt::format("{}-{}", scene.first, scene.last))));
}

/// The frames asked for span the morph; a single one is a frame of the usual length.
LiquidSceneOptions scene_options(const LiquidArguments& o) {
  LiquidSceneOptions s;
  s.surface = o.surface;
  for (const auto& [name, move] : EnumNames<CameraMove>::values)
    if (name == o.camera) s.camera = move;
  s.ends_are_meshes = o.ends == "mesh", s.is_loop = o.is_loop;
  s.last = k_frames_of_passage * int(s.passages(o.meshes.size()));
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

LiquidEnd make_end(const MeshSource& source, const std::string& up, const FitCommandOptions& o) {
  LiquidEnd end{source.path, source.name, o.weld, {}, fit_and_report(source, o).blobs, {up}};
  Diagnostics quiet; // what there is to say was said when blobs were fitted
  end.mesh = load_mesh(source.path, quiet, {o.weld});
  return end;
}

/// The files of meshed shapes are those of `sources`.
std::vector<LiquidEnd> make_ends(const LiquidArguments& o, const std::vector<std::string>& ups, MeshSources& sources) {
  const int threads = o.render.threads > 0 ? o.render.threads : tbb::this_task_arena::max_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads));
  std::vector<MeshSource> meshes;
  for (const std::string& mesh : o.meshes) meshes.push_back(sources.resolve(mesh));
  std::vector<LiquidEnd> ends(meshes.size());
  parallel_for(size_t{0}, ends.size(), [&](size_t i) { ends[i] = make_end(meshes[i], ups[i], o); });
  place_together(ends, o.turn == "auto" ? std::optional<double>() : std::stod(o.turn));
  return ends;
}

void liquid(const LiquidArguments& o) {
  const LiquidSceneOptions options = scene_options(o);
  const std::vector<std::string> ups = ups_of(o);
  check_usage(o, options);
  if (!o.save_scene.empty()) require_writable(o.save_scene);
  use_ocio_config(o.render.ocio);
  MeshSources sources(o.render.read);
  const std::vector<LiquidEnd> ends = make_ends(o, ups, sources);
  const std::string name = name_of(ends, o.is_loop);
  if (!o.save_scene.empty()) {
    write_files_atomically(liquid_scene_files(o.save_scene, ends, options));
    if (!o.render.output.empty()) render_scene(o.save_scene, name, o.render);
    return;
  }
  TemporaryFolder folder;
  std::vector<FileToWrite> files = liquid_scene_files("liquid.json", ends, options);
  for (FileToWrite& f : files) f.target = folder.file(f.target.string());
  write_files_atomically(files);
  render_scene(files.back().target.string(), name, o.render);
}

} // namespace

void add_liquid(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("liquid", "turn one mesh into another as liquid, and that into the next, and render it");
  auto options = std::make_shared<LiquidArguments>();
  const CLI::IsMember is_axis(std::vector<std::string>(std::begin(k_up_axes), std::end(k_up_axes)));
  command.add_option("MESH", options->meshes, fmt::format("two meshes or more, one after the other: {}", k_mesh_sources))
      ->required()
      ->expected(2, 10'000)
      ->option_text("MESH...");
  add_fit_options(command, *options);
  command.add_flag("--loop", options->is_loop, "the last mesh becomes the first: the frames can be played over and over");
  command.add_option("--up", options->up, "the direction that is up in all meshes, or once for each, in their order [+y]")
      ->check(is_axis)
      ->allow_extra_args(false)
      ->option_text("AXIS ...");
  command.add_option("--from-up", options->from_up, "of two meshes: what is up in the first [+y]")->check(is_axis);
  command.add_option("--to-up", options->to_up, "of two meshes: what is up in the second [+y]")->check(is_axis);
  command
      .add_option("--turn", options->turn,
                  "how far all meshes but the first are turned about the vertical: degrees, or `auto`: so that each lies best in the one "
                  "before")
      ->check([](const std::string& text) { return text == "auto" ? std::string() : number_between(-360, 360)(text); })
      ->capture_default_str();
  command
      .add_option("--ends", options->ends,
                  "what it is at each mesh: `mesh`: the mesh itself, which melts and sets; `fit`: the blobs fitted to it")
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
      .add_option(
          "--camera", options->camera,
          "how the camera follows: orbit (a slow arc), dolly (a slow approach) or still (one place for the whole morph); in a loop it "
          "comes back")
      ->check(CLI::IsMember(moves))
      ->capture_default_str();
  command
      .add_option("--save-scene", options->save_scene,
                  "write the scene to edit, and its clouds beside it; rendered as well only where -o says so")
      ->check(ends_in(".json"));
  add_render_options(command, options->render);
  command.footer("Examples:\n"
                 "  kelpie liquid bunny.obj armadillo.obj -f 1-96 -o 'out/flow.####.exr'\n"
                 "  kelpie liquid drop.ply dino.off --to-up +z --save-scene flow.json\n"
                 "  kelpie liquid vases.json:amphora bunny.obj dolphin.json --loop -f 1-240 -o 'out/loop.####.exr'\n"
                 "The morph lasts from the first to the last of the frames, the same for each passage; in a loop the frame after the last "
                 "is the first.\n"
                 "To render some frames only, save the scene, or --skip-existing.");
  command.callback([options, &command] {
    options->no_cache = command.count("--no-cache") > 0;
    const bool is_bar = options->render.progress == ProgressMode::automatic || options->render.progress == ProgressMode::bar;
    options->progress = is_bar ? ProgressMode::plain : options->render.progress; // two fits at once cannot share a bar
    liquid(*options);
  });
}

} // namespace kelpie
