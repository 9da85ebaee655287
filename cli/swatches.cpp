#include <algorithm>
#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>

#include "base/atomic_file.h"
#include "base/file_bytes.h"
#include "base/suggest.h"
#include "base/temporary_folder.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/film_options.h"
#include "cli/picture_options.h"
#include "cli/progress.h"
#include "materials/presets.h"
#include "renderer/output/label.h"
#include "renderer/render_frame.h"
#include "scene/parameter_types.h"
#include "scene/reader.h"

namespace kelpie {

namespace {

/// The object that wears each material: a ball of which an eighth is cut out, so that a solid texture shows what it is inside, on a
/// chequered floor, which shows what is clear.
constexpr std::string_view k_scene = R"({
  "kelpie": 1,
  "camera": { "position": [1.9, 2.25, 4.6], "look_at": [0, 0.86, 0], "fov": 26 },
  "film": { "bounces": 10, "background": [0.045, 0.047, 0.05] },
  "lights": [{ "kind": "environment", "preset": "studio", "rotation": 20 },
             { "kind": "sun", "direction": [1.2, 2.2, 1.6], "strength": 1.4, "angle": 6 }],
  "shapes": [
    { "name": "object", "field": { "kind": "difference", "children": [
      { "kind": "sdf_sphere", "centre": [0, 0.9, 0], "sphere_radius": 0.9 },
      { "kind": "sdf_box", "centre": [0.72, 1.62, 0.72], "size": [1.2, 1.2, 1.2], "rounding": 0.04 }] } },
    { "name": "floor", "geometry": { "kind": "plane" },
      "surface": { "kind": "checker", "size": 0.45, "stops": [
        { "at": 0, "material": { "kind": "matte", "colour": [0.09, 0.095, 0.1] } },
        { "at": 1, "material": { "kind": "matte", "colour": [0.30, 0.30, 0.31] } }] } }]
})";

struct SwatchOptions {
  std::vector<std::string> names;
  std::string materials, output;
  int columns = 6, width = 200, spp = 64, threads = 0;
  std::vector<std::string> allow_paths;
  ProgressMode progress = ProgressMode::automatic;
  PictureOptions picture;
};

/// A material as a scene has it: by name, or as its kind is by default.
struct Swatch {
  std::string name, json;
};

/// All that can be shown: what the file has if there is one, else every pattern, every surface and every preset.
std::vector<Swatch> all_swatches(const Scene& scene, bool has_file) {
  std::vector<Swatch> all;
  if (has_file) {
    for (const auto& [name, material] : scene.materials) all.push_back({name, fmt::format("\"{}\"", name)});
    return all;
  }
  for (const std::string_view kind : kind_names<Concat<PatternKinds, SurfaceKinds>>())
    all.push_back({std::string(kind), fmt::format(R"({{"kind":"{}"}})", kind)});
  for (const Preset& preset : k_presets) all.push_back({std::string(preset.name), fmt::format("\"{}\"", preset.name)});
  return all;
}

std::vector<Swatch> chosen(const std::vector<Swatch>& all, const std::vector<std::string>& names) {
  if (names.empty()) return all;
  std::vector<std::string_view> known;
  for (const Swatch& s : all) known.push_back(s.name);
  std::vector<Swatch> some;
  for (const std::string& name : names) {
    const auto at = std::find(known.begin(), known.end(), name);
    if (at == known.end()) throw Error(ExitStatus::usage, fmt::format("no material is called \"{}\"{}", name, suggestion(name, known)));
    some.push_back(all[size_t(at - known.begin())]);
  }
  return some;
}

/// The sheet, filled swatch by swatch, each with its name below.
class SwatchSheet {
public:
  SwatchSheet(size_t count, const SwatchOptions& o)
      : columns_(std::min(o.columns, static_cast<int>(count))), width_(o.width), gap_(std::max(4, o.width / 25)),
        text_(std::max(9, o.width / 14)) {
    const int rows = (static_cast<int>(count) + columns_ - 1) / columns_;
    picture_ = {columns_ * (width_ + gap_) + gap_, rows * row_height() + gap_, {}, false};
    picture_.rgb.assign(picture_.pixel_count() * 3, k_paper);
  }

  void place(size_t index, const Picture& swatch, const std::string& name) {
    const int left = gap_ + static_cast<int>(index) % columns_ * (width_ + gap_);
    const int top = gap_ + static_cast<int>(index) / columns_ * row_height();
    paste(picture_, swatch, left, top);
    write_label(picture_, name, left + width_ / 2, top + width_ + text_ + text_ / 4, text_, k_ink);
  }
  const Picture& picture() const { return picture_; }

private:
  static constexpr float k_paper = 0.1f, k_ink = 0.85f; // display-referred

  int row_height() const { return width_ + gap_ + 2 * text_; }

  int columns_, width_, gap_, text_;
  Picture picture_;
};

/// `options`: of the scene, but for the material.
Picture render_swatch(const std::string& scene_path, const Swatch& swatch, ReadOptions options, EnvironmentCache& environments,
                      const PictureMaker& maker) {
  Diagnostics diagnostics;
  options.set.push_back("shapes.object.surface=" + swatch.json);
  const Scene scene = read_scene(scene_path, options, diagnostics);
  const Vec2i size = scene.film.resolution;
  const RenderedFrame frame = render_frame(scene, 1, {0, 0, size.x, size.y}, {environments, diagnostics, [](double) {}});
  print_warnings(diagnostics);
  return maker.make(frame.image);
}

void make_swatches(const SwatchOptions& o) {
  set_activity("drawing swatches");
  require_writable(o.output);
  const PictureMaker maker(o.picture);
  const unsigned threads = o.threads > 0 ? static_cast<unsigned>(o.threads) : std::thread::hardware_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);

  TemporaryFolder folder;
  const std::string scene_path = folder.file("swatch.json");
  write_file_atomically(scene_path, as_bytes(k_scene));
  ReadOptions options{{fmt::format("film.resolution=[{0},{0}]", o.width), fmt::format("film.spp={}", o.spp)}, o.allow_paths};
  if (!o.materials.empty()) {
    const std::filesystem::path file = std::filesystem::absolute(o.materials);
    if (!std::filesystem::exists(file)) throw Error(ExitStatus::missing_input, "does not exist", {o.materials});
    options.set.push_back("include=" + nlohmann::json{file.string()}.dump());
    options.allow_paths.push_back(file.parent_path().string());
  }
  Diagnostics diagnostics;
  const Scene scene = read_scene(scene_path, options, diagnostics);
  if (!has_font()) diagnostics.warning({}, "no font was found for the names of the swatches (Debian: fonts-dejavu-core)");
  print_warnings(diagnostics);
  const std::vector<Swatch> swatches = chosen(all_swatches(scene, !o.materials.empty()), o.names);
  if (swatches.empty()) throw Error(ExitStatus::bad_data, fmt::format("{} has no materials", o.materials));

  SwatchSheet sheet(swatches.size(), o);
  EnvironmentCache environments;
  Progress progress(o.progress, static_cast<double>(swatches.size()), "swatches");
  for (size_t i = 0; i < swatches.size(); ++i) {
    sheet.place(i, render_swatch(scene_path, swatches[i], options, environments, maker), swatches[i].name);
    progress.advance(static_cast<double>(i + 1), swatches[i].name);
  }
  write_file_atomically(o.output, encode_png(sheet.picture(), 8, maker.is_srgb()));
}

} // namespace

void add_swatches(CLI::App& app) {
  auto options = std::make_shared<SwatchOptions>();
  CLI::App& command = *app.add_subcommand("swatches", "draw materials on one page, side by side (PNG)");
  command.footer("Examples:\n"
                 "  kelpie swatches -o all.png                          every pattern, surface and preset\n"
                 "  kelpie swatches marble wood gold -o some.png        some of them\n"
                 "  kelpie swatches -m examples/parts/metals.json -o metals.png    the materials of a library");
  command.add_option("NAMES", options->names, "kinds of patterns and surfaces, presets, or materials of the library [all]");
  command.add_option("-m,--materials", options->materials, "a library (`kelpie kinds library`): its materials instead of kelpie's")
      ->option_text("FILE.json");
  command.add_option("-o,--output", options->output, "the picture to write")->required()->check(ends_in(".png"))->option_text("SHEET.png");
  command.add_option("--columns", options->columns, "swatches side by side")->check(CLI::Range(1, 100))->capture_default_str();
  command.add_option("--width", options->width, "of each swatch, pixels")->check(CLI::Range(16, 2048))->capture_default_str();
  command.add_option("--spp", options->spp, "samples a pixel")->check(CLI::Range(1, 65536))->capture_default_str();
  command.add_option("-j,--threads", options->threads, "threads to use [all cores]")->check(CLI::Range(0, 4096));
  command.add_option("--allow-path", options->allow_paths, "a folder outside the library's that it may read files from");
  add_view_options(command, options->picture);
  add_progress_option(command, options->progress);
  command.callback([options] { make_swatches(*options); });
}

} // namespace kelpie
