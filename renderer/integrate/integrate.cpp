#include "renderer/integrate/integrate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <mutex>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "renderer/film/pixel_filter.h"
#include "renderer/integrate/camera_rays.h"
#include "renderer/integrate/sample_batch.h"
#include "renderer/trace/surroundings.h"

namespace kelpie {

namespace {

constexpr int k_tile = 16;
/// Its pixels go by squares of this side.
constexpr int k_block = 4;
static_assert(k_block * k_block <= k_packet);
/// So many samples of a pixel are taken at once, if it has as many.
constexpr uint32_t k_most_at_once = 16;
/// Z of a pixel without a surface.
constexpr float k_far = 1e10f;

/// The channels of a frame; null where the film does not ask for them.
struct Channels {
  std::array<float*, 4> rgba{};
  std::array<float*, 3> p{}, n{}, albedo{};
  std::array<float*, 2> motion{};
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
    if (wants(Aov::motion)) add(motion, {"motion.X", "motion.Y"});
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
                  const std::function<void(double)>& progress, IntegrateResult& out)
      : frame_(frame), tracer_(tracer), paths_(tracer, lights, frame), camera_(frame), filter_(frame.film.filter), window_(window),
        progress_(progress), out_(out), channels_(out.image, frame.film.aovs), surroundings_(tracer, camera_.bounds()),
        frame_number_(static_cast<uint32_t>(std::llround(frame.frame))), is_exposed_(frame.moment && frame.camera.shutter > 0),
        batch_(samples_at_once(frame.film.spp, tracer.window_count())) {
    if (channels_.motion[0]) next_camera_.emplace(frame, 1);
  }

  void tile(int x0, int y0) {
    flush_denormals_in_this_thread();
    TileTally tally;
    const int x1 = std::min(x0 + k_tile, window_.x1), y1 = std::min(y0 + k_tile, window_.y1);
    Batch batch;
    for (int y = y0; y < y1; y += k_block)
      for (int x = x0; x < x1; x += k_block) {
        const PixelBox pixels{x, y, std::min(x + k_block, x1), std::min(y + k_block, y1)};
        block(pixels, batch, tally);
        progress_(static_cast<double>(pixels.area()) / static_cast<double>(window_.area()));
      }
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

  /// A sample of one of a block's pixels: what its path begins with, and what it found.
  struct Sample {
    Sampler sampler; ///< as the path has it
    Vec2 offset, lens;
    float time;
    uint32_t pixel;
    int number; ///< among the samples of the pixel
    Vec3 radiance{0}, albedo{0};
    bool is_hit = false;
  };

  /// What a pixel's samples add up to.
  struct PixelTally {
    Vec3 radiance{0}, albedo{0};
    int hits = 0;
    uint64_t evaluations = 0; ///< only where the film asks for `cost`
    PathResult central;       ///< of the sample nearest to the pixel's centre; of equals the first
    Ray central_ray;          ///< as it left the camera
    float nearest = std::numeric_limits<float>::infinity();
    int central_number = 0;

    void add(const Sample& sample) {
      radiance += sample.radiance;
      hits += sample.is_hit;
      if (sample.is_hit) albedo += sample.albedo;
    }
    bool is_central(const Sample& sample) {
      const float distance = glm::dot(sample.offset, sample.offset);
      if (distance > nearest || (distance == nearest && sample.number > central_number)) return false;
      nearest = distance, central_number = sample.number;
      return true;
    }
  };

  /// Samples that are taken at once, and memory for their paths: kept from block to block.
  struct Batch {
    std::vector<Sample> samples;
    std::vector<uint32_t> order, begin, next; ///< the samples' indices by parts, where each part begins, and where it goes on
    std::vector<Path> paths;
    std::vector<Ray> rays; ///< of the paths, as they left the camera

    /// Sorts the samples by what `part` of `count` each belongs to; in a part they stay in order.
    template <class Part>
    void sort(size_t count, const Part& part) {
      begin.assign(count + 1, 0), order.resize(samples.size());
      for (const Sample& s : samples) ++begin[part(s) + 1];
      std::partial_sum(begin.begin(), begin.end(), begin.begin());
      next = begin;
      for (uint32_t i = 0; i < samples.size(); ++i) order[next[part(samples[i])]++] = i;
    }
  };

  /// Pixels side by side. Where things move, paths that share a packet had better see nearly the same moment: so several
  /// samples of each pixel are taken at once, traced by their times, and added as they came. What shares a packet does not
  /// show.
  void block(const PixelBox& box, Batch& batch, TileTally& tally) {
    std::array<PixelTally, k_block * k_block> pixels;
    const int spp = frame_.film.spp;
    for (int first = 0; first < spp; first += batch_) {
      const int end = std::min(first + batch_, spp);
      batch.samples.clear();
      for (uint32_t i = 0; i < box.area(); ++i) take_samples(place(box, i), i, first, end, batch.samples);
      // The sampler puts one sample of a pixel into each moment; in the last batch it may be more.
      const auto parts = static_cast<size_t>(batch_);
      if (is_exposed_)
        batch.sort(parts, [&](const Sample& s) { return static_cast<size_t>(s.time * static_cast<float>(parts)); });
      else
        batch.sort(parts, [&](const Sample& s) { return static_cast<size_t>(s.number - first); });
      for (size_t part = 0; part < parts; ++part)
        for (size_t i = batch.begin[part]; i < batch.begin[part + 1]; i += k_packet)
          follow(std::span(batch.order).subspan(i, std::min(k_packet, batch.begin[part + 1] - i)), box, batch, pixels, tally);
      for (const Sample& s : batch.samples) pixels[s.pixel].add(s);
    }
    for (size_t i = 0; i < box.area(); ++i) store(out_.image.index(place(box, i).x, place(box, i).y), pixels[i]);
  }

  /// Follows the paths of some samples, at most a packet.
  void follow(std::span<const uint32_t> indices, const PixelBox& box, Batch& batch, std::span<PixelTally> pixels, TileTally& tally) const {
    batch.paths.clear(), batch.rays.clear();
    for (const uint32_t i : indices) {
      const Sample& s = batch.samples[i];
      batch.paths.emplace_back(camera_ray(s, place(box, s.pixel)), s.sampler, camera_.cone(frame_.film.spp));
      batch.rays.push_back(batch.paths.back().ray);
    }
    trace(indices, batch, pixels, tally.rays);
    for (size_t j = 0; j < indices.size(); ++j) {
      Sample& s = batch.samples[indices[j]];
      PathResult& result = batch.paths[j].result;
      if (!is_finite(result.radiance)) {
        ++tally.nonfinite, tally.where = place(box, s.pixel);
        result.radiance = Vec3(0);
      }
      s.radiance = result.radiance, s.albedo = result.albedo, s.is_hit = result.is_hit;
      PixelTally& pixel = pixels[s.pixel];
      if (pixel.is_central(s)) pixel.central = result, pixel.central_ray = batch.rays[j];
    }
  }

  /// For `cost` one by one: what a path evaluates in a packet depends on the others. What it finds does not.
  void trace(std::span<const uint32_t> indices, Batch& batch, std::span<PixelTally> pixels, RayCounters& counters) const {
    const std::span<Path> paths = batch.paths;
    if (!channels_.cost) return paths_.trace(paths, counters);
    for (size_t i = 0; i < paths.size(); ++i) {
      const uint64_t before = counters.solve.total().evaluations;
      paths_.trace(paths.subspan(i, 1), counters);
      pixels[batch.samples[indices[i]].pixel].evaluations += counters.solve.total().evaluations - before;
    }
  }

  /// The i-th pixel of a block.
  static Vec2i place(const PixelBox& box, size_t i) {
    const int n = static_cast<int>(i);
    return {box.x0 + n % box.width(), box.y0 + n / box.width()};
  }

  void take_samples(Vec2i at, uint32_t pixel, int first, int end, std::vector<Sample>& out) const {
    const PixelSeed seed(static_cast<uint32_t>(at.x), static_cast<uint32_t>(at.y), frame_number_);
    const bool has_lens = frame_.camera.aperture > 0;
    for (int start = first; start < end; start += k_packet) {
      const size_t count = std::min(k_packet, static_cast<size_t>(end - start));
      const auto from = static_cast<uint32_t>(start);
      std::array<float, k_packet> x, y, lens_x{}, lens_y{}, time{};
      uint32_t calls = 0;
      next_pairs(seed, calls++, from, count, x.data(), y.data());
      if (has_lens) next_pairs(seed, calls++, from, count, lens_x.data(), lens_y.data());
      if (is_exposed_) next_numbers(seed, calls++, from, count, time.data());
      for (size_t i = 0; i < count; ++i) {
        const Vec2 offset = filter_.offset({x[i], y[i]}), lens(lens_x[i], lens_y[i]);
        const int number = start + static_cast<int>(i);
        out.push_back({Sampler(seed, static_cast<uint32_t>(number), calls), offset, lens, time[i], pixel, number});
      }
    }
  }

  Ray camera_ray(const Sample& s, Vec2i place) const {
    const CameraRays camera = camera_.at(s.time);
    Ray ray = camera.through(Vec2(place) + Vec2(0.5f) + s.offset, s.lens);
    ray.time = s.time;
    ray.inside = surroundings_.shapes_around(camera.position(), s.time);
    return ray;
  }

  void store(size_t i, const PixelTally& pixel) const {
    const float share = 1.f / static_cast<float>(frame_.film.spp);
    const PathResult& central = pixel.central;
    for (int c = 0; c < 3; ++c) channels_.rgba[c][i] = pixel.radiance[c] * share;
    channels_.rgba[3][i] = static_cast<float>(pixel.hits) * share;
    Channels::set(channels_.albedo, i, pixel.albedo * share);
    // Geometry is not averaged: between two surfaces there is none.
    if (channels_.cost) channels_.cost[i] = static_cast<float>(pixel.evaluations) * share;
    if (channels_.z) channels_.z[i] = central.is_hit ? camera_.at(pixel.central_ray.time).depth(central.hit.position) : k_far;
    if (channels_.motion[0]) {
      const Vec2 way = motion(pixel);
      channels_.motion[0][i] = way.x, channels_.motion[1][i] = way.y;
    }
    Channels::set(channels_.p, i, central.is_hit ? central.hit.position : Vec3(0));
    Channels::set(channels_.n, i, central.is_hit ? central.hit.normal : Vec3(0));
  }

  /// From this frame to the next, in pixels: the surface with its velocity, seen by both cameras. What is infinitely far
  /// moves by the camera alone.
  Vec2 motion(const PixelTally& pixel) const {
    const Ray& ray = pixel.central_ray;
    const CameraRays now = camera_.at(ray.time), next = next_camera_->at(ray.time);
    const bool is_hit = pixel.central.is_hit;
    const Vec3 from = is_hit ? pixel.central.hit.position : now.position() + ray.direction;
    const Vec3 to = is_hit ? from + tracer_.velocity(pixel.central.hit) : next.position() + ray.direction;
    const Vec2 way = next.film_of(to) - now.film_of(from);
    const bool is_seen = next.depth(to) > 0 && std::isfinite(way.x) && std::isfinite(way.y); // else it passes the camera
    return is_seen ? way : Vec2(0);
  }

  /// Powers of two: there the sampler puts one sample into each equal part of time.
  static int samples_at_once(int spp, size_t windows) {
    return static_cast<int>(std::max(std::min(k_most_at_once, std::bit_floor(static_cast<uint32_t>(spp))), static_cast<uint32_t>(windows)));
  }

  static bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

  const FrameScene& frame_;
  const Tracer& tracer_;
  PathTracer paths_;
  MovingCamera camera_;                     ///< in the exposure
  std::optional<MovingCamera> next_camera_; ///< a frame later: only where the film asks for motion
  PixelFilterSampler filter_;
  PixelBox window_;
  const std::function<void(double)>& progress_;
  IntegrateResult& out_;
  Channels channels_;
  Surroundings surroundings_; ///< of the camera
  uint32_t frame_number_;
  bool is_exposed_; ///< rays have times
  int batch_;       ///< samples of a pixel that are taken at once, and moments by which they go: at least the windows of time
  std::mutex mutex_;
};

} // namespace

IntegrateResult integrate(const FrameScene& frame, const Tracer& tracer, const std::vector<Light>& lights, const PixelBox& window,
                          const std::function<void(double)>& progress) {
  IntegrateResult result;
  result.image = FrameImage(frame.film.resolution, window);
  FrameIntegrator integrator(frame, tracer, lights, window, progress, result);
  const int columns = (window.width() + k_tile - 1) / k_tile, rows = (window.height() + k_tile - 1) / k_tile;
  parallel_for(0, columns * rows,
               [&](int tile) { integrator.tile(window.x0 + tile % columns * k_tile, window.y0 + tile / columns * k_tile); });
  return result;
}

} // namespace kelpie
