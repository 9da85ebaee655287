// The solvers are compiled for several SIMD instruction sets and chosen when the program runs. All of them find
// the same surfaces: none misses a hit or makes one up, and where two of them answer, they agree closely.
#include <hwy/highway.h>

#include "tests/support/every_kind.h"
#include "tests/support/examination.h"

namespace kelpie {
namespace {

/// Has all solvers use one of the instruction sets.
void use_target(int64_t target) {
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

struct Case {
  std::string name;
  SampledField field;
};

std::vector<Case> cases() {
  std::vector<Case> out;
  out.push_back({"coincident blobs", field_of(coincident_cloud(Falloff::quartic))});
  out.push_back({"thin blobs", field_of(thin_cloud(Falloff::quartic))});
  out.push_back({"carving blobs", field_of(negative_cloud(Falloff::wyvill))});
  for (unsigned trial = 0; trial < 12; ++trial) {
    Random r(trial);
    SampledField field;
    const unsigned root = random_tree(r, 2, field);
    if (trial % 3 == 0) {
      Twist<SampledMode> twist;
      twist.rate = 40, twist.child = root;
      add(field, twist);
    }
    out.push_back({"tree " + std::to_string(trial), field});
  }
  const EveryKind kinds;
  for (unsigned trial = 0; trial < 80; trial += 13) {
    Random r(trial);
    out.push_back({"kinds " + std::to_string(trial), kinds.random_field(trial, r)});
  }
  return out;
}

TEST(Simd, EveryInstructionSetFindsTheSameSurfaces) {
  const std::vector<int64_t> targets = hwy::SupportedAndGeneratedTargets();
  RecordProperty("targets", int(targets.size()));
  if (targets.size() < 2) GTEST_SKIP() << "this processor knows one instruction set only";
  size_t compared = 0, differing = 0;
  for (const Case& c : cases())
    for (const Way way : {Way::alone, Way::in_packets}) {
      SCOPED_TRACE(c.name + (way == Way::alone ? " alone" : " in packets"));
      std::vector<Question> best; // of the first target
      for (const int64_t target : targets) {
        SCOPED_TRACE(hwy::TargetName(target));
        use_target(target);
        Examination examination(c.field, 1, 300);
        expect_nothing_wrong(examination.judge(way));
        expect_nothing_wrong(examination.judge_departures(way));
        if (best.empty()) best = examination.questions();
        ASSERT_EQ(best.size(), examination.questions().size());
        for (size_t i = 0; i < best.size(); ++i) {
          const Question &a = best[i], &b = examination.questions()[i];
          ++compared;
          differing += a.found != b.found;
          if (a.found && b.found) differing += std::abs(a.hit.t - b.hit.t) > 1e-5f * (examination.size() + a.hit.t);
        }
      }
    }
  use_target(0); // what the processor can
  EXPECT_GT(compared, 10000u);
  EXPECT_EQ(differing, 0u) << "of " << compared;
}

} // namespace
} // namespace kelpie
