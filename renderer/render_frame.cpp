#include "renderer/render_frame.h"

#include <chrono>
#include <ctime>

#include <fmt/format.h>

#include "renderer/empty_frame.h"

namespace kelpie {

double process_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

namespace {

/// With the finest cells that fit into the memory.
Tracer build_tracer(const FrameScene& frame, const FrameContext& context, int& coarsenings) {
  CellLimits limits;
  if (context.max_memory == 0) return Tracer(frame, limits, context.kept);
  for (coarsenings = 0;; ++coarsenings) {
    MemoryBudget budget(context.max_memory);
    limits.budget = &budget;
    try {
      return Tracer(frame, limits, context.kept);
    } catch (const MemoryBudget::Exceeded&) {
      if (!make_coarser(limits))
        throw Error(ExitStatus::out_of_memory,
                    fmt::format("frame {}: even with the coarsest cells building takes more than {:.6g} MB (--max-memory)", frame.frame,
                                static_cast<double>(context.max_memory) / 1e6));
    }
  }
}

} // namespace

RenderedFrame render_frame(const Scene& scene, double number, const PixelBox& window, const FrameContext& context) {
  const auto wall = std::chrono::steady_clock::now();
  const FrameScene frame = sample(scene, number);
  const std::vector<Light> lights = make_lights(frame, context.environments, context.diagnostics);

  const double cpu_before = process_cpu_s();
  int coarsenings = 0;
  const Tracer tracer = build_tracer(frame, context, coarsenings);
  const double cpu_built = process_cpu_s();
  IntegrateResult pixels = integrate(frame, tracer, lights, window, context.progress);
  const double cpu_rendered = process_cpu_s();

  if (coarsenings > 0)
    context.diagnostics.warning(
        {}, fmt::format("frame {}: to fit into --max-memory cells are {} times as long; rays take more time", number, 1 << coarsenings));
  if (pixels.nonfinite > 0)
    context.diagnostics.warning({}, fmt::format("frame {}: {} samples were not finite and are black, one at pixel {},{}", number,
                                                pixels.nonfinite, pixels.first_nonfinite.x, pixels.first_nonfinite.y));
  if (const std::string why = why_empty(frame, tracer, lights, pixels.image); !why.empty())
    context.diagnostics.warning({}, fmt::format("frame {} {}", number, why));
  RenderedFrame out;
  out.image = std::move(pixels.image);
  out.camera = frame.camera;
  out.stats = {number,
               std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count(),
               cpu_built - cpu_before,
               cpu_rendered - cpu_built,
               pixels.rays,
               pixels.nonfinite,
               tracer.cell_count(),
               tracer.element_count(),
               tracer.bytes(),
               tracer.kept_cell_count(),
               coarsenings};
  return out;
}

} // namespace kelpie
