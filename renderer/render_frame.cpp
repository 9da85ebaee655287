#include "renderer/render_frame.h"

#include <chrono>
#include <limits>

#include <fmt/format.h>

#include "base/memory_limit.h"
#include "renderer/empty_frame.h"
#include "scene/pixel_scale.h"

namespace kelpie {

namespace {

double megabytes(size_t bytes) { return static_cast<double>(bytes) / 1e6; }

/// Channels in float, and about twice as much again while they are encoded and checked.
void require_room_for_picture(const FrameScene& frame, const PixelBox& window) {
  const size_t channels = 4 + 3 * frame.film.aovs.size(), bytes = 3 * sizeof(float) * channels * window.area(), usable = usable_memory();
  if (bytes > usable)
    throw Error(ExitStatus::out_of_memory,
                fmt::format("frame {}: a picture of {}x{} pixels with {} channels takes about {:.6g} MB, and {:.6g} MB are there for it: "
                            "render parts of it (--crop) or fewer pixels (--res)",
                            frame.frame, window.width(), window.height(), channels, megabytes(bytes), megabytes(usable)));
}

[[noreturn]] void refuse(const Scene& scene, double frame, size_t usable, const BuildBudget::Share& costliest) {
  throw Error(
      ExitStatus::out_of_memory,
      fmt::format("frame {}: building takes more than {:.6g} MB, which is what there is, most of it for shape {}. Look whether a number "
                  "of it is mistyped, make what is thin or far away thicker or shorter, or let cells become coarser (--max-memory)",
                  frame, megabytes(usable), describe(costliest, scene)));
}

/// With the finest cells that fit into the cap, if there is one. No picture depends on the machine: a frame fits into it or is refused.
Tracer build_tracer(const Scene& scene, const FrameScene& frame, const FrameContext& context, FrameStats& stats) {
  constexpr size_t k_endless = std::numeric_limits<size_t>::max();
  const size_t usable = usable_memory(), cap = context.max_memory > 0 ? context.max_memory : k_endless,
               trial = context.trial ? context.trial->most_bytes : k_endless, most = std::min({usable, cap, trial});
  CellLimits limits;
  limits.pixels = pixel_scale(scene, frame.camera, frame.film.resolution.y);
  for (stats.coarsenings = 0;; ++stats.coarsenings) {
    BuildBudget budget(most, context.trial ? context.trial->deadline : BuildBudget::Clock::time_point::max());
    limits.budget = &budget;
    try {
      Tracer tracer(frame, limits, context.kept);
      stats.costliest = budget.costliest();
      return tracer;
    } catch (const BuildBudget::OutOfMemory& out_of_memory) {
      if (most == trial) throw;
      if (most == usable) refuse(scene, frame.frame, usable, out_of_memory.costliest);
      if (!make_coarser(limits))
        throw Error(ExitStatus::out_of_memory,
                    fmt::format("frame {}: even with the coarsest cells building takes more than {:.6g} MB (--max-memory), most of it "
                                "for shape {}",
                                frame.frame, megabytes(most), describe(out_of_memory.costliest, scene)));
    }
  }
}

} // namespace

std::string describe(const BuildBudget::Share& share, const Scene& scene) {
  const std::string& name = scene.shapes.at(share.shape).name;
  return fmt::format("{} ({:.3g} MB)", name.empty() ? fmt::format("number {}", share.shape + 1) : fmt::format("\"{}\"", name),
                     megabytes(share.bytes));
}

RenderedFrame render_frame(const Scene& scene, double number, const PixelBox& window, const FrameContext& context) {
  const auto wall = std::chrono::steady_clock::now();
  const FrameScene frame = sample(scene, number);
  require_room_for_picture(frame, window);
  const std::vector<Light> lights = make_lights(frame, context.environments, context.diagnostics);

  const double cpu_before = process_cpu_s();
  FrameStats stats;
  const Tracer tracer = build_tracer(scene, frame, context, stats);
  const double cpu_built = process_cpu_s();
  stats.frame = number, stats.build_cpu_s = cpu_built - cpu_before;
  stats.cells = tracer.cell_count(), stats.kept_cells = tracer.kept_cell_count();
  stats.elements = tracer.element_count(), stats.engine_bytes = tracer.bytes();
  if (context.trial) context.trial->stats = stats;
  IntegrateResult pixels = integrate(frame, tracer, lights, window, context.progress);
  const double cpu_rendered = process_cpu_s();

  if (stats.coarsenings > 0)
    context.diagnostics.warning({}, fmt::format("frame {}: to fit into --max-memory cells are {} times as long; rays take more time",
                                                number, 1 << stats.coarsenings));
  if (pixels.nonfinite > 0)
    context.diagnostics.warning({}, fmt::format("frame {}: {} samples were not finite and are black, one at pixel {},{}", number,
                                                pixels.nonfinite, pixels.first_nonfinite.x, pixels.first_nonfinite.y));
  std::string flaw = why_empty(frame, tracer, lights, pixels.image);
  if (flaw.empty()) flaw = why_coarse(frame, tracer);
  if (!flaw.empty()) context.diagnostics.warning({}, fmt::format("frame {} {}", number, flaw));
  RenderedFrame out;
  out.image = std::move(pixels.image);
  out.camera = frame.camera;
  out.stats = stats;
  out.stats.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
  out.stats.render_cpu_s = cpu_rendered - cpu_built;
  out.stats.rays = pixels.rays, out.stats.nonfinite = pixels.nonfinite;
  return out;
}

} // namespace kelpie
