// No missed and no false hit: thousands of rays through the engine, each judged by the reference.
#include <gtest/gtest.h>

#include "renderer/trace/tracer.h"
#include "tests/reference/verdict.h"
#include "tests/support/random_scene.h"
#include "tests/support/reference_scene.h"

namespace kelpie {
namespace {

using reference::Verdict;

constexpr int k_rays = 10000;

// --- rays ---

struct Stretch {
  double from, to;
};

/// Where the ray is in the box; to < from if nowhere.
Stretch inside(const reference::Ray& ray, const Box3& box) {
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
Vec3 random_target(Random& r, const Box3& box, const std::vector<reference::Leaf>& leaves) {
  if (leaves.empty() || r.below(2)) return Vec3(r.in(Box3d{Vec3d(box.lower), Vec3d(box.upper)}));
  const reference::Leaf& leaf = leaves[r.below(int(leaves.size()))];
  return Vec3(Vec3d(leaf.a.x, leaf.a.y, leaf.a.z) + r.direction() * leaf.radius * square(r.uniform(0, 1)));
}

Ray random_ray(Random& r, const Box3& box, const std::vector<reference::Leaf>& leaves, bool starts_far) {
  Ray ray;
  const double size = box.diagonal();
  const Vec3 target = random_target(r, box, leaves);
  if (r.below(10) == 0) { // along an axis: many cells share their borders with such rays
    ray.direction[r.below(3)] = r.below(2) ? 1.f : -1.f;
    ray.origin = target - ray.direction * float(starts_far ? 2 * size : 0.1 * size);
    return ray;
  }
  ray.origin = starts_far ? box.centre() + Vec3(r.direction() * r.uniform(0.6, 3) * size) : random_target(r, box, {});
  ray.direction = glm::normalize(target - ray.origin);
  return ray;
}

void collect_leaves(const reference::Node& node, std::vector<reference::Leaf>& out) {
  out.insert(out.end(), node.leaves.begin(), node.leaves.end());
  for (const reference::NodePtr& child : node.children) collect_leaves(*child, out);
}

struct Tally {
  int hits = 0, missed = 0, false_hits = 0, wrong_normals = 0, disagreeing_shadows = 0;
};

/// What leaves the shape enters 2T - f.
reference::Profile reflected(reference::Profile profile, double threshold) {
  for (reference::Piece& p : profile) p.f = reference::constant(2 * threshold) - p.f;
  return profile;
}

reference::Vec unit_gradient(const reference::Node& node, reference::Vec p, double threshold, double& length) {
  constexpr double k_step = 1e-6;
  const auto slope = [&](reference::Vec h) { return (value(node, p + h, threshold) - value(node, p - h, threshold)) / (2 * k_step); };
  const reference::Vec g{slope({k_step, 0, 0}), slope({0, k_step, 0}), slope({0, 0, k_step})};
  length = reference::length(g);
  return g * (1 / length);
}

void judge_ray(const Tracer& tracer, const reference::Node& node, double threshold, const Box3& box, Ray ray, Tally& tally) {
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
  const Verdict verdict = reference::judge(profile, threshold, box.diagonal(), answer);
  tally.missed += verdict == Verdict::missed;
  tally.false_hits += verdict == Verdict::false_hit;
  if (verdict != Verdict::right && tally.missed + tally.false_hits < 4)
    ADD_FAILURE() << (verdict == Verdict::missed ? "missed" : "false") << ", t = " << answer << (at_origin > 1 ? " from inside" : "")
                  << ", ray from " << ray.origin.x << ' ' << ray.origin.y << ' ' << ray.origin.z << " along " << ray.direction.x << ' '
                  << ray.direction.y << ' ' << ray.direction.z;
  double slope = 0;
  if (found && verdict == Verdict::right) {
    const reference::Vec n = unit_gradient(node, exact.at(hit.t), threshold, slope) * -1;
    // Where the field is nearly flat or creased a position rounded to float has no normal to compare.
    if (slope > 0.3 && dot(n, reference_of(hit.normal)) < 0.99) ++tally.wrong_normals;
  }
}

Tally judge_rays(const SampledField& field, float threshold, int rays, const CellLimits& limits = {}) {
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
    judge_ray(tracer, *node, threshold, box, random_ray(r, box, leaves, i % 4 != 0), tally);
  }
  return tally;
}

void expect_exact(const BlobCloud& cloud) {
  const Tally tally = judge_rays(field_of(cloud), 1, k_rays);
  EXPECT_EQ(tally.missed, 0);
  EXPECT_EQ(tally.false_hits, 0);
  EXPECT_EQ(tally.disagreeing_shadows, 0);
  EXPECT_EQ(tally.wrong_normals, 0);
  EXPECT_GT(tally.hits, k_rays / 10);
}

TEST(Tracer, CoincidentBlobs) { expect_exact(coincident_cloud(Falloff::quartic)); }
TEST(Tracer, ThinBlobs) { expect_exact(thin_cloud(Falloff::quartic)); }
TEST(Tracer, NegativeBlobs) { expect_exact(negative_cloud(Falloff::quartic)); }

TEST(Tracer, OtherFalloffsAndMixtures) {
  BlobCloud mixture;
  for (const Falloff f : {Falloff::cubic, Falloff::wyvill}) {
    for (const BlobCloud& part : {coincident_cloud(f), thin_cloud(f), negative_cloud(f)})
      mixture.insert(mixture.end(), part.begin(), part.end());
    expect_exact(thin_cloud(f));
    expect_exact(negative_cloud(f));
  }
  expect_exact(mixture);
}

TEST(Tracer, TreesOfEverything) {
  constexpr int k_trees = 500, k_rays_a_tree = 200;
  int hits = 0;
  for (int trial = 0; trial < k_trees; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    SampledField field;
    random_tree(r, 1 + trial % 3, field);
    const Tally tally = judge_rays(field, trial % 2 ? 1.f : 0.6f, k_rays_a_tree, trial % 4 < 2 ? CellLimits{} : k_small_cells);
    EXPECT_EQ(tally.missed, 0);
    EXPECT_EQ(tally.false_hits, 0);
    EXPECT_EQ(tally.disagreeing_shadows, 0);
    hits += tally.hits;
  }
  EXPECT_GT(hits, k_trees * k_rays_a_tree / 10);
}

TEST(Tracer, AFieldThatNeverReachesTheThresholdIsNothing) {
  const Tally tally = judge_rays(field_of({Blob{Vec3(0), 1, 0.9f, Falloff::quartic}}), 1, 200);
  EXPECT_EQ(tally.hits, 0);
}

} // namespace
} // namespace kelpie
