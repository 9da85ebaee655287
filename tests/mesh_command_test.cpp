// `kelpie mesh` as a user runs it.
#include "field/mesh/mesh.h"
#include "tests/support/program.h"

namespace kelpie {
namespace {

constexpr const char* k_scene = R"({ "kelpie": 1, "units": 0.1, "frames": { "first": 1, "last": 9 },
  "shapes": [
    { "name": "drop", "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 3, "falloff": "quartic" } },
    { "name": "stone", "field": { "kind": "sdf_box", "centre": [0, -1, 0], "size": [1, 1, 1] } },
    { "name": "mist", "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1, "weight": 0.5 } },
    { "name": "floor", "geometry": { "kind": "plane", "position": [0, -2, 0] } }] })";

class MeshCommand : public ProgramTest {
protected:
  MeshCommand() { write("scene.json", k_scene); }
  std::string refusal(const std::string& arguments, int status) const {
    const Outcome o = kelpie("mesh " + arguments);
    EXPECT_EQ(o.status, status) << o.err;
    EXPECT_EQ(file_count(), 1u) << "nothing is written";
    return o.err;
  }
};

TEST_F(MeshCommand, WritesAllFields) {
  for (const std::string name : {"a.ply", "a.stl", "a.obj"}) {
    const Outcome o = kelpie("mesh scene.json --tolerance 2 --progress none -o " + name);
    ASSERT_EQ(o.status, 0) << o.err;
    EXPECT_EQ(o.err, "left out, as ordinary geometry: floor\nwarning: scene.json: mist has no surface in frame 1\n");
    EXPECT_NE(o.out.find("stone: "), std::string::npos) << o.out;
    Diagnostics diagnostics;
    const Mesh mesh = load_mesh(path(name), diagnostics);
    EXPECT_TRUE(is_closed(mesh)) << name;
    const Vec3d size = bounding_box(mesh).extent();
    EXPECT_NEAR(size.x, name == "a.stl" ? size.y : size.z, 2) << name;
    EXPECT_NEAR(name == "a.stl" ? size.z : size.y, 215, 2) << name << ": the box's lower face is at -1.5, the drop's upper end at 0.65";
  }
}

TEST_F(MeshCommand, DoesNotDependOnThreads) {
  for (const std::string threads : {"1", "3"})
    ASSERT_EQ(kelpie("mesh scene.json --tolerance 2 -o t" + threads + ".ply -j " + threads).status, 0);
  EXPECT_EQ(text_of(path("t1.ply")), text_of(path("t3.ply")));
}

TEST_F(MeshCommand, PrintRefusesWhatCannotBePrinted) {
  const std::string print = "scene.json --print --progress none -o a.stl ";
  EXPECT_EQ(refusal(print + "--shape drop --shape stone --size 100mm --tolerance 2", 65)
                .find("error: scene.json: not printable: drop and stone meet at ("),
            0u);
  EXPECT_NE(refusal(print + "--shape stone --size 300mm --tolerance 5", 65)
                .find("300 x 300 mm and 300 mm high is larger than 250 x 210 x 210: --size"),
            std::string::npos);
  EXPECT_NE(refusal(print + "--shape stone --size 0.5mm --tolerance 0.01", 65).find("stone is 0.5 mm thin at (0."), std::string::npos);
  EXPECT_EQ(refusal(print + "--bed 10x10", 2),
            "error: --bed: expected three lengths in mm, the last one up, as 250x210x210, found \"10x10\"\n");
  write("scene.json", R"({"kelpie":1,"shapes":[{"name":"balls","field":{"kind":"union","children":[
      {"kind":"sdf_sphere","centre":[0,0,0],"sphere_radius":1},{"kind":"sdf_sphere","centre":[0,3,0],"sphere_radius":0.5}]}}]})");
  EXPECT_NE(refusal(print + "--size 90mm --tolerance 1", 65).find("balls is in 2 pieces, the smallest of "), std::string::npos);
  const Outcome o = kelpie("mesh " + print + "--size 90mm --tolerance 1 --pieces 2");
  EXPECT_EQ(o.status, 0) << o.err;
}

TEST_F(MeshCommand, ShellsAreHollowAndDrained) {
  ASSERT_EQ(kelpie("mesh scene.json --shape stone --tolerance 2 --shell 5 -o a.ply --json a.json --progress none").status, 0);
  Diagnostics diagnostics;
  const double outer = 100 * 100 * 100, inner = 90 * 90 * 90;
  EXPECT_NEAR(signed_volume(load_mesh(path("a.ply"), diagnostics)), outer - inner, 0.02 * outer);
  EXPECT_NE(text_of(path("a.json")).find("\"cavities\": []"), std::string::npos) << "the hole makes one surface of both";
  ASSERT_EQ(kelpie("mesh scene.json --shape stone --tolerance 2 --shell 5 --drain 0 -o b.ply --json b.json").status, 0);
  EXPECT_EQ(text_of(path("b.json")).find("\"cavities\": []"), std::string::npos);
  const Outcome thin = kelpie("mesh scene.json --shape stone --tolerance 2 --shell 60 -o c.ply --progress none");
  EXPECT_EQ(thin.err, "stone stays solid: it is nowhere thicker than two walls\n");
}

TEST_F(MeshCommand, SaysWhatIsWrong) {
  const std::string left_out = "left out, as ordinary geometry: floor\n";
  EXPECT_EQ(refusal("scene.json -o a.abc", 2), "error: \"a.abc\" must end in .ply, .stl, .obj, .3mf or .glb: that says the format\n");
  EXPECT_EQ(refusal("scene.json -o a.stl --shape drip", 2), "error: no shape with a field is called \"drip\" (did you mean \"drop\"?)\n");
  EXPECT_EQ(refusal("scene.json -o a.stl --shape mist --tolerance 2", 65),
            "error: scene.json: nothing to mesh in frame 1: mist has no surface\n");
  EXPECT_EQ(refusal("scene.json -o a.stl -f 10", 2), "error: -f: frame 10 is not one of the scene's, which are 1 to 9\n");
  EXPECT_EQ(refusal("scene.json -o a.stl --size 20km", 2), "error: --size: expected a length as 200mm, 20cm or 0.2m, found \"20km\"\n");
  EXPECT_EQ(refusal("scene.json -o a.stl --tolerance 1e-5", 65).find("error: a tolerance of 1e-05 mm is too fine"), left_out.size());
  write("scene.json", R"({"kelpie":1,"shapes":[{"name":"half","field":{"kind":"sdf_plane","point":[0,0,0]}}]})");
  EXPECT_EQ(refusal("scene.json -o a.stl", 65),
            "error: scene.json:1:46: shape \"half\" has no end: intersect the sdf_plane with something that has one\n");
}

} // namespace
} // namespace kelpie
