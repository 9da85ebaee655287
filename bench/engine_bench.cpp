// The engine's parts by themselves, one thread: evaluating the field, building cells, tracing rays.
#include <map>
#include <random>

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "bench/bench_scene.h"
#include "renderer/integrate/camera_rays.h"
#include "renderer/program/evaluate.h"
#include "renderer/trace/tracer.h"

namespace kelpie {
namespace {

const tbb::global_control k_one_thread(tbb::global_control::max_allowed_parallelism, 1);

/// What is measured: the name of a scene (bench_scene.h).
using Subject = std::string;

/// Scenes and tracers are made once: several benchmarks use each.
const FrameScene& scene_of(const Subject& subject) {
  static std::map<Subject, FrameScene> scenes;
  const auto found = scenes.find(subject);
  return found != scenes.end() ? found->second : scenes.emplace(subject, bench_scene(subject)).first->second;
}
const Tracer& tracer_of(const Subject& subject) {
  static std::map<Subject, Tracer> tracers;
  const auto found = tracers.find(subject);
  return found != tracers.end() ? found->second : tracers.emplace(subject, Tracer(scene_of(subject))).first->second;
}

FieldProgram program_of(const Subject& subject) {
  const SampledShape& shape = scene_of(subject).shapes[0];
  return compile(shape.field, shape.threshold);
}

/// Registers a benchmark for the clouds, or for everything.
#define KELPIE_BENCHMARK_CLOUDS(function)                                                                                                  \
  BENCHMARK_CAPTURE(function, 1000, "1000")->Unit(benchmark::kMillisecond);                                                                \
  BENCHMARK_CAPTURE(function, 10000, "10000")->Unit(benchmark::kMillisecond);                                                              \
  BENCHMARK_CAPTURE(function, 100000, "100000")->Unit(benchmark::kMillisecond)
#define KELPIE_BENCHMARK_ALL(function)                                                                                                     \
  KELPIE_BENCHMARK_CLOUDS(function);                                                                                                       \
  BENCHMARK_CAPTURE(function, creature, "creature")->Unit(benchmark::kMillisecond);                                                        \
  BENCHMARK_CAPTURE(function, creature_twisted, "creature_twisted")->Unit(benchmark::kMillisecond);                                        \
  BENCHMARK_CAPTURE(function, creature_bent, "creature_bent")->Unit(benchmark::kMillisecond)

std::vector<Point3<double>> random_points(int count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<> uniform(-1.5, 1.5);
  std::vector<Point3<double>> points(static_cast<size_t>(count));
  for (auto& p : points) p = {uniform(random), uniform(random), uniform(random)};
  return points;
}

void evaluate_whole_field(benchmark::State& state, const Subject& subject) {
  const FieldProgram program = program_of(subject);
  const auto points = random_points(64);
  for (auto _ : state)
    for (const auto& p : points) benchmark::DoNotOptimize(evaluate(program, program.code, p));
  state.counters["elements"] = benchmark::Counter(double(program.element_count()) * 64, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK_CAPTURE(evaluate_whole_field, 1000, "1000");

void gradient_of_whole_field(benchmark::State& state, const Subject& subject) {
  const FieldProgram program = program_of(subject);
  const auto points = random_points(64);
  for (auto _ : state)
    for (const auto& p : points) benchmark::DoNotOptimize(gradient(program, program.code, {p.x, p.y, p.z}));
  state.counters["elements"] = benchmark::Counter(double(program.element_count()) * 64, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK_CAPTURE(gradient_of_whole_field, 1000, "1000");

/// From the sampled scene to Embree's commit, as build_cpu_s counts it.
void build_tracer(benchmark::State& state, const Subject& subject) {
  const FrameScene& scene = scene_of(subject);
  size_t cells = 0;
  for (auto _ : state) cells = Tracer(scene).cell_count();
  state.counters["elements"] =
      benchmark::Counter(double(tracer_of(subject).element_count()), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["cells"] = double(cells);
}
KELPIE_BENCHMARK_ALL(build_tracer);

/// One ray through each pixel of 640 x 360, by squares of 4 x 4: 16 rays are a packet.
std::vector<Ray> camera_rays(const FrameScene& scene) {
  const Vec2i resolution(640, 360);
  const CameraRays camera(scene.camera, resolution);
  std::vector<Ray> rays;
  for (int y = 0; y < resolution.y; y += 4)
    for (int x = 0; x < resolution.x; x += 4)
      for (int i = 0; i < 16; ++i) rays.push_back(camera.through(Vec2(x + i % 4, y + i / 4) + 0.5f, Vec2(0)));
  return rays;
}

/// A ray from each hit of the camera's rays, in the direction that `direction(normal)` says.
template <class Direction>
std::vector<Ray> secondary_rays(const FrameScene& scene, const Tracer& tracer, Direction&& direction) {
  std::vector<Ray> out;
  SolveCounters counters;
  for (const Ray& ray : camera_rays(scene)) {
    Hit hit;
    if (!tracer.intersect(ray, counters, hit)) continue;
    const Vec3 d = direction(hit.normal);
    if (glm::dot(d, hit.normal) <= 0) continue; // faces away from the sun: not asked
    Ray next;
    next.origin = hit.position + hit.epsilon * hit.normal, next.direction = d;
    out.push_back(next);
  }
  return out;
}

void count_rays(benchmark::State& state, size_t rays, const SolveCounters& counters) {
  const double traced = double(rays) * double(state.iterations());
  state.counters["rays"] = benchmark::Counter(traced, benchmark::Counter::kIsRate);
  state.counters["cells/ray"] = double(counters.total().cells) / traced;
  state.counters["samples/ray"] = double(counters.total().evaluations) / traced;
}

void trace_camera_rays(benchmark::State& state, const Subject& subject) {
  const Tracer& tracer = tracer_of(subject);
  const std::vector<Ray> rays = camera_rays(scene_of(subject));
  SolveCounters counters;
  for (auto _ : state)
    for (const Ray& ray : rays) {
      Hit hit;
      benchmark::DoNotOptimize(tracer.intersect(ray, counters, hit));
    }
  count_rays(state, rays.size(), counters);
}
KELPIE_BENCHMARK_ALL(trace_camera_rays);

void trace_shadow_rays(benchmark::State& state, const Subject& subject) {
  const Tracer& tracer = tracer_of(subject);
  const Vec3 sun = glm::normalize(Vec3(1, 2, 1));
  const std::vector<Ray> rays = secondary_rays(scene_of(subject), tracer, [&](const Vec3&) { return sun; });
  SolveCounters counters;
  for (auto _ : state)
    for (const Ray& ray : rays) benchmark::DoNotOptimize(tracer.occluded(ray, counters));
  count_rays(state, rays.size(), counters);
}
KELPIE_BENCHMARK_ALL(trace_shadow_rays);

std::span<const Ray> packet(const std::vector<Ray>& rays, size_t first) {
  return std::span(rays).subspan(first, std::min(k_packet, rays.size() - first));
}

void trace_camera_packets(benchmark::State& state, const Subject& subject) {
  const Tracer& tracer = tracer_of(subject);
  const std::vector<Ray> rays = camera_rays(scene_of(subject));
  SolveCounters counters;
  for (auto _ : state)
    for (size_t i = 0; i < rays.size(); i += k_packet) {
      std::array<Hit, k_packet> hits;
      benchmark::DoNotOptimize(tracer.intersect(packet(rays, i), counters, hits.data()));
    }
  count_rays(state, rays.size(), counters);
}
KELPIE_BENCHMARK_ALL(trace_camera_packets);

void trace_shadow_packets(benchmark::State& state, const Subject& subject) {
  const Tracer& tracer = tracer_of(subject);
  const Vec3 sun = glm::normalize(Vec3(1, 2, 1));
  const std::vector<Ray> rays = secondary_rays(scene_of(subject), tracer, [&](const Vec3&) { return sun; });
  SolveCounters counters;
  for (auto _ : state)
    for (size_t i = 0; i < rays.size(); i += k_packet) benchmark::DoNotOptimize(tracer.occluded(packet(rays, i), counters));
  count_rays(state, rays.size(), counters);
}
KELPIE_BENCHMARK_ALL(trace_shadow_packets);

/// Directions as diffuse bounces have them: neighbours part at once.
std::vector<Ray> scattered_rays(const Subject& subject) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  return secondary_rays(scene_of(subject), tracer_of(subject), [&](const Vec3& n) {
    return glm::normalize(n + 0.999f * glm::normalize(Vec3(normal(random), normal(random), normal(random))));
  });
}

void trace_scattered_rays(benchmark::State& state, const Subject& subject) {
  const Tracer& tracer = tracer_of(subject);
  const std::vector<Ray> rays = scattered_rays(subject);
  SolveCounters counters;
  for (auto _ : state)
    for (const Ray& ray : rays) {
      Hit hit;
      benchmark::DoNotOptimize(tracer.intersect(ray, counters, hit));
    }
  count_rays(state, rays.size(), counters);
}
KELPIE_BENCHMARK_ALL(trace_scattered_rays);

/// Shadow rays to an environment: as the above, but any hit will do. In packets and alone.
void trace_scattered_shadows(benchmark::State& state, const Subject& subject) {
  const Tracer& tracer = tracer_of(subject);
  const std::vector<Ray> rays = scattered_rays(subject);
  SolveCounters counters;
  for (auto _ : state)
    for (const Ray& ray : rays) benchmark::DoNotOptimize(tracer.occluded(ray, counters));
  count_rays(state, rays.size(), counters);
}
BENCHMARK_CAPTURE(trace_scattered_shadows, 10000, "10000")->Unit(benchmark::kMillisecond);

void trace_scattered_shadow_packets(benchmark::State& state, const Subject& subject) {
  const Tracer& tracer = tracer_of(subject);
  const std::vector<Ray> rays = scattered_rays(subject);
  SolveCounters counters;
  for (auto _ : state)
    for (size_t i = 0; i < rays.size(); i += k_packet) benchmark::DoNotOptimize(tracer.occluded(packet(rays, i), counters));
  count_rays(state, rays.size(), counters);
}
BENCHMARK_CAPTURE(trace_scattered_shadow_packets, 10000, "10000")->Unit(benchmark::kMillisecond);

} // namespace
} // namespace kelpie
