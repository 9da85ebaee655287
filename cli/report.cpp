#include <algorithm>
#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>

#include "base/atomic_file.h"
#include "base/standard_streams.h"
#include "base/suggest.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/picture_options.h"
#include "cli/progress.h"
#include "cli/read_options.h"
#include "cli/report_text.h"
#include "renderer/output/sequence.h"
#include "renderer/render_frame.h"
#include "scene/reader.h"

namespace kelpie {

namespace {

struct ReportOptions {
  std::string scene, frames, subject, json, page;
  int resolution = 96, threads = 0;
  ReadOptions read;
  ProgressMode progress = ProgressMode::automatic;
  PictureOptions picture;
};

constexpr int k_thumbnail_width = 240, k_thumbnail_samples = 8, k_thumbnail_bounces = 4;
constexpr int k_bumps_width = 640;

/// The shape that is measured: the one that is named, else the only one with a field.
size_t subject_of(const Scene& scene, const ReportOptions& o) {
  std::vector<std::string_view> fields;
  std::vector<size_t> places;
  for (size_t i = 0; i < scene.shapes.size(); ++i)
    if (scene.shapes[i].field) fields.push_back(scene.shapes[i].name), places.push_back(i);
  if (fields.empty()) throw Error(ExitStatus::bad_data, "no shape has a field that could be measured", {o.scene});
  if (o.subject.empty()) {
    if (fields.size() == 1) return places[0];
    throw Error(ExitStatus::usage, fmt::format("which shape? --subject names one of {}", fmt::join(fields, ", ")));
  }
  const auto at = std::find(fields.begin(), fields.end(), o.subject);
  if (at == fields.end())
    throw Error(ExitStatus::usage, fmt::format("no shape with a field is called \"{}\"{}", o.subject, suggestion(o.subject, fields)));
  return places[size_t(at - fields.begin())];
}

/// In ascending order, all of the scene.
std::vector<int> frames_of(const Scene& scene, const ReportOptions& o) {
  const auto [first, last, fps] = scene.frames;
  std::vector<int> frames = parse_frames(o.frames.empty() ? fmt::format("{}-{}", first, last) : o.frames);
  std::sort(frames.begin(), frames.end());
  for (const int frame : frames)
    if (frame < first || frame > last)
      throw Error(ExitStatus::usage, fmt::format("-f: frame {} is not one of the scene's, which are {} to {}", frame, first, last));
  return frames;
}

/// The scene at a size of its own, as cheap as it may be.
Scene resized(Scene scene, int width) {
  const Vec2i size = scene.film.resolution;
  if (scene.detail_height == 0) scene.detail_height = size.y;
  scene.film.resolution = {width, std::max(1, int(std::lround(double(width) * size.y / size.x)))};
  return scene;
}

/// What is rendered of each frame.
class Pictures {
public:
  Pictures(const Scene& scene, size_t subject, const PictureMaker& maker) : maker_(maker), seen_(resized(scene, k_thumbnail_width)) {
    seen_.film.spp = k_thumbnail_samples, seen_.film.bounces = std::min(seen_.film.bounces, k_thumbnail_bounces);
    seen_.film.aovs = {};
    seen_.camera.shutter = 0.f; // blur would hide what pops, and takes long
    alone_ = resized(scene, k_bumps_width);
    alone_.shapes = {scene.shapes[subject]};
    alone_.lights = {};
    alone_.camera.shutter = 0.f, alone_.camera.aperture = 0.f;
    alone_.film.spp = 1, alone_.film.bounces = 0, alone_.film.filter = PixelFilter::centre, alone_.film.aovs = {Aov::N};
  }

  std::optional<Bumps> bumps(int frame) { return bumps_of(image_of(alone_, frame)); }
  Picture picture(int frame) { return maker_.make(image_of(seen_, frame)); }
  std::vector<unsigned char> png(const Picture& picture) const { return encode_png(picture, 8, maker_.is_srgb()); }

private:
  FrameImage image_of(const Scene& scene, int frame) {
    Diagnostics unused; // a dark or an empty frame is no fault of the report
    const Vec2i size = scene.film.resolution;
    return render_frame(scene, frame, {0, 0, size.x, size.y}, {environments_, unused, [](double) {}}).image;
  }

  const PictureMaker& maker_;
  Scene seen_, alone_;
  EnvironmentCache environments_;
};

/// The mean over all pixels and colours.
double difference(const Picture& a, const Picture& b) {
  double sum = 0;
  for (size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(double(a.rgb[i]) - double(b.rgb[i]));
  return sum / double(a.rgb.size());
}

MorphReport measure(const Scene& scene, const ReportOptions& o, const PictureMaker& maker) {
  const size_t subject = subject_of(scene, o);
  const std::vector<int> frames = frames_of(scene, o);
  MorphReport report;
  report.scene = o.scene, report.subject = scene.shapes[subject].name, report.resolution = o.resolution;
  Pictures pictures(scene, subject, maker);
  set_activity("finding the ends of the morph");
  MorphMeasurer measurer(scene, subject, frames, o.resolution);
  Progress progress(o.progress, double(frames.size()), "frames");
  Picture before;
  for (const int frame : frames) {
    set_activity(fmt::format("measuring frame {}", frame));
    report.frames.push_back(measurer.measure_next());
    report.bumps.push_back(pictures.bumps(frame));
    Picture picture = pictures.picture(frame);
    report.pictures.push_back(pictures.png(picture));
    if (report.frames.size() > 1) report.picture_changes.push_back(difference(before, picture));
    before = std::move(picture);
    progress.advance(double(report.frames.size()));
  }
  report.pops = find_pops(report.frames, report.picture_changes);
  return report;
}

void report(ReportOptions o) {
  const unsigned threads = o.threads > 0 ? static_cast<unsigned>(o.threads) : std::thread::hardware_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  if (o.page.empty() && o.json.empty()) o.page = std::filesystem::path(o.scene).stem().string() + ".html";
  for (const std::string& output : {o.page, o.json})
    if (!output.empty()) require_writable(output);
  const PictureMaker maker(o.picture); // a scene's colours are read by the config that it settles
  set_activity(fmt::format("reading {}", o.scene));
  Diagnostics diagnostics;
  const Scene scene = read_scene(o.scene, o.read, diagnostics);
  print_warnings(diagnostics);
  const MorphReport found = measure(scene, o, maker);
  std::vector<FileToWrite> files;
  if (!o.page.empty()) files.push_back({o.page, report_page(found)});
  if (!o.json.empty()) files.push_back({o.json, report_json(found)});
  write_files_atomically(files);
  print_result(report_summary(found));
}

} // namespace

void add_report(CLI::App& app) {
  auto options = std::make_shared<ReportOptions>();
  CLI::App& command =
      *app.add_subcommand("report", "measure a shape that changes, frame by frame: volume, parts, speed, bumps, pops (HTML, JSON)");
  command.footer(
      "Examples:\n"
      "  kelpie report flow.json                                 writes flow.html\n"
      "  kelpie report flow.json -f 1-48 --subject liquid -o flow.html --json flow.numbers.json\n"
      "A pop is a change from a frame to the next of more than 3 times the median of the ten changes around it, and more than 0.2 %.");
  command.add_option("SCENE", options->scene, "the scene file (JSON)")->required();
  command.add_option("-f,--frames", options->frames, "frames to measure: 12, 1-96, 1-96x2 [all of the scene]")->option_text("RANGES");
  command.add_option("--subject", options->subject, "the shape to measure [the only one with a field]")->option_text("SHAPE");
  command.add_option("-o,--output", options->page, "the page to write [SCENE.html in this folder, unless --json is given]")
      ->check(ends_in(".html"))
      ->option_text("OUT.html");
  command.add_option("--json", options->json, "the same numbers as JSON")->check(ends_in(".json"))->option_text("OUT.json");
  command.add_option("--resolution", options->resolution, "cells of the lattice along the longest side of all that the shape encloses")
      ->check(CLI::Range(8, 384))
      ->capture_default_str();
  command.add_option("-j,--threads", options->threads, "threads to use [all cores]")->check(CLI::Range(0, 4096));
  add_read_options(command, options->read);
  add_recipe_option(command, options->read);
  add_view_options(command, options->picture);
  add_progress_option(command, options->progress);
  command.callback([options] { report(*options); });
}

} // namespace kelpie
