// What a morph of trees looks like half way: limbs keep their bends, solids their volume, parts their colours.
#include <cmath>

#include <fmt/format.h>

#include "renderer/program/evaluate.h"
#include "tests/support/random_kind.h"
#include "tests/support/scene_folder.h"

namespace kelpie {
namespace {

std::string scene_of_shapes(const std::string& field) {
  return fmt::format(R"({{"kelpie":1,"frames":{{"first":1,"last":9}},"shapes":[{{"name":"a","field":{}}}]}})", field);
}
std::string morph_of(const std::string& from, const std::string& to, double progress) {
  return scene_of_shapes(fmt::format(R"({{"kind":"animorphosis","from":{},"to":{},"progress":{}}})", from, to, progress));
}

/// The field of a scene.
class Field {
public:
  Field(const SceneFolder& folder, const std::string& text) : frame_(sample(folder.read(text), 1)) {
    program_ = compile(frame_.shapes[0].field, frame_.shapes[0].threshold);
  }
  double operator()(const Vec3d& p) const { return evaluate(program_, program_.code, Point3<double>{p.x, p.y, p.z}); }
  const FrameScene& frame() const { return frame_; }

private:
  FrameScene frame_;
  FieldProgram program_;
};

double largest_difference(const Field& a, const Field& b) {
  Random r(7);
  double most = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d p = r.in(Box3d{Vec3d(-2), Vec3d(2)});
    most = std::max(most, std::abs(a(p) - b(p)));
  }
  return most;
}

double volume(const Field& field) {
  constexpr int k_cells = 48;
  constexpr double k_size = 6.0 / k_cells;
  int inside = 0;
  for (int i = 0; i < k_cells * k_cells * k_cells; ++i) {
    const Vec3d cell(i % k_cells, i / k_cells % k_cells, i / (k_cells * k_cells));
    inside += field((cell + 0.5) * k_size - 3.0) >= 1;
  }
  return inside * k_size * k_size * k_size;
}

/// The steepest slope of a cubic falloff of radius 0.3 and weight 2, about 1.72 * 2 / 0.3, times twice the detail of 0.0005.
constexpr double k_within_detail = 0.0115;

/// Limbs of other curves and numbers of points are themselves at the ends, within their detail, and go from one bend to the other.
TEST(LimbsBetween, KeepTheirBends) {
  const SceneFolder folder;
  const auto limb = [](std::string_view points, std::string_view radii, std::string_view curve) {
    return fmt::format(R"({{"kind":"generalized_cylinder","points":{},"radii":{},"curve":"{}","radius":0.3,"detail":0.0005}})", points,
                       radii, curve);
  };
  const std::string bent = limb("[[-1,0,0],[0,1,0],[1,0,0]]", "[0.1,0.3,0.1]", "catmull_rom");
  const std::string wavy = limb("[[-1,0,0.2],[-0.6,0.8,0],[-0.2,-0.3,0],[0.3,0.9,0],[0.7,-0.2,0.3],[1.2,0,0]]", "0.15", "b_spline");
  const std::string straight = limb("[[-1,0,0],[1,0,0]]", "[0.2,0.1]", "catmull_rom");
  const std::string pieces = limb("[[-1,0,0],[-0.5,0.6,0],[0,1,0],[0.5,0.6,0]]", "0.12", "bezier");
  for (const auto& [from, to] : {std::pair(bent, wavy), std::pair(straight, bent), std::pair(pieces, wavy), std::pair(wavy, straight)}) {
    EXPECT_LT(largest_difference(Field(folder, morph_of(from, to, 0)), Field(folder, scene_of_shapes(from))), k_within_detail);
    EXPECT_LT(largest_difference(Field(folder, morph_of(from, to, 1)), Field(folder, scene_of_shapes(to))), k_within_detail);
  }
  // The same limb with more points is the same at any time: nothing is drawn straight on the way.
  const std::string more = limb("[[-1,0,0],[-0.6666667,0.3333333,0],[-0.3333333,1,0],[0,1,0],[0.3333333,1,0],"
                                "[0.6666667,0.3333333,0],[1,0,0]]",
                                "[0.1,0.1666667,0.3,0.3,0.3,0.1666667,0.1]", "cubic_beziers");
  const Field same(folder, scene_of_shapes(bent));
  EXPECT_GT(same(Vec3d(0, 1, 0)), 1.9);
  const double apart = largest_difference(Field(folder, scene_of_shapes(more)), same);
  EXPECT_LT(apart, k_within_detail);
  EXPECT_LT(largest_difference(Field(folder, morph_of(bent, more, 0.5)), same), k_within_detail);
}

/// Skeletons with only a thinner one in common.
TEST(SolidsBetween, KeepTheirVolume) {
  const SceneFolder folder;
  const std::string potential = R"(,"radius":0.5,"weight":2)";
  const auto leaf = [&](std::string_view solid) { return fmt::format("{{{}{}}}", solid, potential); };
  const std::string box = leaf(R"("kind":"box","centre":[0,0,0],"size":[3,0.4,1.4])"),
                    torus = leaf(R"("kind":"torus","centre":[0,0,0],"major_radius":1.3,"minor_radius":0.2)"),
                    cone = leaf(R"("kind":"cone","from":[0,-1,0],"to":[0,1.5,0],"from_radius":1,"to_radius":0.2)"),
                    hull = leaf(R"("kind":"polyhedron","points":[[-1,-1,-1],[1,-1,0],[0,-1,1.5],[0,1.5,0],[1,1,1]])");
  for (const auto& [from, to] : {std::pair(box, torus), std::pair(torus, cone), std::pair(cone, hull), std::pair(torus, hull)}) {
    const double start = volume(Field(folder, scene_of_shapes(from))), end = volume(Field(folder, scene_of_shapes(to)));
    for (const double s : {0.25, 0.4, 0.5, 0.6, 0.75}) {
      const double expected = (1 - s) * start + s * end;
      EXPECT_NEAR(volume(Field(folder, morph_of(from, to, s))), expected, 0.1 * expected) << from << to << s;
    }
  }
}

/// Of two children that are as near, the one of a like colour.
TEST(PartsBetween, AreMatchedByColourToo) {
  const SceneFolder folder;
  const auto ball = [](double x, std::string_view colour) {
    return fmt::format(R"({{"kind":"point","centre":[{},0,0],"radius":1,"material":{{"kind":"matte","colour":{}}}}})", x, colour);
  };
  const auto pair = [](const std::string& a, const std::string& b) {
    return fmt::format(R"({{"kind":"blend","children":[{},{}]}})", a, b);
  };
  const std::string red = "[0.8,0.02,0.02]", ivory = "[0.8,0.75,0.6]";
  const Field field(folder, morph_of(pair(ball(-0.2, red), ball(0.2, ivory)), pair(ball(-0.2, ivory), ball(0.2, red)), 0.5));
  int leaves = 0;
  for (const MaterialIndex material : field.frame().shapes[0].field.materials) {
    if (!material.is_set()) continue;
    const Vec3 colour = std::get<Matte<SampledMode>>(field.frame().materials[material.index]).colour.rgb;
    EXPECT_LT(std::min(glm::distance(colour, Vec3(0.8f, 0.02f, 0.02f)), glm::distance(colour, Vec3(0.8f, 0.75f, 0.6f))), 0.01f);
    ++leaves;
  }
  EXPECT_EQ(leaves, 2);
}

} // namespace
} // namespace kelpie
