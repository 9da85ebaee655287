#include "renderer/forecast.h"

#include <algorithm>
#include <chrono>
#include <mutex>
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

/// Forecasts one frame after another.
class Forecaster {
public:
  Forecaster(const Scene& scene, const PixelBox& window, const FrameContext& context)
      : trial_(trial_of(scene)), box_(trial_window(window, scene.film.resolution, trial_.film.resolution)), context_(context),
        pixels_(static_cast<double>(window.area())), trial_pixels_(static_cast<double>(box_.area())),
        samples_(pixels_ * scene.film.spp / (trial_pixels_ * trial_.film.spp)) {
    limits_.deadline = BuildBudget::Clock::now() + std::chrono::milliseconds(static_cast<int>(1000 * k_trial_s));
    limits_.most_bytes = k_most_trial_bytes;
  }

  /// False where it takes too much: the forecast then says what.
  bool try_frame(int frame) {
    limits_.stats = {};
    std::mutex mutex;
    double rendered = 0; // the part of the picture
    const std::function<void(double)> progress = [&](double part) {
      if (const std::lock_guard lock(mutex); (rendered += part) < 1 && BuildBudget::Clock::now() > limits_.deadline)
        throw RenderedForLong{};
    };
    const double cpu_before = process_cpu_s();
    try {
      const RenderedFrame done = render_frame(
          trial_, frame, box_, {context_.environments, context_.diagnostics, progress, context_.max_memory, nullptr, &limits_});
      const double cpu_rendered = process_cpu_s();
      decode_exr(encode_exr(done.image, {}).bytes, "trial");
      add(done.stats.render_cpu_s, (process_cpu_s() - cpu_rendered) * pixels_ / trial_pixels_);
      channels_ = static_cast<double>(done.image.channels.size());
      return true;
    } catch (const BuildBudget::OutOfMemory& e) {
      stop(Forecast::Stopped::building_out_of_memory, e.costliest);
    } catch (const BuildBudget::OutOfTime& e) {
      stop(Forecast::Stopped::building_out_of_time, e.costliest);
    } catch (const RenderedForLong&) {
      stop(Forecast::Stopped::rendering_out_of_time, limits_.stats.costliest);
      add((process_cpu_s() - cpu_before - limits_.stats.build_cpu_s) / std::max(rendered, 1e-3), 0);
    }
    return false;
  }

  Forecast result() {
    // The film in float; encoding, checking and the file's bytes hold about twice as much again.
    out_.memory_mb = resident_mb() + 3 * channels_ * 4 * pixels_ / 1e6;
    if (tried_ > 0) out_.cpu_s_per_frame /= tried_, out_.wall_s_per_frame /= tried_;
    return out_;
  }

private:
  struct RenderedForLong {};

  void add(double trial_cpu_s, double output_cpu_s) {
    const FrameStats& stats = limits_.stats;
    const double threads = tbb::this_task_arena::max_concurrency(), render_cpu_s = trial_cpu_s * samples_;
    out_.cpu_s_per_frame += stats.build_cpu_s + render_cpu_s + output_cpu_s;
    out_.wall_s_per_frame += (stats.build_cpu_s + render_cpu_s) / threads + output_cpu_s;
    out_.elements = std::max(out_.elements, stats.elements);
    out_.cells = std::max(out_.cells, stats.cells);
    out_.engine_mb = std::max(out_.engine_mb, static_cast<double>(stats.engine_bytes) / 1e6);
    out_.coarsenings = std::max(out_.coarsenings, stats.coarsenings);
    note(stats.costliest);
    ++tried_;
  }
  void stop(Forecast::Stopped how, const BuildBudget::Share& costliest) {
    out_.stopped = how;
    note(costliest);
  }
  void note(const BuildBudget::Share& costliest) {
    if (costliest.bytes > out_.costliest.bytes) out_.costliest = costliest;
  }

  Scene trial_;
  PixelBox box_;
  const FrameContext& context_;
  double pixels_, trial_pixels_, samples_; ///< the last: of the picture for each of the trial
  FrameTrial limits_;
  Forecast out_;
  double tried_ = 0, channels_ = 4;
};

} // namespace

Forecast forecast(const Scene& scene, const std::vector<int>& frames, const PixelBox& window, const FrameContext& context) {
  Forecaster forecaster(scene, window, context);
  for (const int frame : std::set<int>{frames.front(), frames[frames.size() / 2], frames.back()})
    if (!forecaster.try_frame(frame)) break;
  return forecaster.result();
}

} // namespace kelpie
