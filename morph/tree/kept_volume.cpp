#include "morph/tree/kept_volume.h"

#include <array>
#include <numbers>

#include "base/sample_record.h"
#include "field/potential/falloff.h"

namespace kelpie {

namespace {

constexpr size_t k_points = 4096;
constexpr int k_steps = 16; ///< of each path; even, so that one lies in the middle

/// The i-th of points that fill the unit cube evenly: Roberts's additive recurrence, of the powers of the root of x^4 = x + 1.
Vec3d even_point(size_t i) {
  constexpr double k_root = 1.2207440846057596;
  const Vec3d step(1 / k_root, 1 / (k_root * k_root), 1 / (k_root * k_root * k_root));
  return glm::fract(0.5 + double(i) * step);
}

/// A leaf at one moment, of which only the solid counts. Calls visit(piece) for each of the skeletons that it is.
class Solid {
public:
  Solid(const AnimatedKind& kind, double frame) : kind_(kind), frame_(frame) {}

  /// The radius of influence, and how far from the skeleton the solid ends that has half the weight; none if it cannot be measured.
  std::optional<std::pair<double, double>> radii() const {
    std::optional<std::pair<double, double>> found;
    with_pieces(1, [&](const auto& k) {
      if constexpr (requires { k.falloff; }) found = std::pair(1.0, std::sqrt(inverse_falloff(k.falloff, 0.5)));
    });
    if (found) {
      const double radius = radius_at_frame();
      found = std::pair(radius, radius * found->second);
    }
    return found;
  }

  /// The volume of what lies no farther from the skeleton; 0 if it is too thin in its box to be measured.
  double volume(double distance) const {
    constexpr std::ptrdiff_t k_least = 64;
    const auto [all, squared] = squared_distances(distance);
    const auto inside = std::count_if(squared.begin(), squared.end(), [&](double d2) { return d2 <= distance * distance; });
    return inside < k_least ? 0 : all * double(inside) / double(k_points);
  }

  /// How far from the skeleton a solid of this volume ends: no farther than the radius of a ball of it.
  double distance_of(double volume) const {
    auto [all, squared] = squared_distances(std::cbrt(volume * 3 / (4 * std::numbers::pi)));
    const size_t count = std::min(k_points - 1, size_t(double(k_points) * volume / all));
    std::nth_element(squared.begin(), squared.begin() + std::ptrdiff_t(count), squared.end());
    return std::sqrt(squared[count]);
  }

private:
  float radius_at_frame() const {
    return std::visit(
        [&](const auto& k) {
          if constexpr (requires { k.radius.at(frame_); }) return k.radius.at(frame_);
          return 0.f;
        },
        kind_);
  }

  template <class Visit>
  void with_pieces(float radius, Visit&& visit) const {
    const auto one = [&]<template <class> class Kind>(const Kind<AnimatedMode>& kind) {
      const std::array<unsigned, 1> no_child{};
      const std::array<MaterialIndex, 4> no_materials{};
      using K = Kind<SampledMode>;
      if constexpr (
          ComplexPrimitive<K> && !requires(const K k) { k.parent_from_pieces(); } && requires(K k) { k.radius = radius; }) {
        K k = sample_record(kind, frame_, no_child.data(), no_materials.data());
        k.radius = radius;
        k.for_each_piece(k.divisions(), visit);
      } else if constexpr (SolidSkeleton<K>) {
        K k = sample_record(kind, frame_, no_child.data(), no_materials.data());
        k.radius = radius;
        visit(k);
      }
    };
    std::visit(one, kind_);
  }

  /// The volume of a box that reaches so far, and the squared distances of points in it.
  std::pair<double, std::vector<double>> squared_distances(double reach) const {
    Box3d box;
    with_pieces(float(reach), [&](const auto& k) {
      const Box3 support = k.support();
      box.extend(Box3d{Vec3d(support.lower), Vec3d(support.upper)});
    });
    std::vector<double> squared(k_points, std::numeric_limits<double>::infinity());
    const Vec3d extent = box.upper - box.lower;
    with_pieces(float(reach), [&](const auto& k) {
      if constexpr (requires { k.solid(); }) {
        const auto solid = k.solid();
        for (size_t i = 0; i < k_points; ++i) {
          const Vec3d p = box.lower + even_point(i) * extent;
          squared[i] = std::min(squared[i], double(squared_distance(solid, Point3<double>{p.x, p.y, p.z})));
        }
      }
    });
    return {extent.x * extent.y * extent.z, std::move(squared)};
  }

  const AnimatedKind& kind_;
  double frame_;
};

Curve<float> constant_one() { return Curve<float>({{0, 1.f, {}}}, Interpolation::linear); }

} // namespace

Curve<float> factor_for_volume(const SkeletonPath& path, double frame) {
  if (path.stages.size() != 2) return constant_one();
  const AnimatedKind &start = path.stages.front().from, &end = path.stages.back().to;
  const auto from = Solid(start, frame).radii(), to = Solid(end, frame).radii();
  if (!from || !to) return constant_one();
  if (from->second / from->first != to->second / to->first) return constant_one(); // of other falloffs, of which both are there on the way
  const double start_volume = Solid(start, frame).volume(from->second), end_volume = Solid(end, frame).volume(to->second);

  if (start_volume == 0 || end_volume == 0) return constant_one();

  std::vector<Key<float>> keys{{0, 1.f, {}}};
  for (int i = 1; i < k_steps; ++i) {
    const double s = double(i) / k_steps;
    const SkeletonPath::Stage& stage = path.stages[s < 0.5 ? 0 : 1];
    const std::optional<AnimatedKind> kind = mixed_kind(stage.from, stage.to, float(s < 0.5 ? 2 * s : 2 * s - 1));
    const Solid solid(*kind, frame);
    const double distance = solid.distance_of((1 - s) * start_volume + s * end_volume);
    const std::optional<std::pair<double, double>> plain = solid.radii();
    constexpr double k_least = 0.1; // where the bare skeleton is larger than the solid shall be
    keys.push_back({s, float(std::max(k_least, distance / plain->second)), {}});
  }
  keys.push_back({1, 1.f, {}});
  return Curve<float>(std::move(keys), Interpolation::smooth);
}

} // namespace kelpie
