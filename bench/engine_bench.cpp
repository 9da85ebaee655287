// The engine's parts by themselves, one thread: evaluating the field, building cells, tracing rays.
#include <map>
#include <random>

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "bench/knot_cloud.h"
#include "renderer/integrate/camera_rays.h"
#include "renderer/program/evaluate.h"
#include "renderer/trace/tracer.h"

namespace kelpie {
namespace {

const tbb::global_control k_one_thread(tbb::global_control::max_allowed_parallelism, 1);

FrameScene make_scene(int count) {
  Blobs<SampledMode> blobs;
  blobs.cloud = std::make_shared<const BlobCloud>(make_knot_cloud(count));
  SampledShape shape;
  shape.name = "knot", shape.field.nodes.emplace_back(blobs);
  FrameScene scene;
  scene.shapes.push_back(std::move(shape));
  scene.camera.position = Vec3(0.6f, 2.2f, 5.2f), scene.camera.look_at = Vec3(0);
  return scene;
}

/// Scenes and tracers are made once: several benchmarks use each.
const FrameScene& scene_of(int count) {
  static std::map<int, FrameScene> scenes;
  const auto found = scenes.find(count);
  return found != scenes.end() ? found->second : scenes.emplace(count, make_scene(count)).first->second;
}
const Tracer& tracer_of(int count) {
  static std::map<int, Tracer> tracers;
  const auto found = tracers.find(count);
  return found != tracers.end() ? found->second : tracers.emplace(count, Tracer(scene_of(count))).first->second;
}

FieldProgram program_of(int count) {
  const SampledShape& shape = scene_of(count).shapes[0];
  return compile(shape.field, shape.threshold);
}

std::vector<Point3<double>> random_points(int count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<> uniform(-1.5, 1.5);
  std::vector<Point3<double>> points(static_cast<size_t>(count));
  for (auto& p : points) p = {uniform(random), uniform(random), uniform(random)};
  return points;
}

void evaluate_whole_field(benchmark::State& state) {
  const FieldProgram program = program_of(static_cast<int>(state.range(0)));
  const auto points = random_points(64);
  for (auto _ : state)
    for (const auto& p : points) benchmark::DoNotOptimize(evaluate(program, program.code, p));
  state.counters["blobs"] = benchmark::Counter(double(state.range(0)) * 64, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(evaluate_whole_field)->Arg(1000);

void gradient_of_whole_field(benchmark::State& state) {
  const FieldProgram program = program_of(static_cast<int>(state.range(0)));
  const auto points = random_points(64);
  for (auto _ : state)
    for (const auto& p : points) benchmark::DoNotOptimize(gradient(program, program.code, {p.x, p.y, p.z}));
  state.counters["blobs"] = benchmark::Counter(double(state.range(0)) * 64, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(gradient_of_whole_field)->Arg(1000);

/// From the sampled scene to Embree's commit, as build_cpu_s counts it.
void build_tracer(benchmark::State& state) {
  const FrameScene& scene = scene_of(static_cast<int>(state.range(0)));
  size_t cells = 0;
  for (auto _ : state) cells = Tracer(scene).cell_count();
  state.counters["blobs"] = benchmark::Counter(double(state.range(0)), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["cells"] = double(cells);
}
BENCHMARK(build_tracer)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

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
  state.counters["cells/ray"] = double(counters.cells) / traced;
  state.counters["samples/ray"] = double(counters.total().evaluations) / traced;
}

void trace_camera_rays(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0));
  const Tracer& tracer = tracer_of(count);
  const std::vector<Ray> rays = camera_rays(scene_of(count));
  SolveCounters counters;
  for (auto _ : state)
    for (const Ray& ray : rays) {
      Hit hit;
      benchmark::DoNotOptimize(tracer.intersect(ray, counters, hit));
    }
  count_rays(state, rays.size(), counters);
}
BENCHMARK(trace_camera_rays)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

void trace_shadow_rays(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0));
  const Tracer& tracer = tracer_of(count);
  const Vec3 sun = glm::normalize(Vec3(1, 2, 1));
  const std::vector<Ray> rays = secondary_rays(scene_of(count), tracer, [&](const Vec3&) { return sun; });
  SolveCounters counters;
  for (auto _ : state)
    for (const Ray& ray : rays) benchmark::DoNotOptimize(tracer.occluded(ray, counters));
  count_rays(state, rays.size(), counters);
}
BENCHMARK(trace_shadow_rays)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

std::span<const Ray> packet(const std::vector<Ray>& rays, size_t first) {
  return std::span(rays).subspan(first, std::min(k_packet, rays.size() - first));
}

void trace_camera_packets(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0));
  const Tracer& tracer = tracer_of(count);
  const std::vector<Ray> rays = camera_rays(scene_of(count));
  SolveCounters counters;
  for (auto _ : state)
    for (size_t i = 0; i < rays.size(); i += k_packet) {
      std::array<Hit, k_packet> hits;
      benchmark::DoNotOptimize(tracer.intersect(packet(rays, i), counters, hits.data()));
    }
  count_rays(state, rays.size(), counters);
}
BENCHMARK(trace_camera_packets)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

void trace_shadow_packets(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0));
  const Tracer& tracer = tracer_of(count);
  const Vec3 sun = glm::normalize(Vec3(1, 2, 1));
  const std::vector<Ray> rays = secondary_rays(scene_of(count), tracer, [&](const Vec3&) { return sun; });
  SolveCounters counters;
  for (auto _ : state)
    for (size_t i = 0; i < rays.size(); i += k_packet) benchmark::DoNotOptimize(tracer.occluded(packet(rays, i), counters));
  count_rays(state, rays.size(), counters);
}
BENCHMARK(trace_shadow_packets)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

/// Directions as diffuse bounces have them: neighbours part at once.
std::vector<Ray> scattered_rays(int count) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  return secondary_rays(scene_of(count), tracer_of(count), [&](const Vec3& n) {
    return glm::normalize(n + 0.999f * glm::normalize(Vec3(normal(random), normal(random), normal(random))));
  });
}

void trace_scattered_rays(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0));
  const Tracer& tracer = tracer_of(count);
  const std::vector<Ray> rays = scattered_rays(count);
  SolveCounters counters;
  for (auto _ : state)
    for (const Ray& ray : rays) {
      Hit hit;
      benchmark::DoNotOptimize(tracer.intersect(ray, counters, hit));
    }
  count_rays(state, rays.size(), counters);
}
BENCHMARK(trace_scattered_rays)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

/// Shadow rays to an environment: as the above, but any hit will do. In packets and alone.
void trace_scattered_shadows(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0));
  const Tracer& tracer = tracer_of(count);
  const std::vector<Ray> rays = scattered_rays(count);
  SolveCounters counters;
  for (auto _ : state)
    for (const Ray& ray : rays) benchmark::DoNotOptimize(tracer.occluded(ray, counters));
  count_rays(state, rays.size(), counters);
}
BENCHMARK(trace_scattered_shadows)->Arg(10000)->Unit(benchmark::kMillisecond);

void trace_scattered_shadow_packets(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0));
  const Tracer& tracer = tracer_of(count);
  const std::vector<Ray> rays = scattered_rays(count);
  SolveCounters counters;
  for (auto _ : state)
    for (size_t i = 0; i < rays.size(); i += k_packet) benchmark::DoNotOptimize(tracer.occluded(packet(rays, i), counters));
  count_rays(state, rays.size(), counters);
}
BENCHMARK(trace_scattered_shadow_packets)->Arg(10000)->Unit(benchmark::kMillisecond);

} // namespace
} // namespace kelpie
