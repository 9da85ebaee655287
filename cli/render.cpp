#include "cli/render.h"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include "base/atomic_file.h"
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

/// Frames of the scene, written one by one.
class SequenceRenderer {
public:
  SequenceRenderer(Scene scene, const FramePattern& pattern, const PixelBox& window, std::string hash, const RenderOptions& options,
                   Progress& progress)
      : scene_(std::move(scene)), pattern_(pattern), window_(window), hash_(std::move(hash)), options_(options), progress_(progress) {}

  void render(int frame) {
    const std::string path = pattern_.path(frame);
    const std::string key = hash_ + "#" + std::to_string(frame);
    if (options_.skip_existing && frame_is_complete(path, key)) {
      progress_.advance(++finished_, fmt::format("{}: exists", path));
      return;
    }
    Diagnostics diagnostics;
    std::atomic<double> share{0};
    Heartbeat building(options_.progress, fmt::format("building frame {}", frame));
    const auto progress = [&](double part) {
      building.stop();
      double before = share;
      while (!share.compare_exchange_weak(before, before + part)) {
      }
      progress_.advance(finished_ + std::min(1.0, before + part) * 0.999);
    };
    set_activity(fmt::format("rendering frame {}", frame));
    RenderedFrame rendered = render_frame(scene_, frame, window_, {environments_, diagnostics, progress, options_.max_memory, &kept_});
    write(rendered, frame, path, key, diagnostics);
    for (const Problem& p : diagnostics.warnings()) progress_.print_line("warning: " + to_string(p));
    progress_.advance(++finished_, fmt::format("wrote {}", path));
  }

  const std::vector<FrameReport>& reports() const { return reports_; }

private:
  void write(const RenderedFrame& rendered, int frame, const std::string& path, const std::string& key, Diagnostics& diagnostics) {
    const double cpu_before = process_cpu_s();
    const CameraMatrices matrices = camera_matrices(rendered.camera, rendered.image.resolution);
    const EncodedFrame encoded = write_exr(
        path, rendered.image, {frame, scene_.frames.fps, key, scene_.meta.text, matrices.camera_from_world, matrices.ndc_from_world});
    if (encoded.clamped > 0)
      diagnostics.warning({path, 0, 0}, fmt::format("{} values above 65504 were clamped to the range of half floats", encoded.clamped));
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    reports_.push_back({rendered.stats, process_cpu_s() - cpu_before, static_cast<double>(usage.ru_maxrss) / 1024});
  }

  Scene scene_;
  const FramePattern& pattern_;
  PixelBox window_;
  std::string hash_;
  const RenderOptions& options_;
  Progress& progress_;
  EnvironmentCache environments_;
  KeptScenes kept_;
  int finished_ = 0;
  std::vector<FrameReport> reports_;
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
