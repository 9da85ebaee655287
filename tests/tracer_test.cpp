// No missed and no false hit: thousands of rays through the engine, each judged by the reference.
#include <numeric>
#include <random>

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

/// A ray with what was answered.
struct Question {
  Ray ray;
  double at_origin; ///< the field there, in thresholds
  bool found, shadowed;
  Hit hit;
};

void judge_answer(const Question& q, const reference::Node& node, double threshold, const Box3& box, Tally& tally) {
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
  const Verdict verdict = reference::judge(profile, threshold, box.diagonal(), answer);
  tally.missed += verdict == Verdict::missed;
  tally.false_hits += verdict == Verdict::false_hit;
  if (verdict != Verdict::right && tally.missed + tally.false_hits < 4)
    ADD_FAILURE() << (verdict == Verdict::missed ? "missed" : "false") << ", t = " << answer << (q.at_origin > 1 ? " from inside" : "")
                  << ", ray from " << q.ray.origin.x << ' ' << q.ray.origin.y << ' ' << q.ray.origin.z << " along " << q.ray.direction.x
                  << ' ' << q.ray.direction.y << ' ' << q.ray.direction.z;
  double slope = 0;
  if (q.found && verdict == Verdict::right) {
    const reference::Vec n = unit_gradient(node, exact.at(q.hit.t), threshold, slope) * -1;
    // Where the field is nearly flat or creased a position rounded to float has no normal to compare.
    if (slope > 0.3 && dot(n, reference_of(q.hit.normal)) < 0.99) ++tally.wrong_normals;
  }
}

/// How the questions are put: each alone, or by 16 as they come.
enum class Way { alone, in_packets };

void ask(const Tracer& tracer, Way way, std::vector<Question>& questions) {
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
  Examination(const SampledField& field, float threshold, int rays, const CellLimits& limits = {})
      : scene_(scene_of(field, threshold)), threshold_(threshold), tracer_(scene_, limits), node_(reference_of(field)),
        box_(tracer_.bounds()) {
    if (box_.is_empty()) box_ = {Vec3(-1), Vec3(1)};
    box_ = box_.padded(0.01f * box_.diagonal());
    std::vector<reference::Leaf> leaves;
    collect_leaves(*node_, leaves);
    for (int i = 0; i < rays; ++i) {
      Random r(i);
      Question q{};
      q.ray = random_ray(r, box_, leaves, i % 4 != 0);
      q.at_origin = value(*node_, reference_of(q.ray.origin), threshold_) / threshold_;
      if (std::abs(q.at_origin - 1) < 0.01) continue; // neither outside nor inside
      if (q.at_origin > 1) q.ray.inside = 0;          // the only shape
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

void expect_exact(const BlobCloud& cloud) {
  Examination examination(field_of(cloud), 1, k_rays);
  for (const Way way : {Way::alone, Way::in_packets}) {
    SCOPED_TRACE(way == Way::alone ? "alone" : "in packets");
    const Tally tally = examination.judge(way);
    EXPECT_EQ(tally.missed, 0);
    EXPECT_EQ(tally.false_hits, 0);
    EXPECT_EQ(tally.disagreeing_shadows, 0);
    EXPECT_EQ(tally.wrong_normals, 0);
    EXPECT_GT(tally.hits, k_rays / 10);
  }
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
    Examination examination(field, trial % 2 ? 1.f : 0.6f, k_rays_a_tree, trial % 4 < 2 ? CellLimits{} : k_small_cells);
    for (const Way way : {Way::alone, Way::in_packets}) {
      if (way == Way::in_packets && trial % 5) continue; // cells of code take the same solver
      const Tally tally = examination.judge(way);
      EXPECT_EQ(tally.missed, 0);
      EXPECT_EQ(tally.false_hits, 0);
      EXPECT_EQ(tally.disagreeing_shadows, 0);
      if (way == Way::alone) hits += tally.hits;
    }
  }
  EXPECT_GT(hits, k_trees * k_rays_a_tree / 10);
}

TEST(Tracer, AFieldThatNeverReachesTheThresholdIsNothing) {
  Examination examination(field_of({Blob{Vec3(0), 1, 0.9f, Falloff::quartic}}), 1, 200);
  EXPECT_EQ(examination.judge(Way::alone).hits, 0);
  EXPECT_EQ(examination.judge(Way::in_packets).hits, 0);
}

/// Every bit of an answer.
bool is_same(const Question& a, const Question& b) {
  if (a.found != b.found || a.shadowed != b.shadowed) return false;
  return !a.found || (a.hit.t == b.hit.t && a.hit.position == b.hit.position && a.hit.normal == b.hit.normal &&
                      a.hit.shape == b.hit.shape && a.hit.epsilon == b.hit.epsilon);
}

// A ray's answer does not depend on what it shares a packet with, on its lane, or on how full the packet is,
// to the last bit; and it is the answer that the ray gets alone, but for rounding.
TEST(Tracer, APacketIsNoMoreThanItsRays) {
  std::vector<std::pair<SampledField, CellLimits>> fields;
  for (const BlobCloud& cloud : {coincident_cloud(Falloff::quartic), thin_cloud(Falloff::quartic), negative_cloud(Falloff::wyvill)})
    for (const CellLimits& limits : {CellLimits{}, k_small_cells}) fields.push_back({field_of(cloud), limits});
  for (int trial = 0; trial < 40; ++trial) {
    Random r(trial);
    SampledField field;
    random_tree(r, 1 + trial % 3, field);
    fields.push_back({field, k_small_cells});
  }
  size_t hits = 0, far_apart = 0;
  for (auto& [field, limits] : fields) {
    Examination examination(field, 1, field.nodes.size() == 1 ? 4000 : 400, limits);
    std::vector<Question>& questions = examination.questions();
    ask(examination.tracer(), Way::in_packets, questions);
    const std::vector<Question> first = questions;

    std::vector<size_t> order(first.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::shuffle(order.begin(), order.end(), std::mt19937(1));
    std::vector<Question> shuffled;
    for (const size_t i : order) shuffled.push_back(first[i]);
    ask(examination.tracer(), Way::in_packets, shuffled);
    for (size_t i = 0; i < order.size(); ++i) ASSERT_TRUE(is_same(shuffled[i], first[order[i]])) << i;

    for (const Question& q : first) {
      std::vector<Question> lone{q};
      ask(examination.tracer(), Way::in_packets, lone);
      ASSERT_TRUE(is_same(lone[0], q));
    }

    ask(examination.tracer(), Way::alone, questions);
    for (size_t i = 0; i < first.size(); ++i) {
      hits += first[i].found;
      // Rays that graze within the negligible may be answered either way.
      far_apart += first[i].found != questions[i].found || std::abs(first[i].hit.t - questions[i].hit.t) > 1e-5f * examination.size();
    }
  }
  EXPECT_GT(hits, 5000u);
  EXPECT_LE(far_apart, hits / 2000);
}

} // namespace
} // namespace kelpie
