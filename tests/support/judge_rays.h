// The engine's answers to rays, each judged by the reference.
#pragma once

#include <gtest/gtest.h>

#include "tests/reference/verdict.h"
#include "tests/support/random_rays.h"

namespace kelpie {

using reference::Verdict;

/// How many rays were asked for, and what was wrong with the answers.
struct Tally {
  int asked = 0, hits = 0, missed = 0, false_hits = 0;
  int normals = 0, wrong_normals = 0;
  int dark = 0, wrong_shadows = 0, disagreeing_shadows = 0;

  Tally& operator+=(const Tally& t) {
    asked += t.asked, hits += t.hits, missed += t.missed, false_hits += t.false_hits;
    normals += t.normals, wrong_normals += t.wrong_normals;
    dark += t.dark, wrong_shadows += t.wrong_shadows, disagreeing_shadows += t.disagreeing_shadows;
    return *this;
  }
};

inline void expect_nothing_wrong(const Tally& tally) {
  EXPECT_EQ(tally.missed, 0);
  EXPECT_EQ(tally.false_hits, 0);
  EXPECT_EQ(tally.wrong_normals, 0);
  EXPECT_EQ(tally.wrong_shadows, 0);
  EXPECT_EQ(tally.disagreeing_shadows, 0);
}
/// And that so many of the rays met something, which mostly has a normal to compare.
inline void expect_right(const Tally& tally, double least_share = 0.1) {
  expect_nothing_wrong(tally);
  EXPECT_GT(tally.hits, least_share * tally.asked) << "of " << tally.asked;
  EXPECT_GT(tally.normals, tally.hits / 2) << "of " << tally.hits;
}

/// The reference's picture of a shape at a ray's time.
struct Picture {
  reference::NodePtr node;
  double threshold;
};

/// A ray with what was answered.
struct Question {
  Ray ray;
  Picture picture;
  bool found = false, shadowed = false;
  Hit hit{};
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

inline reference::Vec unit_gradient(const Picture& picture, reference::Vec p, double step, double& length) {
  const auto at = [&](reference::Vec q) { return value(*picture.node, q, picture.threshold); };
  const auto slope = [&](reference::Vec h) { return (at(p + h) - at(p - h)) / (2 * step); };
  const reference::Vec g{slope({step, 0, 0}), slope({0, step, 0}), slope({0, 0, step})};
  length = reference::length(g);
  return g * (1 / length);
}

/// Whether the normal of an answer that is right is so too. Where the field is nearly flat, creased or torn, a position rounded to
/// float has no normal to compare. Across a small tear the slope grows as the step shrinks.
inline void judge_normal(const Question& q, const reference::Ray& exact, Tally& tally) {
  double slope = 0, finer_slope = 0;
  const reference::Vec n = unit_gradient(q.picture, exact.at(q.hit.t), 1e-6, slope) * -1;
  const reference::Vec m = unit_gradient(q.picture, exact.at(q.hit.t), 1e-7, finer_slope) * -1;
  const bool is_torn = slope > k_jump_slope || finer_slope > 3 * slope;
  if (!(slope > 0.3) || is_torn || !(dot(n, m) > 0.9999)) return;
  ++tally.normals;
  tally.wrong_normals += dot(n, reference_of(q.hit.normal)) < k_normal_cosine;
}

inline void say_what_is_wrong(const char* what, const Question& q) {
  const auto text = [](const Vec3& v) { return testing::PrintToString(std::array{v.x, v.y, v.z}); };
  ADD_FAILURE() << what << (q.found ? ", t = " + testing::PrintToString(q.hit.t) : ", no hit") << (q.shadowed ? ", dark" : ", lit")
                << (q.ray.inside.is_empty() ? "" : ", from inside") << ", ray from " << text(q.ray.origin) << " along "
                << text(q.ray.direction) << " up to " << q.ray.t_far << " at time " << q.ray.time;
}

/// Judges what was answered between the two ends of a ray; `box`: around all that there is.
inline void judge_answer(const Question& q, const Box3& box, Tally& tally) {
  constexpr int k_most_said = 4;
  const double threshold = q.picture.threshold;
  const bool is_endless = std::isinf(q.ray.t_far);
  const reference::Ray exact{reference_of(q.ray.origin), reference_of(q.ray.direction)};
  Stretch s = inside(exact, box);
  s.to = std::min(s.to, double(q.ray.t_far));
  ++tally.asked;
  tally.hits += q.found, tally.dark += q.shadowed;
  tally.disagreeing_shadows += is_endless && q.shadowed != q.found; // near the end of a ray rounding decides
  if (!(s.from < s.to)) {
    tally.false_hits += q.found, tally.wrong_shadows += q.shadowed;
    return;
  }
  reference::Profile profile = reference::along_ray(*q.picture.node, exact, s.from, s.to, threshold);
  if (!q.ray.inside.is_empty()) profile = reflected(std::move(profile), threshold); // of the only shape
  const double answer = q.found ? double(q.hit.t) : std::numeric_limits<double>::infinity();
  // t is a float: what it cannot say far from the scene is no error.
  const double farthest = std::min(answer, s.to), ulps = 2 * std::numeric_limits<float>::epsilon() * farthest;
  const bool is_far = farthest > 10 * box.diagonal();
  const reference::Tolerance tolerance{1e-4, 1e-5 + (is_far ? ulps / box.diagonal() : 0)};
  const Verdict verdict = reference::judge(profile, threshold, box.diagonal(), answer, tolerance);
  tally.missed += verdict == Verdict::missed;
  tally.false_hits += verdict == Verdict::false_hit;
  if (verdict != Verdict::right && tally.missed + tally.false_hits < k_most_said)
    say_what_is_wrong(verdict == Verdict::missed ? "missed" : "false", q);
  if (!reference::is_right_shadow(profile, threshold, box.diagonal(), q.shadowed, tolerance) && ++tally.wrong_shadows < k_most_said)
    say_what_is_wrong("wrong shadow", q);
  if (q.found && verdict == Verdict::right && !is_far) judge_normal(q, exact, tally);
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

} // namespace kelpie
