// No scene eats the machine: what is thin, far or mistyped ends in seconds and megabytes, or with one line that names it.
#include "tests/support/program.h"

namespace kelpie {
namespace {

class Limits : public ProgramTest {
protected:
  /// The line under a limit of address space, within a minute.
  Outcome limited(const std::string& line, const std::string& megabytes = "4000") const {
    const int status = shell("(ulimit -v " + megabytes + "000; timeout -k 1 60 $KELPIE " + line + ") >stdout.txt 2>stderr.txt");
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

} // namespace
} // namespace kelpie
