// engine_vs_triangles [--res WxH] [--runs N] [--voxel PIXELS] [--no-triangles] SCENE...: the tracer against Embree's
// triangles on a mesh of the same field, CPU seconds of one thread, the same rays for both. SCENE: a number of blobs,
// `creature`…, or a scene file (bench_scene.h). See README.md.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <random>

#include <fmt/format.h>

#include "base/error.h"
#include "bench/bench_scene.h"
#include "renderer/integrate/camera_rays.h"
#include "renderer/render_frame.h"
#include "renderer/trace/tracer.h"
#ifdef KELPIE_TRIANGLES
#include "bench/triangle_scene.h"
#endif

namespace kelpie {
namespace {

struct Options {
  Vec2i resolution{1280, 720};
  int runs = 3;
  double voxel_in_pixels = 0.5;
  bool triangles = true;
  std::vector<std::string> scenes;
};

/// Rays by packets: those of one packet start at a block of 4 x 4 pixels, as the renderer has them.
struct Packets {
  std::vector<Ray> rays;
  std::vector<size_t> starts{0}; ///< of each packet, and the end
  void end_packet() {
    if (rays.size() > starts.back()) starts.push_back(rays.size());
  }
  size_t count() const { return starts.size() - 1; }
  std::span<const Ray> packet(size_t i) const { return std::span(rays).subspan(starts[i], starts[i + 1] - starts[i]); }
};

Packets camera_packets(const FrameScene& scene, Vec2i resolution) {
  const CameraRays camera(scene.camera, resolution);
  Packets out;
  for (int y = 0; y < resolution.y; y += 4)
    for (int x = 0; x < resolution.x; x += 4) {
      for (int i = 0; i < 16; ++i)
        if (x + i % 4 < resolution.x && y + i / 4 < resolution.y)
          out.rays.push_back(camera.through(Vec2(x + i % 4, y + i / 4) + 0.5f, Vec2(0)));
      out.end_packet();
    }
  return out;
}

/// A ray from every hit, in the direction that `direction(normal)` says, if that is on the outer side. It starts
/// `offset` above the surface: a mesh deviates from it, and the rays are to be the same for both.
Packets secondary_packets(const Tracer& tracer, const Packets& camera, float offset, const std::function<Vec3(const Vec3&)>& direction) {
  Packets out;
  SolveCounters counters;
  for (size_t i = 0; i < camera.count(); ++i) {
    std::array<Hit, k_packet> hits;
    const uint32_t met = tracer.intersect(camera.packet(i), counters, hits.data());
    for (size_t lane = 0; lane < k_packet; ++lane) {
      if (!(met >> lane & 1)) continue;
      const Hit& hit = hits[lane];
      const Vec3 d = direction(hit.normal);
      if (!(glm::dot(d, hit.normal) > 0)) continue;
      Ray ray;
      ray.origin = hit.position + offset * hit.normal, ray.direction = d;
      out.rays.push_back(ray);
    }
    out.end_packet();
  }
  return out;
}

/// A diffuse bounce: neighbours part at once.
Packets bounce_packets(const Tracer& tracer, const Packets& camera, float offset) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  return secondary_packets(tracer, camera, offset, [&](const Vec3& n) {
    return glm::normalize(n + 0.999f * glm::normalize(Vec3(normal(random), normal(random), normal(random))));
  });
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// One way of tracing; returns which rays hit, to compare, and so that nothing is left out as unused.
using Trace = std::function<std::vector<char>(const Packets&)>;

/// Calls `one(rays, bits)` for each packet, and spreads the bits.
template <class One>
Trace by_packets(One one) {
  return [one](const Packets& p) {
    std::vector<char> met(p.rays.size());
    for (size_t i = 0; i < p.count(); ++i) {
      const uint32_t bits = one(p.packet(i));
      for (size_t lane = 0; lane < p.packet(i).size(); ++lane) met[p.starts[i] + lane] = static_cast<char>(bits >> lane & 1);
    }
    return met;
  };
}
template <class One>
Trace one_by_one(One one) {
  return [one](const Packets& p) {
    std::vector<char> met(p.rays.size());
    for (size_t i = 0; i < p.rays.size(); ++i) met[i] = one(p.rays[i]);
    return met;
  };
}

/// Kelpie's way of tracing some rays, and those of triangles, of which the fastest counts.
struct Contest {
  const char* rays;
  const Packets& packets;
  Trace kelpie;
  std::vector<Trace> triangles;
};

void print_contest(const std::string& scene, const Contest& contest, int runs) {
  std::vector<std::vector<double>> seconds(1 + contest.triangles.size());
  std::vector<char> met, met_triangles;
  for (int run = 0; run < runs; ++run)
    for (size_t way = 0; way < seconds.size(); ++way) {
      const double before = process_cpu_s();
      (way == 0 ? met : met_triangles) = (way == 0 ? contest.kelpie : contest.triangles[way - 1])(contest.packets);
      seconds[way].push_back(process_cpu_s() - before);
    }
  const double million = 1e-6 * double(contest.packets.rays.size()), kelpie = median(seconds[0]);
  fmt::print("{:>18} {:>7} {:>8.3f} {:>9.3f} {:>8.2f}", scene, contest.rays, million, kelpie, million / kelpie);
  if (!contest.triangles.empty()) {
    double best = std::numeric_limits<double>::infinity();
    for (size_t way = 1; way < seconds.size(); ++way) best = std::min(best, median(seconds[way]));
    size_t differ = 0;
    for (size_t i = 0; i < met.size(); ++i) differ += met[i] != met_triangles[i];
    fmt::print(" {:>9.3f} {:>8.2f} {:>8.2f} {:>8.3f} %", best, million / best, kelpie / best, 100 * double(differ) / double(met.size()));
  }
  fmt::print("\n");
  std::fflush(stdout);
}

/// Builds the tracer so many times and prints what that takes.
std::unique_ptr<const Tracer> build_tracer(const std::string& name, const FrameScene& scene, int runs) {
  std::unique_ptr<const Tracer> tracer;
  std::vector<double> seconds;
  for (int run = 0; run < runs; ++run) {
    tracer.reset();
    const double before = process_cpu_s();
    tracer = std::make_unique<const Tracer>(scene);
    seconds.push_back(process_cpu_s() - before);
  }
  fmt::print("# {}: {} elements, {} cells: {:.4f} s, {:.1f} MB\n", name, tracer->element_count(), tracer->cell_count(), median(seconds),
             1e-6 * double(tracer->bytes()));
  return tracer;
}

void measure(const std::string& name, const Options& options) {
  const FrameScene scene = bench_scene(name);
  const std::unique_ptr<const Tracer> built = build_tracer(name, scene, options.runs);
  const Tracer& tracer = *built;

  const double distance = glm::distance(scene.camera.position, scene.camera.look_at);
  const double pixel = 2 * std::tan(glm::radians(double(scene.camera.fov)) / 2) * distance / options.resolution.y;
  const double voxel = options.voxel_in_pixels * pixel;
  const Packets camera = camera_packets(scene, options.resolution);
  const Vec3 sun = glm::normalize(Vec3(1, 2, 1));
  const Packets shadow = secondary_packets(tracer, camera, float(voxel), [&](const Vec3&) { return sun; });
  const Packets bounce = bounce_packets(tracer, camera, float(voxel));

  SolveCounters counters;
  std::array<Hit, k_packet> hits;
  Contest contests[] = {
      {"camera", camera, by_packets([&](std::span<const Ray> p) { return tracer.intersect(p, counters, hits.data()); }), {}},
      {"shadow", shadow, by_packets([&](std::span<const Ray> p) { return tracer.occluded(p, counters); }), {}},
      {"bounce", bounce, one_by_one([&](const Ray& r) { return tracer.intersect(r, counters, hits[0]); }), {}},
  };
#ifdef KELPIE_TRIANGLES
  std::optional<TriangleScene> triangles;
  std::array<TriangleHit, k_packet> triangle_hits;
  if (options.triangles) {
    const double start = process_cpu_s();
    const SampledShape& shape = scene.shapes[0]; // scenes to measure have one shape
    const FieldMesh mesh = mesh_field(compile(shape.field, shape.threshold), voxel);
    const double meshed = process_cpu_s();
    triangles.emplace(mesh);
    fmt::print("# {}: mesh {:.1f} s, {:.2f} million triangles, Embree's tree {:.1f} s, {:.0f} MB\n", name, meshed - start,
               1e-6 * double(mesh.triangles.size() / 3), process_cpu_s() - meshed, 1e-6 * double(triangles->bytes()));
    const auto intersect = [&](const Ray& r) { return triangles->intersect(r, triangle_hits[0]); };
    const auto packets = [&](bool is_coherent) {
      return by_packets([&, is_coherent](std::span<const Ray> p) { return triangles->intersect(p, is_coherent, triangle_hits.data()); });
    };
    contests[0].triangles = {packets(true), one_by_one(intersect)};
    contests[1].triangles = {by_packets([&](std::span<const Ray> p) { return triangles->occluded(p, true); }),
                             one_by_one([&](const Ray& r) { return triangles->occluded(r); })};
    contests[2].triangles = {packets(false), one_by_one(intersect)};
  }
#endif
  for (const Contest& contest : contests) print_contest(name, contest, options.runs);
}

std::optional<Options> parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool has_value = i + 1 < argc;
    if (word == "--no-triangles")
      options.triangles = false;
    else if (word == "--res" && has_value) {
      if (std::sscanf(argv[++i], "%dx%d", &options.resolution.x, &options.resolution.y) != 2) return {};
    } else if (word == "--runs" && has_value)
      options.runs = std::atoi(argv[++i]);
    else if (word == "--voxel" && has_value)
      options.voxel_in_pixels = std::atof(argv[++i]);
    else if (word.starts_with("--"))
      return {};
    else
      options.scenes.push_back(word);
  }
  if (options.resolution.x < 1 || options.resolution.y < 1 || options.runs < 1 || !(options.voxel_in_pixels > 0) || options.scenes.empty())
    return {};
  return options;
}

int run(int argc, char** argv) {
  const std::optional<Options> options = parse(argc, argv);
  if (!options) {
    std::fprintf(stderr, "usage: engine_vs_triangles [--res WxH] [--runs N] [--voxel PIXELS] [--no-triangles] SCENE...\n");
    return static_cast<int>(ExitStatus::usage);
  }
  flush_denormals_in_this_thread();
  fmt::print("{:>18} {:>7} {:>8} {:>9} {:>8} {:>9} {:>8} {:>8} {:>10}\n", "", "", "million", "kelpie", "million", "triangle", "million",
             "kelpie /", "rays that");
  fmt::print("{:>18} {:>7} {:>8} {:>9} {:>8} {:>9} {:>8} {:>8} {:>10}\n", "scene", "rays", "rays", "CPU s", "per s", "CPU s", "per s",
             "triangle", "disagree");
  for (const std::string& scene : options->scenes) measure(scene, *options);
  return 0;
}

} // namespace
} // namespace kelpie

int main(int argc, char** argv) {
  try {
    return kelpie::run(argc, argv);
  } catch (const kelpie::Error& error) {
    for (const kelpie::Problem& p : error.problems) std::fprintf(stderr, "error: %s\n", kelpie::to_string(p).c_str());
    return static_cast<int>(error.status);
  }
}
