// Every operator over every warp over every skeleton, with random parameters: no missed and no false hit.
//
// The seed of a tree is its trial's number. KELPIE_SWEEP_TRIALS is the number of trees (scripts/nightly_sweep
// runs many), KELPIE_SWEEP_FIRST the first trial, to repeat one.
#include <cstdlib>

#include "tests/support/every_kind.h"
#include "tests/support/judge_rays.h"

namespace kelpie {
namespace {

/// Each operator over each warp, thrice.
constexpr int k_default_trials = 200, k_rays_a_tree = 40;

int number_from_environment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : otherwise;
}

TEST(Sweep, NoRayIsWrong) {
  const EveryKind kinds;
  const int first = number_from_environment("KELPIE_SWEEP_FIRST", 0),
            trials = number_from_environment("KELPIE_SWEEP_TRIALS", k_default_trials);
  Tally total;
  for (int trial = first; trial < first + trials; ++trial) {
    SCOPED_TRACE(trial);
    Random r{unsigned(trial)};
    const SampledField field = kinds.random_field(unsigned(trial), r);
    const Tally tally = judge_rays(field, trial % 2 ? 1.f : 0.6f, k_rays_a_tree, trial % 4 < 2 ? CellLimits{} : k_small_cells, 1e4);
    EXPECT_EQ(tally.missed, 0);
    EXPECT_EQ(tally.false_hits, 0);
    EXPECT_EQ(tally.disagreeing_shadows, 0);
    EXPECT_EQ(tally.wrong_normals, 0);
    total.hits += tally.hits;
  }
  RecordProperty("hits", total.hits);
  EXPECT_GT(total.hits, trials * k_rays_a_tree / 20);
}

} // namespace
} // namespace kelpie
