#include "renderer/forecast.h"

#include <algorithm>
#include <chrono>
#include <set>

#include <sys/resource.h>
#include <tbb/task_arena.h>

#include "renderer/output/exr.h"

namespace kelpie {

namespace {

/// Samples of a trial picture: a second or so of work.
constexpr double k_trial_samples = 60000;

double resident_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// The scene with a picture of few samples.
Scene trial_of(const Scene& scene) {
  Scene trial = scene;
  Film<AnimatedMode>& film = trial.film;
  film.spp = std::min(film.spp, 4);
  trial.detail_height = film.resolution.y; // as many elements
  const double pixels = static_cast<double>(film.resolution.x) * film.resolution.y, wanted = k_trial_samples / film.spp;
  if (pixels > wanted) film.resolution = glm::max(Vec2i(8), Vec2i(glm::dvec2(film.resolution) * std::sqrt(wanted / pixels)));
  return trial;
}

/// The same part of the trial picture as `window` is of the real one.
PixelBox trial_window(const PixelBox& window, Vec2i real, Vec2i trial) {
  const auto scaled = [](int v, int from, int to) { return static_cast<int>(static_cast<int64_t>(v) * to / from); };
  PixelBox box{scaled(window.x0, real.x, trial.x), scaled(window.y0, real.y, trial.y), scaled(window.x1, real.x, trial.x),
               scaled(window.y1, real.y, trial.y)};
  box.x1 = std::max(box.x1, box.x0 + 1), box.y1 = std::max(box.y1, box.y0 + 1);
  return box;
}

} // namespace

Forecast forecast(const Scene& scene, const std::vector<int>& frames, const PixelBox& window, const FrameContext& context) {
  const Scene trial = trial_of(scene);
  const PixelBox box = trial_window(window, scene.film.resolution, trial.film.resolution);
  const double pixels = static_cast<double>(window.area()), trial_pixels = static_cast<double>(box.area());
  const double samples = pixels * scene.film.spp, trial_samples = trial_pixels * trial.film.spp;
  const std::set<int> tried{frames.front(), frames[frames.size() / 2], frames.back()};

  Forecast out;
  double channels = 0;
  for (const int frame : tried) {
    const RenderedFrame rendered = render_frame(trial, frame, box, context);
    const double cpu_before = process_cpu_s();
    decode_exr(encode_exr(rendered.image, {}).bytes, "trial");
    const double output_cpu_s = (process_cpu_s() - cpu_before) * pixels / trial_pixels;
    const double render_cpu_s = rendered.stats.render_cpu_s * samples / trial_samples;
    const double threads = tbb::this_task_arena::max_concurrency();
    out.cpu_s_per_frame += (rendered.stats.build_cpu_s + render_cpu_s + output_cpu_s) / static_cast<double>(tried.size());
    out.wall_s_per_frame += ((rendered.stats.build_cpu_s + render_cpu_s) / threads + output_cpu_s) / static_cast<double>(tried.size());
    out.elements = std::max(out.elements, rendered.stats.elements);
    out.cells = std::max(out.cells, rendered.stats.cells);
    out.engine_mb = std::max(out.engine_mb, static_cast<double>(rendered.stats.engine_bytes) / 1e6);
    out.coarsenings = std::max(out.coarsenings, rendered.stats.coarsenings);
    channels = static_cast<double>(rendered.image.channels.size());
  }
  // The film in float; encoding, checking and the file's bytes hold about twice as much again.
  out.memory_mb = resident_mb() + 3 * channels * 4 * pixels / 1e6;
  return out;
}

} // namespace kelpie
