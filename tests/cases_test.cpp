// Inputs that once went wrong, as they were reported (tests/cases); those of meshes and maps are tested with their readers, those that took
// too much in limits_test.
#include "tests/support/program.h"

namespace kelpie {
namespace {

class Cases : public ProgramTest {
protected:
  static std::string path_of(const std::string& name) { return KELPIE_SOURCE "/tests/cases/" + name; }
  Outcome render(const std::string& name, const std::string& more = "") const {
    return kelpie("render " + path_of(name) + " -f 1 --res 32x24 --spp 1 --progress none --stats stats.json -o a.exr " + more);
  }
};

TEST_F(Cases, AListOfShapesThatStandsTwiceIsADuplicateKey) {
  for (const Outcome& o : {render("dup_shapes_geometry.json"), kelpie("check " + path_of("dup_shapes_geometry.json"))}) {
    EXPECT_EQ(o.status, 65);
    EXPECT_NE(o.err.find(":1:82: duplicate key \"shapes\""), std::string::npos) << o.err;
  }
}

TEST_F(Cases, AFrameWithNothingInItSaysSo) {
  const Outcome o = render("render_000257_dolphin.json");
  EXPECT_EQ(o.status, 0);
  EXPECT_NE(o.err.find("warning: frame 1 shows nothing: "), std::string::npos) << o.err;
}

// One signed distance once sent the whole tree to the solver of any code.
TEST_F(Cases, ASweptTubeIsCutOutOfASignedDistanceAsATree) {
  EXPECT_EQ(render("pov287.json").err, "");
  const std::string stats = text_of(folder_ / "stats.json");
  EXPECT_NE(stats.find("\"code\": {\"cells\": 0, "), std::string::npos) << stats;
}

// Float places at five million are 0.5 apart.
TEST_F(Cases, AMeshFarFromTheOriginIsWarnedOf) {
  const Outcome o = kelpie("fit " + path_of("utm.obj") + " --blobs 12 --no-cache --progress none -o utm.ply");
  EXPECT_EQ(o.status, 0);
  EXPECT_NE(o.err.find("utm.obj: it lies so far from the origin that the places of blobs are rounded to "), std::string::npos) << o.err;
}

// What says "quartic" is that, kinks and all; what says nothing has none.
TEST_F(Cases, TheDefaultFalloffHasNoKinks) {
  EXPECT_EQ(render("fo_quartic.json").err, "");
  const std::string page = kelpie("kinds point").out;
  EXPECT_NE(page.find("default \"cubic\""), std::string::npos) << page;
}

} // namespace
} // namespace kelpie
