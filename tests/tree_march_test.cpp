// How roots are found by lines above a field: the first one.
#define HWY_COMPILE_ONLY_STATIC
#include <gtest/gtest.h>

#include "renderer/trace/root_search-inl.h"
#include "renderer/trace/tree_march-inl.h"
#include "tests/support/random_kind.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

/// A sum of waves with a line above it on any stretch, as far off as the second derivative can bring it.
struct Waves {
  double level, height[3], rate[3], phase[3];

  explicit Waves(Random& r) : level(-r.uniform(0, 1.5)) {
    for (int i = 0; i < 3; ++i) height[i] = r.uniform(0, 0.6), rate[i] = r.log_uniform(0.5, 20), phase[i] = r.uniform(0, 6.3);
  }
  double at(double s) const {
    double sum = level;
    for (int i = 0; i < 3; ++i) sum += height[i] * std::sin(rate[i] * s + phase[i]);
    return sum;
  }
  double bend() const {
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += height[i] * rate[i] * rate[i];
    return sum;
  }
};

constexpr float k_half = 1, k_tiny = 1e-3f, k_negligible = 1e-5f;
constexpr int k_most_looks = 60;

struct Answers {
  float root[k_width];
  uint32_t hits, live;
};

/// The waves of each lane, on a stretch of its own.
Look look_at(const std::vector<const Waves*>& lanes, V stretch_middle, V stretch_half) {
  alignas(64) float middle[k_width], half[k_width], g[k_width], left[k_width], right[k_width];
  hn::Store(stretch_middle, k_lanes, middle), hn::Store(stretch_half, k_lanes, half);
  for (size_t i = 0; i < k_width; ++i) {
    const double s = double(middle[i]), h = double(half[i]), above = 0.5 * lanes[i]->bend() * h * h;
    g[i] = float(lanes[i]->at(s)), left[i] = float(lanes[i]->at(s - h) + above), right[i] = float(lanes[i]->at(s + h) + above);
  }
  return {hn::Load(k_lanes, g), {hn::Load(k_lanes, left), hn::Load(k_lanes, right)}};
}

/// As the solver of packets does it, with the waves of each lane.
Answers march_along(const std::vector<Waves>& lanes, V enough) {
  std::vector<const Waves*> pointers;
  for (const Waves& waves : lanes) pointers.push_back(&waves);
  TreeMarch march(set(k_half), hn::Not(no_lanes()), k_tiny, k_negligible);
  for (int look = 0; look < k_most_looks && !none(march.live()); ++look) {
    const TreeMarch::Stretch stretch = march.next();
    const Look seen = look_at(pointers, stretch.middle, stretch.half);
    march.learn(stretch, seen.g, seen.above, enough);
  }
  Answers out{};
  hn::StoreU(march.root(), k_lanes, out.root);
  out.hits = bits_of(march.hit()), out.live = bits_of(march.live());
  return out;
}

/// The first place on a fine lattice where the waves are above `level`; infinite if there is none.
double first_above(const Waves& waves, double level) {
  for (int i = 0; i <= 20'000; ++i) {
    const double s = -1 + i * 1e-4;
    if (waves.at(s) > level) return s;
  }
  return std::numeric_limits<double>::infinity();
}

struct Tally {
  int hits = 0, clear = 0, missed = 0, false_hits = 0, left = 0, stretches = 0;
};

Tally judge_march(Random& r, bool any) {
  std::vector<Waves> lanes;
  for (size_t i = 0; i < k_width; ++i) lanes.emplace_back(r);
  const V enough = set(any ? k_half : -std::numeric_limits<float>::infinity());
  const Answers answers = march_along(lanes, enough);
  Tally tally;
  for (size_t i = 0; i < k_width; ++i) {
    const bool is_hit = answers.hits >> i & 1;
    const double root = double(answers.root[i]), first = first_above(lanes[i], 1e-3);
    tally.left += answers.live >> i & 1;
    if (answers.live >> i & 1) continue;
    tally.hits += is_hit, tally.clear += !is_hit;
    tally.missed += first < (is_hit && !any ? root - double(k_tiny) : std::numeric_limits<double>::infinity()) && !(any && is_hit);
    tally.false_hits += is_hit && lanes[i].at(root) < -1e-3;
  }
  return tally;
}

/// As the solver of single rays does it: a look has the same waves in all lanes.
Tally judge_search(Random& r) {
  const Waves waves(r);
  Tally tally;
  const auto look = [&](V middle, V half) {
    tally.stretches += int(k_width);
    return look_at(std::vector<const Waves*>(k_width, &waves), middle, half);
  };
  float root = std::numeric_limits<float>::infinity();
  const bool is_hit = RootSearch(look, k_half, {k_tiny, 1e-4f * k_tiny, k_negligible}).run(root);
  tally.hits = is_hit, tally.clear = !is_hit;
  tally.missed = first_above(waves, 1e-4) < double(root) - 0.1 * double(k_tiny);
  tally.false_hits = is_hit && (waves.at(double(root)) < -1e-4 || (root > -k_half && waves.at(double(root)) > 1e-4));
  return tally;
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

namespace kelpie {
namespace {

TEST(TreeMarch, FindsTheFirstRoot) {
  Random r(1);
  for (const bool any : {false, true}) {
    int hits = 0, clear = 0, left = 0;
    for (int trial = 0; trial < 2000; ++trial) {
      const auto tally = HWY_STATIC_DISPATCH(judge_march)(r, any);
      ASSERT_EQ(tally.missed, 0) << trial;
      ASSERT_EQ(tally.false_hits, 0) << trial;
      hits += tally.hits, clear += tally.clear, left += tally.left;
    }
    EXPECT_GT(hits, 500);
    EXPECT_GT(clear, 500);
    EXPECT_LT(left, hits / 20) << "lanes that had no answer in time";
  }
}

TEST(RootSearch, FindsTheFirstRoot) {
  constexpr int k_trials = 2000;
  Random r(1);
  int hits = 0, clear = 0, stretches = 0;
  for (int trial = 0; trial < k_trials; ++trial) {
    const auto tally = HWY_STATIC_DISPATCH(judge_search)(r);
    ASSERT_EQ(tally.missed, 0) << trial;
    ASSERT_EQ(tally.false_hits, 0) << trial;
    hits += tally.hits, clear += tally.clear, stretches += tally.stretches;
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(clear, 500);
  EXPECT_LT(stretches, 200 * k_trials);
}

} // namespace
} // namespace kelpie
