// What axial deformation costs: point inversion by itself, and a scene against its undeformed self (a camera ray a pixel and a
// shadow ray to one sun, no bounces). One thread; CPU seconds, medians of interleaved runs. What share of the rays' cost inversions
// are: how many there were while rendering times the time of one, measured apart, with all that makes a rest point of the place.
//
//   axial_cost SCENE.json [frame] [runs]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>

#include <tbb/global_control.h>

#include "bench/lane_inversion.h"
#include "field/warps/axis_tube.h"
#include "field/warps/axis_work.h"
#include "renderer/render_frame.h"
#include "scene/reader.h"

namespace kelpie {
namespace {

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
  return v[v.size() / 2];
}

using Deformations = std::vector<Axial<SampledMode>>;

/// The axial deformations of all shapes, and the scene without: each is replaced by a move by nothing.
Deformations straighten(FrameScene& scene) {
  Deformations found;
  for (SampledShape& shape : scene.shapes)
    for (auto& node : shape.field.nodes)
      if (const auto* axial = std::get_if<Axial<SampledMode>>(&node)) {
        found.push_back(*axial);
        Translate<SampledMode> still;
        still.child = axial->child;
        node = still;
      }
  return found;
}

/// Seconds of a point inversion and its rest point: one, and a SIMD vector.
struct InversionTimes {
  double one = 0, vector = 0;
};

/// In cells as large as those of a picture: a tenth of a tube's radius.
double time_vector(const Axial<SampledMode>& axial) {
  std::mt19937_64 random(2);
  const auto in = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  std::vector<LaneWarp> warps;
  std::vector<LaneAxis> axes;
  double size = INFINITY;
  for (const AxisTube& tube : axial.map->tubes()) size = std::min(size, 0.1 * tube.deformed().reach(0, 0));
  for (int i = 0; i < 2000; ++i) {
    const AxisCurve& axis = axial.map->tubes()[size_t(i) % axial.map->tubes().size()].deformed();
    const size_t step = std::min(size_t(in(0, double(axis.steps()))), axis.steps() - 1);
    const Vec3d c = axis.step(step)(in(0, 1)) + 0.3 * axis.reach(step, 0.5) * Vec3d(in(-1, 1), in(-1, 1), in(-1, 1));
    const LaneWarp warp = lane_warp(axial, Affine{}, c, c, Box3d{c - 0.5 * size, c + 0.5 * size}, axes);
    if (warp.piece_count > 0) warps.push_back(warp);
  }
  return warps.empty() ? 0 : time_lane_inversion(warps, axes.data(), float(size));
}

InversionTimes measure_inversion(const Axial<SampledMode>& axial) {
  const AxialMap& map = *axial.map;
  std::mt19937_64 random(1);
  std::vector<Vec3d> points;
  for (int i = 0; i < 20000; ++i) {
    const Box3d& box = map.tubes()[size_t(i) % map.tubes().size()].deformed().box();
    const auto in = [&](int axis) { return std::uniform_real_distribution<>(box.lower[axis], box.upper[axis])(random); };
    points.emplace_back(in(0), in(1), in(2));
  }
  axis_work() = {};
  const auto timed = [&](const auto& one) {
    std::vector<double> times;
    for (int run = 0; run < 5; ++run) {
      const double start = process_cpu_s();
      for (const Vec3d& p : points) one(p);
      times.push_back((process_cpu_s() - start) / double(points.size()) * 1e9);
    }
    return median(times);
  };
  double sum = 0; // so that nothing is left out
  AxisFoot foot;
  size_t inside = 0;
  const double one_axis = timed([&](const Vec3d& p) {
    for (const AxisTube& tube : map.tubes()) inside += tube.deformed().find(p, foot);
  });
  const AxisWork work = axis_work();
  const double inversions = double(work.inversions) / 5 / double(points.size());
  const double value = timed([&](const Vec3d& p) { sum += map.rest({p.x, p.y, p.z}).x; });
  const double slopes = timed([&](const Vec3d& p) { sum += map.rest_with_slopes(p).x.d[0]; });
  std::printf(
      "%zu axes: %.2f Newton steps an inversion, %.0f ns an inversion (%.2f of them a point); the map %.0f ns, with slopes %.0f ns%s\n",
      map.tubes().size(), double(work.newton_steps) / double(work.inversions), one_axis / inversions, inversions, value, slopes,
      std::isnan(sum) ? " !" : "");
  const double vector = time_vector(axial);
  std::printf("a vector of SIMD lanes: %.0f ns, with velocities\n", vector * 1e9);
  return {value * 1e-9, vector};
}

struct Cost {
  double build = 0, render = 0, rays = 0;
  AxisWork axis;
};

Cost cost_of(const FrameScene& scene) {
  Diagnostics diagnostics;
  EnvironmentCache cache;
  const std::vector<Light> lights = make_lights(scene, cache, diagnostics);
  const double start = process_cpu_s();
  const Tracer tracer(scene);
  const double built = process_cpu_s();
  const PixelBox all{0, 0, scene.film.resolution.x, scene.film.resolution.y};
  const IntegrateResult result = integrate(scene, tracer, lights, all, [](double) {});
  return {built - start, process_cpu_s() - built, double(result.rays.camera + result.rays.shadow), result.rays.solve.axis};
}

void measure(const char* path, int frame, int runs) {
  Diagnostics diagnostics;
  const Scene scene = read_scene(path, {}, diagnostics);
  FrameScene deformed = sample(scene, frame);
  deformed.film.resolution = {640, 360}, deformed.film.spp = 1, deformed.film.bounces = 0;
  deformed.camera.shutter = 0, deformed.film.aovs.clear();
  SunLight<SampledMode> sun;
  sun.direction = Vec3(1, 2, 1), sun.angle = 0;
  deformed.lights = {sun};
  std::erase_if(deformed.shapes, [](const SampledShape& s) { return s.geometry.has_value(); });
  FrameScene still = deformed;
  InversionTimes times;
  for (const Axial<SampledMode>& axial : straighten(still))
    if (!axial.map->tubes().empty()) times = measure_inversion(axial);
  std::vector<double> build[2], render[2];
  Cost last[2];
  for (int run = 0; run < runs; ++run)
    for (int i = 0; i < 2; ++i) {
      last[i] = cost_of(i == 0 ? still : deformed);
      build[i].push_back(last[i].build), render[i].push_back(last[i].render);
    }
  for (int i = 0; i < 2; ++i)
    std::printf("%-10s build %.3f s  render %.3f s  %.2f Mray/s  (%.2f inversions a ray)\n", i == 0 ? "undeformed" : "deformed",
                median(build[i]), median(render[i]), last[i].rays / median(render[i]) * 1e-6,
                double(last[i].axis.inversions) / last[i].rays);
  const AxisWork& axis = last[1].axis;
  const double one_by_one = double(axis.inversions - axis.in_lanes) * times.one / median(render[1]);
  const double in_lanes = double(axis.vectors) * times.vector / median(render[1]);
  std::printf("%.2f Newton steps an inversion; of the rays' cost inversions are %.0f %%: in lanes (%.0f %% of the inversions) %.0f %%, one "
              "by one %.0f %%\n",
              double(axis.newton_steps) / double(axis.inversions), 100 * (one_by_one + in_lanes),
              100 * double(axis.in_lanes) / double(axis.inversions), 100 * in_lanes, 100 * one_by_one);
  std::printf("of the undeformed one's speed: %.2f\n", last[1].rays / median(render[1]) / (last[0].rays / median(render[0])));
}

} // namespace
} // namespace kelpie

int main(int argc, char** argv) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  if (argc < 2) {
    std::fprintf(stderr, "axial_cost SCENE.json [frame] [runs]\n");
    return 2;
  }
  try {
    kelpie::measure(argv[1], argc > 2 ? std::atoi(argv[2]) : 1, argc > 3 ? std::atoi(argv[3]) : 3);
  } catch (const kelpie::Error& e) {
    std::fprintf(stderr, "axial_cost: %s\n", e.what());
    return 65;
  }
}
