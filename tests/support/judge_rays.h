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

  Tally& operator+=(const Tally& t) {
    hits += t.hits, missed += t.missed, false_hits += t.false_hits, wrong_normals += t.wrong_normals;
    disagreeing_shadows += t.disagreeing_shadows;
    return *this;
  }
};

/// Normals differ from the reference's by at most the angle of this cosine (8 degrees), where a position
/// rounded to float has a normal to compare.
inline constexpr double k_normal_cosine = 0.99;

/// Over a millionth of a unit no field that is continuous changes so: there it was cut by the jump of a warp.
inline constexpr double k_jump_slope = 1e5;

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

/// A ray with what was answered.
struct Question {
  Ray ray;
  double at_origin; ///< the field there, in thresholds
  bool found, shadowed;
  Hit hit;
};

inline void judge_answer(const Question& q, const reference::Node& node, double threshold, const Box3& box, Tally& tally) {
  const reference::Ray exact{reference_of(q.ray.origin), reference_of(q.ray.direction)};
  const Stretch s = inside(exact, box);
  tally.disagreeing_shadows += q.shadowed != q.found;
  tally.hits += q.found;
  if (!(s.from < s.to)) {
    tally.false_hits += q.found;
    return;
  }
  reference::Profile profile = reference::along_ray(node, exact, s.from, s.to, threshold);
  if (q.at_origin > 1) profile = reflected(std::move(profile), threshold);
  const double answer = q.found ? double(q.hit.t) : std::numeric_limits<double>::infinity();
  // t is a float: what it cannot say far from the scene is no error.
  const double farthest = std::min(answer, s.to), ulps = 2 * std::numeric_limits<float>::epsilon() * farthest;
  const reference::Tolerance tolerance{1e-4, 1e-5 + (farthest > 10 * box.diagonal() ? ulps / box.diagonal() : 0)};
  const Verdict verdict = reference::judge(profile, threshold, box.diagonal(), answer, tolerance);
  tally.missed += verdict == Verdict::missed;
  tally.false_hits += verdict == Verdict::false_hit;
  if (verdict != Verdict::right && tally.missed + tally.false_hits < 4)
    ADD_FAILURE() << (verdict == Verdict::missed ? "missed" : "false") << ", t = " << answer << (q.at_origin > 1 ? " from inside" : "")
                  << ", ray from " << q.ray.origin.x << ' ' << q.ray.origin.y << ' ' << q.ray.origin.z << " along " << q.ray.direction.x
                  << ' ' << q.ray.direction.y << ' ' << q.ray.direction.z;
  double slope = 0;
  if (q.found && verdict == Verdict::right) {
    const reference::Vec n = unit_gradient(node, exact.at(q.hit.t), threshold, 1e-6, slope) * -1;
    double other_slope = 0;
    const reference::Vec m = unit_gradient(node, exact.at(q.hit.t), threshold, 1e-7, other_slope) * -1;
    // Where the field is nearly flat, creased or torn a position rounded to float has no normal to compare. Across a small
    // tear the slope grows as the step shrinks.
    const bool is_torn = slope > k_jump_slope || other_slope > 3 * slope;
    const bool has_normal = slope > 0.3 && !is_torn && dot(n, m) > 0.9999 && farthest < 10 * box.diagonal();
    if (has_normal && dot(n, reference_of(q.hit.normal)) < k_normal_cosine) ++tally.wrong_normals;
  }
}

/// How the questions are put: each alone, or by 16 as they come.
enum class Way { alone, in_packets };

inline void ask(const Tracer& tracer, Way way, std::vector<Question>& questions) {
  SolveCounters counters;
  if (way == Way::alone) {
    for (Question& q : questions) q.found = tracer.intersect(q.ray, counters, q.hit), q.shadowed = tracer.occluded(q.ray, counters);
    return;
  }
  for (size_t first = 0; first < questions.size(); first += k_packet) {
    const std::span<Question> part = std::span(questions).subspan(first, std::min(k_packet, questions.size() - first));
    std::vector<Ray> rays;
    for (const Question& q : part) rays.push_back(q.ray);
    std::array<Hit, k_packet> hits;
    const uint32_t found = tracer.intersect(rays, counters, hits.data()), shadowed = tracer.occluded(rays, counters);
    for (size_t i = 0; i < part.size(); ++i) part[i].found = found >> i & 1, part[i].shadowed = shadowed >> i & 1, part[i].hit = hits[i];
  }
}

/// All that a field is asked in a test.
class Examination {
public:
  Examination(const SampledField& field, float threshold, int rays, const CellLimits& limits = {}, double most_sizes = 3)
      : scene_(scene_of(field, threshold)), threshold_(threshold), tracer_(scene_, limits), node_(reference_of(field)),
        box_(tracer_.bounds()) {
    if (box_.is_empty()) box_ = {Vec3(-1), Vec3(1)};
    box_ = box_.padded(0.01f * box_.diagonal());
    std::vector<reference::Leaf> leaves;
    collect_leaves(*node_, leaves);
    for (int i = 0; i < rays; ++i) {
      Random r(i);
      Question q{};
      q.ray = random_ray(r, box_, leaves, i % 4 != 0, i % 3 == 1 ? most_sizes : 3);
      q.at_origin = value(*node_, reference_of(q.ray.origin), threshold_) / threshold_;
      if (std::abs(q.at_origin - 1) < 0.01) continue; // neither outside nor inside
      if (q.at_origin > 1) q.ray.inside.add(0);       // the only shape
      questions_.push_back(q);
    }
  }

  Tally judge(Way way) {
    ask(tracer_, way, questions_);
    Tally tally;
    for (const Question& q : questions_) judge_answer(q, *node_, threshold_, box_, tally);
    return tally;
  }

  const Tracer& tracer() const { return tracer_; }
  std::vector<Question>& questions() { return questions_; }
  float size() const { return box_.diagonal(); }

private:
  FrameScene scene_;
  double threshold_;
  Tracer tracer_;
  reference::NodePtr node_;
  Box3 box_;
  std::vector<Question> questions_;
};

/// Random rays, put both ways; `most_sizes`: from how far away they come, in scene sizes.
inline Tally judge_rays(const SampledField& field, float threshold, int rays, const CellLimits& limits = {}, double most_sizes = 3) {
  Examination examination(field, threshold, rays, limits, most_sizes);
  Tally tally = examination.judge(Way::alone);
  tally += examination.judge(Way::in_packets);
  return tally;
}

} // namespace kelpie
