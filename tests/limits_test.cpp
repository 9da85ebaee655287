// No scene eats the machine: what is thin, far or mistyped ends in seconds and megabytes, or with one line that names it.
#include "tests/support/program.h"

namespace kelpie {
namespace {

class Limits : public ProgramTest {
protected:
  void SetUp() override {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the address sanitizer needs more address space than any limit leaves";
#endif
  }
  /// The line under a limit of address space, within a minute of CPU time.
  Outcome limited(const std::string& line, const std::string& megabytes = "4000") const {
    const int status = shell("(ulimit -v " + megabytes + "000; ulimit -t 60; $KELPIE " + line + ") >stdout.txt 2>stderr.txt");
    return {status, text_of(folder_ / "stdout.txt"), text_of(folder_ / "stderr.txt")};
  }
  static std::string scene(const std::string& name) { return KELPIE_SOURCE "/tests/cases/" + name + ".json"; }
  /// The number before a word of what was said.
  static double number_before(const std::string& word, const std::string& text) {
    const size_t end = text.find(' ' + word), begin = end == std::string::npos ? end : text.rfind(' ', end - 1);
    return begin == std::string::npos ? -1 : std::stod(text.substr(begin + 1));
  }
};

// Affine maps below a warp turn nothing, so what they squash needs no smaller cells for it.
TEST_F(Limits, WhatIsSquashedBelowAWarpNeedsNoMoreCells) {
  for (const std::string by : {"0.3", "0.05", "0.01"}) {
    const Outcome o = limited("check " + scene("twist_disc") + " --set shapes.s.field.child.by=[" + by + ",1,1]", "1500");
    ASSERT_EQ(o.status, 0) << by << o.err;
    const double cells = number_before("cells", o.out);
    EXPECT_GT(cells, 100) << o.out;
    EXPECT_LT(cells, 10000) << o.out;
  }
}

// Cells of what is long and thin need not be smaller than what a picture shows.
TEST_F(Limits, WhatIsThinIsDividedByPixels) {
  for (const std::string name : {"segment_1e8", "mut_000039"}) {
    const Outcome check = limited("check " + scene(name) + " -f 1");
    EXPECT_EQ(check.status, 0) << name << check.err;
    EXPECT_NE(check.out.find("costliest \""), std::string::npos) << check.out;
    const Outcome render = limited("render " + scene(name) + " -f 1 --res 64x36 --spp 1 -o a.exr --progress none");
    EXPECT_EQ(render.status, 0) << name << render.err;
  }
}

// Whatever is asked for, `check` answers, and says which shape cost most until then.
TEST_F(Limits, CheckEndsAndNamesTheCostliestShape) {
  const Outcome o = limited("check " + scene("mut_000228"));
  EXPECT_EQ(o.status, 0) << o.err;
  EXPECT_NE(o.out.find("costliest \""), std::string::npos) << o.out;
}

// Without a cap nothing is made coarser: it fits, or it is refused with the shape that takes most.
TEST_F(Limits, WhatDoesNotFitIsRefusedByName) {
  write("many.json", R"({ "kelpie": 1, "shapes": [ { "name": "small", "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1,
    "weight": 2 } }, { "name": "sponge", "field": { "kind": "twist", "rate": 4000, "child": { "kind": "disc", "normal": [1, 0, 0],
    "centre": [0, 0, 0], "disc_radius": 40, "radius": 0.02, "weight": 2 } } } ] })");
  const Outcome o = limited("render many.json -f 1 --res 64x36 --spp 1 -o a.exr --progress none -j 2", "900");
  EXPECT_EQ(o.status, 33);
  EXPECT_EQ(o.err.find("error: frame 1: building takes more than "), 0u) << o.err;
  EXPECT_NE(o.err.find("most of it for shape \"sponge\""), std::string::npos) << o.err;
  EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1);
  const Outcome huge = limited("render " + scene("twist_disc") + " --res 65536x65536 -o a.exr --progress none");
  EXPECT_EQ(huge.status, 33);
  EXPECT_NE(huge.err.find("a picture of 65536x65536 pixels"), std::string::npos) << huge.err;
}

} // namespace
} // namespace kelpie
