// No missed and no false hit: thousands of rays through the engine, each judged by the reference.
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/every_kind.h"
#include "tests/support/examination.h"

namespace kelpie {
namespace {

constexpr int k_rays = 10000;

void expect_exact(const BlobCloud& cloud, int rays = k_rays, const CellLimits& limits = {}) {
  expect_right(judge_both_ways({field_of(cloud), 1, rays, limits}));
}

TEST(Tracer, CoincidentBlobs) { expect_exact(coincident_cloud(Falloff::quartic)); }
TEST(Tracer, ThinBlobs) { expect_exact(thin_cloud(Falloff::quartic)); }
TEST(Tracer, NegativeBlobs) { expect_exact(negative_cloud(Falloff::quartic)); }

TEST(Tracer, Ellipsoids) {
  for (const Falloff f : {Falloff::quartic, Falloff::wyvill}) {
    expect_exact(ellipsoid_cloud(f), k_rays / 2);
    expect_exact(ellipsoid_cloud(f), k_rays / 4, k_small_cells);
  }
}

TEST(Tracer, EllipsoidsInTrees) {
  SampledField field = field_of(ellipsoid_cloud(Falloff::quartic));
  Segment<SampledMode> segment;
  segment.from = Vec3(-1), segment.to = Vec3(1), segment.radius = 0.3f, segment.weight = 2;
  Difference<SampledMode> cut;
  cut.children = {unsigned(field.nodes.size() - 1), add(field, segment)};
  add(field, cut);
  expect_right(judge_both_ways({field, 1, 2000, {}}));
}

// Below an affine warp that is no similarity they are as well blobs.
TEST(Tracer, EllipsoidsBelowAffineWarps) {
  SampledField field = field_of(ellipsoid_cloud(Falloff::quartic));
  Rotate<SampledMode> turn;
  turn.axis = Vec3(1, 2, 3), turn.angle = 50, turn.child = unsigned(field.nodes.size() - 1);
  Scale<SampledMode> scale;
  scale.by = Vec3(0.5f), scale.child = add(field, turn);
  add(field, scale);
  expect_right(judge_both_ways({field, 1, 2000, {}}));
  std::get<Scale<SampledMode>>(field.nodes.back()).by = Vec3(0.5f, 0.8f, 1.1f);
  expect_right(judge_both_ways({field, 1, 1000, {}}));
}

// Far from a tiny blob a quadratic in powers of s loses the digits that decide.
TEST(Tracer, TinyBlobsInLongCells) {
  BlobCloud cloud;
  for (int i = 0; i < 12; ++i) {
    Random r(i);
    cloud.push_back({Vec3(r.direction()), float(r.uniform(1e-3, 3e-3)), 2, Falloff::quartic});
  }
  CellLimits one_cell;
  one_cell.sparse_side = 1e9f;
  // From within a blob a thousand times smaller than its cell the answer is a little less exact than elsewhere: rays that start
  // at the surface are judged in cells of the usual size.
  Examination examination(field_of(cloud), 1, k_rays, one_cell);
  for (const Way way : {Way::alone, Way::in_packets}) expect_right(examination.judge(way));
  expect_exact(cloud);
}

TEST(Tracer, TheCoarsestCells) {
  CellLimits coarsest;
  while (make_coarser(coarsest)) {
  }
  for (const BlobCloud& cloud : {coincident_cloud(Falloff::quartic), thin_cloud(Falloff::quartic), negative_cloud(Falloff::wyvill)})
    expect_exact(cloud, 3000, coarsest);
}

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
  constexpr int k_trees = 500, k_rays_a_tree = 100;
  Tallies all;
  for (int trial = 0; trial < k_trees && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    SampledField field;
    random_tree(r, 1 + trial % 3, field);
    all += judge_both_ways({field, trial % 2 ? 1.f : 0.6f, k_rays_a_tree, trial % 4 < 2 ? CellLimits{} : k_small_cells});
    expect_nothing_wrong(all);
  }
  expect_right(all);
}

TEST(Tracer, AFieldThatNeverReachesTheThresholdIsNothing) {
  Examination examination(field_of({Blob{Vec3(0), 1, 0.9f, Falloff::quartic}}), 1, 200);
  for (const Way way : {Way::alone, Way::in_packets}) {
    const Tally tally = examination.judge(way);
    expect_nothing_wrong(tally);
    EXPECT_EQ(tally.asked, 200);
    EXPECT_EQ(tally.hits, 0);
  }
}

/// Every bit of an answer.
bool is_same(const Question& a, const Question& b) {
  if (a.found != b.found || a.shadowed != b.shadowed) return false;
  return !a.found || (a.hit.t == b.hit.t && a.hit.position == b.hit.position && a.hit.normal == b.hit.normal &&
                      a.hit.shape == b.hit.shape && a.hit.epsilon == b.hit.epsilon && a.hit.is_leaving == b.hit.is_leaving);
}

// A ray's answer does not depend on what it shares a packet with, on its lane, or on how full the packet is,
// to the last bit; and it is the answer that the ray gets alone, but for rounding.
/// Whether the field is the threshold, 1, where a ray was answered.
bool is_surface(const reference::Node& field, const Question& q) {
  const Vec3 p = q.ray.origin + q.hit.t * q.ray.direction;
  return std::abs(reference::value(field, {p.x, p.y, p.z}, 1) - 1) < 1e-5;
}

TEST(Tracer, APacketIsNoMoreThanItsRays) {
  std::vector<std::pair<SampledField, CellLimits>> fields;
  for (const BlobCloud& cloud : {coincident_cloud(Falloff::quartic), thin_cloud(Falloff::quartic), negative_cloud(Falloff::wyvill)})
    for (const CellLimits& limits : {CellLimits{}, k_small_cells}) fields.push_back({field_of(cloud), limits});
  for (int trial = 0; trial < 60; ++trial) {
    Random r(trial);
    SampledField field;
    random_tree(r, 1 + trial % 3, field);
    fields.push_back({field, k_small_cells});
  }
  const EveryKind kinds;
  for (unsigned trial = 0; trial < 3000; trial += 307) {
    Random r(trial);
    fields.push_back({kinds.random_field(trial, r), trial % 2 ? CellLimits{} : k_small_cells});
  }
  size_t hits = 0, far_apart = 0;
  for (auto& [field, limits] : fields) {
    const reference::NodePtr reference = reference_of(field);
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
      // Each may be off by half of that, or more where the ray grazes and the field hardly rises along it.
      const bool differ = std::abs(first[i].hit.t - questions[i].hit.t) > 2e-5f * examination.size();
      far_apart +=
          first[i].found != questions[i].found || (differ && !(is_surface(*reference, first[i]) && is_surface(*reference, questions[i])));
    }
  }
  EXPECT_GT(hits, 5000u);
  EXPECT_LE(far_apart, hits / 5000) << "of " << hits; // of a ray that only touches either answer is right
}

} // namespace
} // namespace kelpie
