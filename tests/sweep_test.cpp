// Every operator over every warp over every skeleton, with random parameters: no missed and no false hit.
//
// The seed of a tree is its trial's number. KELPIE_SWEEP_TRIALS is the number of trees (scripts/nightly_sweep
// runs many), KELPIE_SWEEP_FIRST the first trial, to repeat one.
#include <cstdlib>

#include "tests/support/every_kind.h"
#include "tests/support/examination.h"

namespace kelpie {
namespace {

/// Each operator over each warp, thrice.
constexpr int k_default_trials = 120, k_rays_a_tree = 24;

int number_from_environment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : otherwise;
}

TEST(Sweep, NoRayIsWrong) {
  const EveryKind kinds;
  const int first = number_from_environment("KELPIE_SWEEP_FIRST", 0),
            trials = number_from_environment("KELPIE_SWEEP_TRIALS", k_default_trials);
  Tallies all;
  for (int trial = first; trial < first + trials; ++trial) {
    SCOPED_TRACE(trial);
    Random r{unsigned(trial)};
    const SampledField field = kinds.random_field(unsigned(trial), r);
    const CellLimits limits = trial % 4 < 2 ? CellLimits{} : k_small_cells;
    const Tallies tallies = judge_both_ways({field, trial % 2 ? 1.f : 0.6f, k_rays_a_tree, limits, 1e4});
    expect_nothing_wrong(tallies);
    all += tallies;
  }
  RecordProperty("hits", all.rays.hits);
  RecordProperty("hits_from_surfaces", all.departures.hits);
  expect_right(all, 0.05);
}

} // namespace
} // namespace kelpie
