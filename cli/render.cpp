#include "cli/render.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include "base/atomic_file.h"
#include "base/memory_limit.h"
#include "cli/background_task.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/film_options.h"
#include "cli/heartbeat.h"
#include "cli/progress.h"
#include "cli/stats.h"
#include "colour/spaces.h"
#include "renderer/check_surfaces.h"
#include "renderer/output/camera_matrices.h"
#include "renderer/output/exr.h"
#include "renderer/output/sequence.h"
#include "renderer/render_frame.h"
#include "scene/reader.h"

namespace kelpie {

namespace {

std::vector<int> frames_to_render(const Scene& scene, const std::optional<std::string>& ranges) {
  return parse_frames(ranges.value_or(fmt::format("{}-{}", scene.frames.first, scene.frames.last)));
}

/// Frames of the scene, one by one: each is written while the next is rendered.
class SequenceRenderer {
public:
  SequenceRenderer(Scene scene, const FramePattern& pattern, const PixelBox& window, std::string hash, const RenderOptions& options,
                   Progress& progress)
      : scene_(std::move(scene)), pattern_(pattern), window_(window), hash_(std::move(hash)), options_(options), progress_(progress) {}

  void render(int frame) {
    auto job = std::make_shared<Job>();
    job->frame = frame, job->path = pattern_.path(frame), job->key = hash_ + "#" + std::to_string(frame);
    if (options_.skip_existing && frame_is_complete(job->path, job->key)) {
      finish_writing();
      ++rendered_;
      progress_.advance(++written_, fmt::format("{}: exists", job->path));
      return;
    }
    try {
      render(*job);
    } catch (...) {
      finish_writing(); // what failed there did so earlier
      throw;
    }
    ++rendered_;
    finish_writing();
    frame_in_flight_ = frame;
    writing_.start([this, job] { write(*job); });
    if (is_large(job->rendered.image)) finish_writing();
  }

  /// What remains to be written.
  void finish_writing() {
    try {
      writing_.wait();
    } catch (...) {
      set_activity(fmt::format("rendering frame {}", frame_in_flight_));
      throw;
    }
  }

  const std::vector<FrameReport>& reports() const { return reports_; }

private:
  /// A frame on its way to its file.
  struct Job {
    int frame = 0;
    std::string path, key;
    Diagnostics diagnostics;
    RenderedFrame rendered;
  };
  struct WritingHasFailed {};

  /// Two pictures at a time, and what it takes to encode one, must not be what a frame lacks.
  static bool is_large(const FrameImage& image) {
    return 3 * sizeof(float) * image.channels.size() * image.data_window.area() > usable_memory() / 8;
  }

  void render(Job& job) {
    std::atomic<double> share{0};
    Heartbeat building(options_.progress, fmt::format("building frame {}", job.frame));
    const auto progress = [&](double part) {
      if (writing_.has_failed()) throw WritingHasFailed();
      building.stop();
      double before = share;
      while (!share.compare_exchange_weak(before, before + part)) {
      }
      // No frame counts as done before it is written.
      progress_.advance(std::min(rendered_ + std::min(1.0, before + part) * 0.999, written_ + 0.999));
    };
    set_activity(fmt::format("rendering frame {}", job.frame));
    job.rendered = render_frame(scene_, job.frame, window_, {environments_, job.diagnostics, progress, options_.max_memory, &kept_});
  }

  void write(Job& job) {
    const AsideThread aside;
    const double cpu_before = thread_cpu_s();
    const FrameImage& image = job.rendered.image;
    const CameraMatrices matrices = camera_matrices(job.rendered.camera, image.resolution);
    const EncodedFrame encoded = write_exr(
        job.path, image, {job.frame, scene_.frames.fps, job.key, scene_.meta.text, matrices.camera_from_world, matrices.ndc_from_world});
    if (encoded.clamped > 0)
      job.diagnostics.warning({job.path, 0, 0},
                              fmt::format("{} values above 65504 were clamped to the range of half floats", encoded.clamped));
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    reports_.push_back({job.rendered.stats, thread_cpu_s() - cpu_before, static_cast<double>(usage.ru_maxrss) / 1024});
    for (const Problem& p : job.diagnostics.warnings()) progress_.print_line("warning: " + to_string(p));
    progress_.advance(++written_, fmt::format("wrote {}", job.path));
  }

  Scene scene_;
  const FramePattern& pattern_;
  PixelBox window_;
  std::string hash_;
  const RenderOptions& options_;
  Progress& progress_;
  EnvironmentCache environments_;
  KeptScenes kept_;
  int rendered_ = 0;
  std::atomic<int> written_{0};
  std::vector<FrameReport> reports_; // written by who writes; read when that is done
  int frame_in_flight_ = 0;
  BackgroundTask writing_; // last: it uses the rest
};

} // namespace

void add_render_options(CLI::App& command, RenderOptions& o) {
  command.add_option("-f,--frames", o.frames, "frames to render: 12, 1-96, 1-96x2 (every second), 1-48,96 [all of the scene]");
  command.add_option("-o,--output", o.output, "where they go, with a place for the frame number: 'out/name.####.exr' [NAME.####.exr]")
      ->check(ends_in(".exr"));
  add_film_options(command, o);
  command.add_option("-j,--threads", o.threads, "threads to use [all cores]")->check(CLI::Range(0, 4096));
  command.add_flag("--skip-existing", o.skip_existing, "keep frames that exist, are whole, and are of this very scene");
  command.add_option("--stats", o.stats, "write times and counts to a JSON file");
  add_progress_option(command, o.progress);
}

void render_scene(const std::string& scene_path, const std::string& name, const RenderOptions& options) {
  set_activity(fmt::format("reading {}", scene_path));
  const unsigned threads = options.threads > 0 ? static_cast<unsigned>(options.threads) : std::thread::hardware_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  use_ocio_config(options.ocio);

  Diagnostics diagnostics;
  Heartbeat reading(options.progress, fmt::format("reading {}", scene_path));
  Scene scene = read_scene(scene_path, options.read, diagnostics);
  reading.stop();
  print_warnings(diagnostics);
  const PixelBox window = apply_film_options(options, scene.film);
  const std::vector<int> frames = frames_to_render(scene, options.frames);
  const FramePattern pattern(options.output.empty() ? name + ".####.exr" : options.output);
  require_numbered(pattern, frames);
  require_writable(pattern.path(frames.front()));
  if (!options.stats.empty()) require_writable(options.stats);
  Diagnostics of_surfaces;
  warn_of_missing_surfaces(scene, frames, of_surfaces);
  print_warnings(of_surfaces);

  const std::string hash = picture_hash(scene, window);
  Progress progress(options.progress, static_cast<double>(frames.size()), "frames");
  SequenceRenderer sequence(std::move(scene), pattern, window, hash, options, progress);
  for (const int frame : frames) sequence.render(frame);
  sequence.finish_writing();
  if (!options.stats.empty()) write_render_stats(options.stats, threads, sequence.reports());
}

void add_render(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("render", "render a scene's frames as EXR files");
  auto options = std::make_shared<RenderOptions>();
  auto scene = std::make_shared<std::string>();
  command.add_option("SCENE", *scene, "the scene file (JSON)")->required();
  add_render_options(command, *options);
  command.footer("Examples:\n"
                 "  kelpie render examples/blob.json -o 'out/blob.####.exr'\n"
                 "  kelpie render shot.json -f 12 --quality draft --res 50% -o look.exr\n"
                 "  kelpie render chairs/breed.json --recipe child_b -o child_b.exr\n"
                 "  kelpie render shot.json --set shapes.drop.threshold=1.1 --skip-existing -o 'out/shot.####.exr'");
  command.callback([=] { render_scene(*scene, std::filesystem::path(*scene).stem().string(), *options); });
}

} // namespace kelpie
