// Features that are proposed: parts of solids, and which of them are the same.
#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "morph/feature/match_parts.h"
#include "scene/reader.h"
#include "tests/support/program.h"
#include "tests/support/random_kind.h"

namespace kelpie {
namespace {

TEST(LeastAssignment, IsTheBestOfAll) {
  Random r(1);
  for (int trial = 0; trial < 300; ++trial) {
    const int rows = 1 + r.below(5), columns = rows + r.below(3);
    std::vector<std::vector<double>> cost(static_cast<size_t>(rows));
    for (auto& row : cost)
      for (int j = 0; j < columns; ++j) row.push_back(r.uniform(-1, 1));
    const auto sum = [&](const std::vector<int>& of) {
      double total = 0;
      for (int i = 0; i < rows; ++i) total += cost[size_t(i)][size_t(of[size_t(i)])];
      return total;
    };
    std::vector<int> order(static_cast<size_t>(columns));
    std::iota(order.begin(), order.end(), 0);
    double least = 1e9;
    do least = std::min(least, sum(order));
    while (std::next_permutation(order.begin(), order.end()));
    std::vector<int> found = least_assignment(cost);
    EXPECT_NEAR(sum(found), least, 1e-12);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
  }
}

/// Boxes as one OFF mesh, its faces outward.
std::string boxes_off(const std::vector<Box3d>& boxes) {
  std::string vertices, faces;
  for (size_t b = 0; b < boxes.size(); ++b) {
    for (int i = 0; i < 8; ++i) {
      const auto coordinate = [&](int axis) { return i >> axis & 1 ? boxes[b].upper[axis] : boxes[b].lower[axis]; };
      vertices += fmt::format("{} {} {}\n", coordinate(0), coordinate(1), coordinate(2));
    }
    constexpr int k_faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    const int first = 8 * int(b);
    for (const auto& f : k_faces) faces += fmt::format("4 {} {} {} {}\n", first + f[0], first + f[1], first + f[2], first + f[3]);
  }
  return fmt::format("OFF\n{} {} 0\n{}{}", 8 * boxes.size(), 6 * boxes.size(), vertices, faces);
}

/// A stool of a height, with a seat and four legs so far out.
std::vector<Box3d> stool(double height, double out, double leg) {
  std::vector<Box3d> boxes{{{-0.5, height - 0.1, -0.4}, {0.5, height, 0.4}}};
  for (const double x : {-out, out})
    for (const double z : {-0.3, 0.3}) boxes.push_back({{x - leg, 0, z - leg}, {x + leg, height - 0.08, z + leg}});
  return boxes;
}

double overlap(const Box3d& a, const Box3d& b) {
  const auto volume = [](const Box3d& box) {
    const Vec3d e = box.is_empty() ? Vec3d(0) : box.extent();
    return e.x * e.y * e.z;
  };
  const double both = volume(intersect(a, b));
  return both / (volume(a) + volume(b) - both);
}

class Features : public ProgramTest {};

TEST_F(Features, OfTwoStoolsAreLegsAndSeats) {
  write("low.off", boxes_off(stool(0.8, 0.4, 0.05))), write("high.off", boxes_off(stool(1.6, 0.3, 0.07)));
  ASSERT_EQ(shell("$KELPIE features low.off high.off -o breed.json --draw drawn.json --no-cache --progress none 2>names.txt"), 0);
  Diagnostics diagnostics;
  const Scene scene = read_scene(path("breed.json"), {}, diagnostics);
  const auto& kind = std::get<Metamorphosis<AnimatedMode>>(scene.shapes[0].field->kind);
  ASSERT_EQ(kind.objects.size(), 2u);
  for (size_t j = 0; j < 2; ++j) {
    const double height = j == 0 ? 0.8 : 1.6;
    const std::vector<Box3d> truth = j == 0 ? stool(0.8, 0.4, 0.05) : stool(1.6, 0.3, 0.07);
    ASSERT_EQ(kind.objects[j].elements.size(), truth.size());
    for (const Box3d& t : truth) { // each is found once
      int found = 0;
      for (const auto& e : kind.objects[j].elements) {
        const Vec3d centre(e.centre.at(0)), half(0.5 * Vec3d(e.size.at(0)));
        found += overlap({height * (centre - half), height * (centre + half)}, t) > 0.5;
      }
      EXPECT_EQ(found, 1);
    }
    for (const auto& e : kind.objects[j].elements) {
      EXPECT_EQ(e.name.ends_with("_left"), e.centre.at(0).x < -0.1) << e.name;
      EXPECT_EQ(e.name.ends_with("_right"), e.centre.at(0).x > 0.1) << e.name;
    }
  }
  EXPECT_EQ(read_scene(path("drawn.json"), {}, diagnostics).shapes.size(), 2 + 10 + 1u);
}

TEST_F(Features, NeedSeveralMeshes) {
  write("low.off", boxes_off(stool(0.8, 0.4, 0.05)));
  const Outcome o = kelpie("features low.off -o breed.json");
  EXPECT_EQ(o.status, 2);
  EXPECT_EQ(o.err, "error: features are proposed for two meshes or more\n");
  write("flat.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const Outcome flat = kelpie("features low.off flat.off -o breed.json --no-cache --progress none");
  EXPECT_EQ(flat.status, 65);
  EXPECT_NE(flat.err.find("error: flat.off: nothing is inside it"), std::string::npos) << flat.err;
  EXPECT_FALSE(std::filesystem::exists(path("breed.json")));
}

} // namespace
} // namespace kelpie
