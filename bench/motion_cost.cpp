// What motion blur costs: a frame of the knot cloud still, and with every blob moving by one radius of influence while
// the shutter is open, at equal samples per pixel. One thread; CPU seconds of building and of rendering.
//
//   motion_cost [spp] [runs]      prints the medians of interleaved runs
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>

#include <tbb/global_control.h>

#include "bench/knot_cloud.h"
#include "renderer/render_frame.h"

namespace kelpie {
namespace {

enum class Motion { none, together, apart };

FrameScene make_scene(int count, Motion motion, int spp) {
  const auto start = std::make_shared<const BlobCloud>(make_knot_cloud(count));
  auto end = std::make_shared<BlobCloud>(*start);
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  for (Blob& b : *end) {
    const Vec3 way(normal(random), normal(random), normal(random));
    b.centre += b.radius * (motion == Motion::together ? glm::normalize(Vec3(1, 1, 0)) : glm::normalize(way));
  }
  const auto moment = [=](double t) {
    auto cloud = std::make_shared<BlobCloud>(*start);
    for (size_t i = 0; i < cloud->size(); ++i) (*cloud)[i].centre += ((*end)[i].centre - (*start)[i].centre) * static_cast<float>(t);
    Blobs<SampledMode> blobs;
    blobs.cloud = cloud;
    SampledShape shape;
    shape.name = "knot", shape.field.nodes.emplace_back(blobs);
    FrameScene scene;
    scene.frame = t;
    scene.shapes.push_back(std::move(shape));
    scene.camera.position = Vec3(0.6f, 2.2f, 5.2f), scene.camera.look_at = Vec3(0), scene.camera_stands = true;
    SunLight<SampledMode> sun;
    sun.direction = Vec3(1, 2, 1), sun.angle = 0;
    scene.lights.emplace_back(sun);
    scene.film.resolution = {1280, 720}, scene.film.spp = spp, scene.film.bounces = 0;
    return scene;
  };
  FrameScene scene = moment(0.5);
  if (motion != Motion::none) scene.moment = moment, scene.camera.shutter = 1;
  return scene;
}

struct Cost {
  double build = 0, render = 0;
  size_t slabs = 0, cells = 0;
  double solved = 0, evaluations = 0; ///< a ray
};

Cost cost_of(const FrameScene& scene) {
  Diagnostics diagnostics;
  EnvironmentCache cache;
  const std::vector<Light> lights = make_lights(scene, cache, diagnostics);
  const double start = process_cpu_s();
  const Tracer tracer(scene);
  const double built = process_cpu_s();
  const IntegrateResult result = integrate(scene, tracer, lights, {0, 0, scene.film.resolution.x, scene.film.resolution.y}, [](double) {});
  const double rays = double(result.rays.camera + result.rays.shadow);
  return {built - start,
          process_cpu_s() - built,
          tracer.slab_count(),
          tracer.cell_count(),
          double(result.rays.solve.total().cells) / rays,
          double(result.rays.solve.total().evaluations) / rays};
}

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
  return v[v.size() / 2];
}

void measure(int count, int spp, int runs) {
  constexpr const char* k_names[] = {"still", "together", "apart"};
  std::vector<double> build[3], render[3];
  Cost last[3];
  for (int run = 0; run < runs; ++run)
    for (int m = 0; m < 3; ++m) {
      last[m] = cost_of(make_scene(count, Motion(m), spp));
      build[m].push_back(last[m].build), render[m].push_back(last[m].render);
    }
  const double still = median(build[0]) + median(render[0]);
  for (int m = 0; m < 3; ++m)
    std::printf("%6d blobs, %-8s  build %.3f s  render %.3f s  ratio %.2f  (%zu slabs, %zu cells; a ray: %.2f cells, %.1f evaluations)\n",
                count, k_names[m], median(build[m]), median(render[m]), (median(build[m]) + median(render[m])) / still, last[m].slabs,
                last[m].cells, last[m].solved, last[m].evaluations);
}

} // namespace
} // namespace kelpie

int main(int argc, char** argv) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const int spp = argc > 1 ? std::atoi(argv[1]) : 16, runs = argc > 2 ? std::atoi(argv[2]) : 5;
  for (const int count : {10'000, 100'000}) kelpie::measure(count, spp, runs);
}
