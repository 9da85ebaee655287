#include "morph/liquid/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "field/mesh/weld.h"

namespace kelpie {

namespace {

/// SplitMix64 (Steele, Lea, Flood 2014): the standard library's distributions differ between libraries.
class Random {
public:
  explicit Random(uint64_t seed) : state_(seed) {}
  /// Uniform in [0, 1).
  double next() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

private:
  uint64_t state_;
};

Vec3d normalized_or(const Vec3d& v, const Vec3d& otherwise) {
  const double length = glm::length(v);
  return length > 1e-3 ? v / length : otherwise;
}

/// Unit normals at the vertices; 0 where those around cancel out.
std::vector<Vec3d> vertex_normals(const Mesh& mesh) {
  const std::vector<uint32_t> first = first_at_same_place(mesh.positions);
  std::vector<Vec3d> sums(mesh.positions.size(), Vec3d(0)), normals;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d& a = mesh.positions[t[0]];
    const Vec3d area = glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
    for (const uint32_t v : t) sums[first[v]] += area;
  }
  for (const uint32_t v : first) normals.push_back(sums[v] / std::max(glm::length(sums[v]), 1e-300));
  return normals;
}

/// Draws points by area.
class Sampler {
public:
  Sampler(const Mesh& mesh, uint64_t seed) : mesh_(mesh), random_(seed), normals_(vertex_normals(mesh)) {
    for (const Triangle& t : mesh.triangles) {
      const Vec3d& a = mesh.positions[t[0]];
      area_ += 0.5 * glm::length(glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a));
      area_up_to_.push_back(area_);
    }
  }

  double area() const { return area_; }

  SurfaceSample draw() {
    const double at = random_.next() * area_;
    const auto it = std::upper_bound(area_up_to_.begin(), area_up_to_.end(), at);
    const Triangle& t = mesh_.triangles[std::min<size_t>(static_cast<size_t>(it - area_up_to_.begin()), area_up_to_.size() - 1)];
    const Vec3d &a = mesh_.positions[t[0]], &b = mesh_.positions[t[1]], &c = mesh_.positions[t[2]];
    const double s = std::sqrt(random_.next()), u = random_.next();
    const double weights[] = {1 - s, s * (1 - u), s * u};
    const Vec3d face = glm::normalize(glm::cross(b - a, c - a));
    Vec3d mean(0);
    for (size_t k = 0; k < 3; ++k) mean += weights[k] * normals_[t[k]];
    return {a * weights[0] + b * weights[1] + c * weights[2], face, normalized_or(mean, face)};
  }

private:
  const Mesh& mesh_;
  Random random_;
  std::vector<Vec3d> normals_;
  double area_ = 0;
  std::vector<double> area_up_to_;
};

/// Points in cells of a grid: who is near whom.
class PointGrid {
public:
  explicit PointGrid(double cell) : cell_(cell) {}
  /// Of points on the other side of a sheet only if `both_sides` are one.
  bool has_within(const SurfaceSample& s, double distance, bool both_sides) const {
    const Vec3d& p = s.position;
    const glm::i64vec3 c = cell_of(p);
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz) {
          const auto it = points_.find(key(c + glm::i64vec3(dx, dy, dz)));
          if (it == points_.end()) continue;
          for (const SurfaceSample& q : it->second)
            if (glm::dot(q.position - p, q.position - p) < distance * distance && (both_sides || glm::dot(q.normal, s.normal) > 0))
              return true;
        }
    return false;
  }
  void add(const SurfaceSample& s) { points_[key(cell_of(s.position))].push_back(s); }

private:
  glm::i64vec3 cell_of(const Vec3d& p) const { return glm::i64vec3(glm::floor(p / cell_)); }
  static uint64_t key(const glm::i64vec3& c) {
    return (static_cast<uint64_t>(c.x) & 0x1fffff) | (static_cast<uint64_t>(c.y) & 0x1fffff) << 21 |
           (static_cast<uint64_t>(c.z) & 0x1fffff) << 42;
  }
  double cell_;
  std::unordered_map<uint64_t, std::vector<SurfaceSample>> points_;
};

} // namespace

std::vector<SurfaceSample> spread_samples(const Mesh& mesh, size_t count, uint64_t seed, Sides sides) {
  Sampler sampler(mesh, seed);
  std::vector<SurfaceSample> samples;
  if (!(sampler.area() > 0)) return samples;
  // `count` points in the densest packing stand sqrt(2 A / (sqrt(3) n)) apart; darts fill up at 0.7 to 0.75 of that.
  const double distance = 0.7 * std::sqrt(2 * sampler.area() / (std::sqrt(3.0) * static_cast<double>(count)));
  PointGrid grid(distance);
  for (size_t dart = 0; dart < 12 * count && samples.size() < count; ++dart) {
    const SurfaceSample s = sampler.draw();
    if (grid.has_within(s, distance, sides == Sides::together)) continue;
    grid.add(s);
    samples.push_back(s);
  }
  return samples;
}

std::vector<SurfaceSample> random_samples(const Mesh& mesh, size_t count, uint64_t seed) {
  Sampler sampler(mesh, seed);
  std::vector<SurfaceSample> samples;
  if (!(sampler.area() > 0)) return samples;
  for (size_t i = 0; i < count; ++i) samples.push_back(sampler.draw());
  return samples;
}

} // namespace kelpie
