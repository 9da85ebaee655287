#include <thread>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "base/standard_streams.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/film_options.h"
#include "cli/heartbeat.h"
#include "colour/spaces.h"
#include "renderer/check_surfaces.h"
#include "renderer/forecast.h"
#include "renderer/output/sequence.h"
#include "scene/reader.h"

namespace kelpie {

namespace {

bool is_built(const Forecast& f) { return f.stopped == Forecast::Stopped::no || f.stopped == Forecast::Stopped::rendering_out_of_time; }

std::string shapes_line(const Forecast& f, const Scene& scene) {
  if (!is_built(f)) return fmt::format("shapes    {}\n", scene.shapes.size());
  return fmt::format("shapes    {}, of up to {} element{} in {} cell{}\n", scene.shapes.size(), f.elements, f.elements == 1 ? "" : "s",
                     f.cells, f.cells == 1 ? "" : "s");
}

/// What a frame costs, or by which of its shapes it costs too much to be found out.
std::string cost_lines(const Forecast& f, const Scene& scene, size_t frames, unsigned threads) {
  std::string report;
  if (f.stopped == Forecast::Stopped::building_out_of_time)
    report += fmt::format("time      not forecast: building takes longer than {:.0f} s\n", k_trial_s);
  else if (f.stopped == Forecast::Stopped::building_out_of_memory)
    report += fmt::format("memory    not forecast: building takes more than {:.0f} MB\n", double(k_most_trial_bytes) / 1e6);
  if (is_built(f)) {
    report += fmt::format("time      about {:.3g} s a frame on {} thread{} ({:.3g} s of CPU); {} in all\n", f.wall_s_per_frame, threads,
                          threads == 1 ? "" : "s", f.cpu_s_per_frame, format_duration(f.wall_s_per_frame * static_cast<double>(frames)));
    report += fmt::format("memory    about {:.0f} MB, of it {:.3g} MB for what is built of a frame\n", f.memory_mb, f.engine_mb);
  }
  if (f.coarsenings > 0) report += fmt::format("          with cells {} times as long, to fit into --max-memory\n", 1 << f.coarsenings);
  if (f.costliest.bytes > 0) report += fmt::format("costliest {}\n", describe(f.costliest, scene));
  return report;
}

void check(const std::string& path, const RenderOptions& options) {
  const unsigned threads = options.threads > 0 ? static_cast<unsigned>(options.threads) : std::thread::hardware_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  use_ocio_config(options.ocio);
  set_activity(fmt::format("reading {}", path));
  Diagnostics diagnostics;
  Heartbeat reading(ProgressMode::automatic, fmt::format("reading {}", path));
  Scene scene = read_scene(path, options.read, diagnostics);
  reading.stop();
  const PixelBox window = apply_film_options(options, scene.film);
  const std::vector<int> frames = parse_frames(options.frames.value_or(fmt::format("{}-{}", scene.frames.first, scene.frames.last)));

  warn_of_missing_surfaces(scene, frames, diagnostics);
  EnvironmentCache environments;
  const std::function<void(double)> silent = [](double) {};
  set_activity("forecasting");
  const Forecast f = forecast(scene, frames, window, {environments, diagnostics, silent, options.max_memory});
  print_warnings(diagnostics);
  std::string report = fmt::format("{}: good\n", path);
  report += fmt::format("picture   {} frame{}, {}x{}, {} samples per pixel, {} bounces\n", frames.size(), frames.size() == 1 ? "" : "s",
                        scene.film.resolution.x, scene.film.resolution.y, scene.film.spp, scene.film.bounces);
  report += shapes_line(f, scene);
  if (!scene.parts.empty()) report += fmt::format("parts     {}\n", scene.parts.size());
  report += cost_lines(f, scene, frames.size(), threads);
  print_result(report);
}

} // namespace

void add_check(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("check", "read a scene, report all its problems, and forecast time and memory");
  auto options = std::make_shared<RenderOptions>();
  auto path = std::make_shared<std::string>();
  command.add_option("SCENE", *path, "the scene file (JSON)")->required();
  command.add_option("-f,--frames", options->frames, "the frames that would be rendered [all of the scene]");
  add_film_options(command, *options);
  command.add_option("-j,--threads", options->threads, "threads that would be used [all cores]")->check(CLI::Range(0, 4096));
  command.callback([=] { check(*path, *options); });
}

} // namespace kelpie
