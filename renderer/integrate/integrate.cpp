#include "renderer/integrate/integrate.h"

#include <array>
#include <mutex>

#include <tbb/parallel_for.h>

#include "renderer/film/pixel_filter.h"
#include "renderer/integrate/camera_rays.h"

namespace kelpie {

namespace {

constexpr int k_tile = 16;
/// Its pixels go by squares of this side.
constexpr int k_block = 4;
static_assert(k_block * k_block <= k_packet);
/// Z of a pixel without a surface.
constexpr float k_far = 1e10f;

/// The channels of a frame; null where the film does not ask for them.
struct Channels {
  std::array<float*, 4> rgba{};
  std::array<float*, 3> p{}, n{}, albedo{};
  float *z = nullptr, *cost = nullptr;

  Channels(FrameImage& image, const std::vector<Aov>& aovs) {
    const auto wants = [&](Aov a) { return std::find(aovs.begin(), aovs.end(), a) != aovs.end(); };
    const auto add = [&](auto& pointers, std::initializer_list<const char*> names) {
      for (const char* name : names) image.add(name);
      size_t i = 0;
      for (const char* name : names) names_.push_back({name, &pointers[i++]});
    };
    add(rgba, {"R", "G", "B", "A"});
    if (wants(Aov::Z)) image.add("Z"), names_.push_back({"Z", &z});
    if (wants(Aov::P)) add(p, {"P.X", "P.Y", "P.Z"});
    if (wants(Aov::N)) add(n, {"N.X", "N.Y", "N.Z"});
    if (wants(Aov::albedo)) add(albedo, {"albedo.R", "albedo.G", "albedo.B"});
    if (wants(Aov::cost)) image.add("cost"), names_.push_back({"cost", &cost});
    for (const auto& entry : names_) *entry.second = image.find(entry.first)->pixels.data(); // stable now that all are there
  }

  static void set(const std::array<float*, 3>& to, size_t i, const Vec3& v) {
    if (to[0])
      for (int c = 0; c < 3; ++c) to[c][i] = v[c];
  }

private:
  std::vector<std::pair<const char*, float**>> names_;
};

class FrameIntegrator {
public:
  FrameIntegrator(const FrameScene& frame, const Tracer& tracer, const std::vector<Light>& lights, const PixelBox& window,
                  IntegrateResult& out)
      : frame_(frame), paths_(tracer, lights, frame), camera_(frame.camera, frame.film.resolution), filter_(frame.film.filter),
        window_(window), out_(out), channels_(out.image, frame.film.aovs), camera_inside_(tracer.shapes_around(frame.camera.position)),
        frame_number_(static_cast<uint32_t>(std::llround(frame.frame))) {}

  void tile(int x0, int y0) {
    flush_denormals_in_this_thread();
    TileTally tally;
    const int x1 = std::min(x0 + k_tile, window_.x1), y1 = std::min(y0 + k_tile, window_.y1);
    for (int y = y0; y < y1; y += k_block)
      for (int x = x0; x < x1; x += k_block) block({x, y, std::min(x + k_block, x1), std::min(y + k_block, y1)}, tally);
    const std::lock_guard lock(mutex_);
    out_.rays.add(tally.rays);
    out_.nonfinite += tally.nonfinite;
    if (tally.nonfinite) out_.first_nonfinite = tally.where;
  }

private:
  struct TileTally {
    RayCounters rays;
    uint64_t nonfinite = 0;
    Vec2i where{0};
  };

  /// What a pixel's samples add up to.
  struct PixelTally {
    Vec3 radiance{0}, albedo{0};
    int hits = 0;
    uint64_t evaluations = 0; ///< only where the film asks for `cost`
    PathResult central;       ///< of the sample nearest to the pixel's centre
    float nearest = std::numeric_limits<float>::infinity();

    void add(const PathResult& path, Vec2 offset) {
      radiance += path.radiance;
      hits += path.is_hit;
      if (path.is_hit) albedo += path.albedo;
      if (const float distance = glm::dot(offset, offset); distance < nearest) nearest = distance, central = path;
    }
  };

  /// Pixels side by side, a packet of paths for each sample. Which pixels share a packet does not show.
  void block(const PixelBox& box, TileTally& tally) {
    std::array<PixelTally, k_block * k_block> pixels;
    std::array<Vec2, k_block * k_block> offsets;
    std::vector<Path> paths;
    paths.reserve(pixels.size());
    const int spp = frame_.film.spp;
    for (int s = 0; s < spp; ++s) {
      paths.clear();
      for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x) paths.push_back(start(x, y, s, offsets[paths.size()]));
      trace(paths, pixels, tally.rays);
      for (size_t i = 0; i < paths.size(); ++i) {
        PathResult& path = paths[i].result;
        if (!is_finite(path.radiance)) {
          ++tally.nonfinite, tally.where = place(box, i);
          path.radiance = Vec3(0);
        }
        pixels[i].add(path, offsets[i]);
      }
    }
    for (size_t i = 0; i < paths.size(); ++i) store(out_.image.index(place(box, i).x, place(box, i).y), pixels[i]);
  }

  /// For `cost` one by one: what a path evaluates in a packet depends on the others. What it finds does not.
  void trace(std::span<Path> paths, std::span<PixelTally> pixels, RayCounters& counters) const {
    if (!channels_.cost) return paths_.trace(paths, counters);
    for (size_t i = 0; i < paths.size(); ++i) {
      const uint64_t before = counters.solve.total().evaluations;
      paths_.trace(paths.subspan(i, 1), counters);
      pixels[i].evaluations += counters.solve.total().evaluations - before;
    }
  }

  /// The i-th pixel of a block.
  static Vec2i place(const PixelBox& box, size_t i) {
    const int n = static_cast<int>(i);
    return {box.x0 + n % box.width(), box.y0 + n / box.width()};
  }

  Path start(int x, int y, int sample, Vec2& offset) const {
    Sampler sampler(static_cast<uint32_t>(x), static_cast<uint32_t>(y), frame_number_, static_cast<uint32_t>(sample));
    offset = filter_.offset(sampler.next_pair());
    const Vec2 lens = frame_.camera.aperture > 0 ? sampler.next_pair() : Vec2(0);
    Ray ray = camera_.through(Vec2(x + 0.5f, y + 0.5f) + offset, lens);
    ray.inside = camera_inside_;
    return {ray, sampler};
  }

  void store(size_t i, const PixelTally& pixel) const {
    const float share = 1.f / static_cast<float>(frame_.film.spp);
    const PathResult& central = pixel.central;
    for (int c = 0; c < 3; ++c) channels_.rgba[c][i] = pixel.radiance[c] * share;
    channels_.rgba[3][i] = static_cast<float>(pixel.hits) * share;
    Channels::set(channels_.albedo, i, pixel.albedo * share);
    // Geometry is not averaged: between two surfaces there is none.
    if (channels_.cost) channels_.cost[i] = static_cast<float>(pixel.evaluations) * share;
    if (channels_.z) channels_.z[i] = central.is_hit ? camera_.depth(central.hit.position) : k_far;
    Channels::set(channels_.p, i, central.is_hit ? central.hit.position : Vec3(0));
    Channels::set(channels_.n, i, central.is_hit ? central.hit.normal : Vec3(0));
  }

  static bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

  const FrameScene& frame_;
  PathTracer paths_;
  CameraRays camera_;
  PixelFilterSampler filter_;
  PixelBox window_;
  IntegrateResult& out_;
  Channels channels_;
  ShapeSet camera_inside_;
  uint32_t frame_number_;
  std::mutex mutex_;
};

} // namespace

IntegrateResult integrate(const FrameScene& frame, const Tracer& tracer, const std::vector<Light>& lights, const PixelBox& window,
                          const std::function<void(double)>& progress, const std::atomic<bool>& stop) {
  IntegrateResult result;
  result.image = FrameImage(frame.film.resolution, window);
  FrameIntegrator integrator(frame, tracer, lights, window, result);
  const int columns = (window.width() + k_tile - 1) / k_tile, rows = (window.height() + k_tile - 1) / k_tile;
  tbb::parallel_for(0, columns * rows, [&](int tile) {
    if (stop) return;
    integrator.tile(window.x0 + tile % columns * k_tile, window.y0 + tile / columns * k_tile);
    progress(1.0 / (columns * rows));
  });
  result.was_stopped = stop;
  return result;
}

} // namespace kelpie
