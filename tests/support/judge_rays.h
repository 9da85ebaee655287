// Random rays through the engine, each judged by the reference.
#pragma once

#include <gtest/gtest.h>

#include "renderer/trace/tracer.h"
#include "tests/reference/verdict.h"
#include "tests/support/random_scene.h"
#include "tests/support/reference_scene.h"

namespace kelpie {

using reference::Verdict;

struct Stretch {
  double from, to;
};

/// Where the ray is in the box; to < from if nowhere.
inline Stretch inside(const reference::Ray& ray, const Box3& box) {
  Stretch s{0, std::numeric_limits<double>::infinity()};
  const double o[] = {ray.origin.x, ray.origin.y, ray.origin.z}, d[] = {ray.direction.x, ray.direction.y, ray.direction.z};
  for (int i = 0; i < 3; ++i) {
    if (d[i] == 0) {
      if (o[i] < box.lower[i] || o[i] > box.upper[i]) return {1, 0};
      continue;
    }
    const double a = (box.lower[i] - o[i]) / d[i], b = (box.upper[i] - o[i]) / d[i];
    s.from = std::max(s.from, std::min(a, b)), s.to = std::min(s.to, std::max(a, b));
  }
  return s;
}

/// Something to aim at: half of the time anywhere in the box, half of the time at or past an element, where
/// surfaces are small, thin or grazed.
inline Vec3 random_target(Random& r, const Box3& box, const std::vector<reference::Leaf>& leaves) {
  if (leaves.empty() || r.below(2)) return Vec3(r.in(Box3d{Vec3d(box.lower), Vec3d(box.upper)}));
  const reference::Leaf& leaf = leaves[r.below(int(leaves.size()))];
  return Vec3(Vec3d(leaf.a.x, leaf.a.y, leaf.a.z) + r.direction() * leaf.radius * square(r.uniform(0, 1)));
}

inline Ray random_ray(Random& r, const Box3& box, const std::vector<reference::Leaf>& leaves, bool starts_far, double most_sizes = 3) {
  Ray ray;
  const double size = box.diagonal();
  const Vec3 target = random_target(r, box, leaves);
  if (r.below(10) == 0) { // along an axis: many cells share their borders with such rays
    ray.direction[r.below(3)] = r.below(2) ? 1.f : -1.f;
    ray.origin = target - ray.direction * float(starts_far ? 2 * size : 0.1 * size);
    return ray;
  }
  ray.origin = starts_far
                   ? box.centre() + Vec3(r.direction() * (most_sizes > 3 ? r.log_uniform(0.6, most_sizes) : r.uniform(0.6, 3)) * size)
                   : random_target(r, box, {});
  ray.direction = glm::normalize(target - ray.origin);
  return ray;
}

inline void collect_leaves(const reference::Node& node, std::vector<reference::Leaf>& out) {
  out.insert(out.end(), node.leaves.begin(), node.leaves.end());
  for (const reference::NodePtr& child : node.children) collect_leaves(*child, out);
}

struct Tally {
  int hits = 0, missed = 0, false_hits = 0, wrong_normals = 0, disagreeing_shadows = 0;
};

/// Normals differ from the reference's by at most the angle of this cosine (8 degrees), where a position
/// rounded to float has a normal to compare.
inline constexpr double k_normal_cosine = 0.99;

/// What leaves the shape enters 2T - f.
inline reference::Profile reflected(reference::Profile profile, double threshold) {
  for (reference::Piece& p : profile) p.f = reference::constant(2 * threshold) - p.f;
  return profile;
}

inline reference::Vec unit_gradient(const reference::Node& node, reference::Vec p, double threshold, double step, double& length) {
  const auto slope = [&](reference::Vec h) { return (value(node, p + h, threshold) - value(node, p - h, threshold)) / (2 * step); };
  const reference::Vec g{slope({step, 0, 0}), slope({0, step, 0}), slope({0, 0, step})};
  length = reference::length(g);
  return g * (1 / length);
}

inline void judge_ray(const Tracer& tracer, const reference::Node& node, double threshold, const Box3& box, Ray ray, Tally& tally) {
  const reference::Ray exact{reference_of(ray.origin), reference_of(ray.direction)};
  const Stretch s = inside(exact, box);
  const double at_origin = value(node, exact.origin, threshold) / threshold;
  if (std::abs(at_origin - 1) < 0.01) return; // neither outside nor inside
  if (at_origin > 1) ray.inside = 0;          // the only shape
  Hit hit;
  SolveCounters counters;
  const bool found = tracer.intersect(ray, counters, hit);
  tally.disagreeing_shadows += tracer.occluded(ray, counters) != found;
  tally.hits += found;
  if (!(s.from < s.to)) {
    tally.false_hits += found;
    return;
  }
  reference::Profile profile = reference::along_ray(node, exact, s.from, s.to, threshold);
  if (at_origin > 1) profile = reflected(std::move(profile), threshold);
  const double answer = found ? double(hit.t) : std::numeric_limits<double>::infinity();
  // t is a float: what it cannot say far from the scene is no error.
  const double farthest = std::min(answer, s.to), ulps = 2 * std::numeric_limits<float>::epsilon() * farthest;
  const reference::Tolerance tolerance{1e-4, 1e-5 + (farthest > 10 * box.diagonal() ? ulps / box.diagonal() : 0)};
  const Verdict verdict = reference::judge(profile, threshold, box.diagonal(), answer, tolerance);
  tally.missed += verdict == Verdict::missed;
  tally.false_hits += verdict == Verdict::false_hit;
  if (verdict != Verdict::right && tally.missed + tally.false_hits < 4)
    ADD_FAILURE() << (verdict == Verdict::missed ? "missed" : "false") << ", t = " << answer << (at_origin > 1 ? " from inside" : "")
                  << ", ray from " << ray.origin.x << ' ' << ray.origin.y << ' ' << ray.origin.z << " along " << ray.direction.x << ' '
                  << ray.direction.y << ' ' << ray.direction.z;
  double slope = 0;
  if (found && verdict == Verdict::right) {
    const reference::Vec n = unit_gradient(node, exact.at(hit.t), threshold, 1e-6, slope) * -1;
    double other_slope = 0;
    const reference::Vec m = unit_gradient(node, exact.at(hit.t), threshold, 1e-7, other_slope) * -1;
    // Where the field is nearly flat or creased a position rounded to float has no normal to compare.
    const bool has_normal = slope > 0.3 && dot(n, m) > 0.9999 && farthest < 10 * box.diagonal();
    if (has_normal && dot(n, reference_of(hit.normal)) < k_normal_cosine) ++tally.wrong_normals;
  }
}

inline Tally judge_rays(const SampledField& field, float threshold, int rays, const CellLimits& limits = {}, double most_sizes = 3) {
  const FrameScene scene = scene_of(field, threshold);
  const Tracer tracer(scene, limits);
  const reference::NodePtr node = reference_of(field);
  Box3 box = tracer.bounds();
  if (box.is_empty()) box = {Vec3(-1), Vec3(1)};
  box = box.padded(0.01f * box.diagonal());
  std::vector<reference::Leaf> leaves;
  collect_leaves(*node, leaves);
  Tally tally;
  for (int i = 0; i < rays; ++i) {
    Random r(i);
    judge_ray(tracer, *node, threshold, box, random_ray(r, box, leaves, i % 4 != 0, i % 3 == 1 ? most_sizes : 3), tally);
  }
  return tally;
}

} // namespace kelpie
