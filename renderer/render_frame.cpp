#include "renderer/render_frame.h"

#include <chrono>
#include <ctime>

#include <fmt/format.h>

namespace kelpie {

double process_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

RenderedFrame render_frame(const Scene& scene, double number, const PixelBox& window, const FrameContext& context) {
  const auto wall = std::chrono::steady_clock::now();
  const FrameScene frame = sample(scene, number);
  const std::vector<Light> lights = make_lights(frame, context.environments, context.diagnostics);

  const double cpu_before = process_cpu_s();
  const Tracer tracer(frame);
  const double cpu_built = process_cpu_s();
  IntegrateResult pixels = integrate(frame, tracer, lights, window, context.progress, context.stop);
  const double cpu_rendered = process_cpu_s();

  if (pixels.nonfinite > 0)
    context.diagnostics.warning({}, fmt::format("frame {}: {} samples were not finite and are black, one at pixel {},{}", number,
                                                pixels.nonfinite, pixels.first_nonfinite.x, pixels.first_nonfinite.y));
  RenderedFrame out;
  out.image = std::move(pixels.image);
  out.camera = frame.camera;
  out.was_stopped = pixels.was_stopped;
  out.stats = {number,
               std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count(),
               cpu_built - cpu_before,
               cpu_rendered - cpu_built,
               pixels.rays,
               pixels.nonfinite,
               tracer.cell_count(),
               tracer.element_count(),
               tracer.bytes()};
  return out;
}

} // namespace kelpie
