// Feature-based metamorphosis: what its frames, its weights and its ends are.
#include <cmath>
#include <numbers>

#include <glm/gtc/quaternion.hpp>

#include "morph/feature/rotation_mean.h"
#include "renderer/program/bound.h"
#include "scene/reader.h"
#include "tests/support/conformance.h"
#include "tests/support/program.h"

namespace kelpie {
namespace {

// --- rotations ---

Mat3d turned(double degrees, const Vec3d& axis) { return glm::mat3_cast(glm::angleAxis(glm::radians(degrees), glm::normalize(axis))); }

double angle_between(const Mat3d& a, const Mat3d& b) {
  const Mat3d r = glm::transpose(a) * b;
  return std::acos(std::clamp((r[0][0] + r[1][1] + r[2][2] - 1) / 2, -1.0, 1.0));
}

TEST(MeanRotation, OfTwoIsWhatSlerpYields) {
  Random r(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Mat3d a = turned(r.uniform(-180, 180), r.direction()), b = a * turned(r.uniform(1, 170), r.direction());
    const double t = r.uniform(0, 1);
    const RotationMean mean = mean_rotation(std::array{a, b}, std::array{1 - t, t});
    const Mat3d slerp = glm::mat3_cast(glm::slerp(glm::quat_cast(a), glm::quat_cast(b), t));
    EXPECT_LT(angle_between(mean.mean, slerp), 1e-6);
    EXPECT_NEAR(mean.farthest, std::max(t, 1 - t) * angle_between(a, b), 1e-6);
  }
}

// Where the sum of weighted squared angles is least: any other place has more.
TEST(MeanRotation, IsTheIntrinsicOne) {
  Random r(2);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Mat3d> all;
    std::vector<double> weights;
    double sum = 0;
    for (int i = 0; i < 7; ++i) all.push_back(turned(r.uniform(0, 70), r.direction())), sum += weights.emplace_back(r.uniform(0, 1));
    for (double& w : weights) w /= sum;
    const auto spread = [&](const Mat3d& at) {
      double total = 0;
      for (size_t i = 0; i < all.size(); ++i) total += weights[i] * std::pow(angle_between(at, all[i]), 2);
      return total;
    };
    const Mat3d mean = mean_rotation(all, weights).mean;
    for (int i = 0; i < 20; ++i) EXPECT_GT(spread(mean * turned(r.uniform(0.1, 20), r.direction())), spread(mean));
  }
}

// --- weights ---

TEST(FeatureWeights, SumToOneAndAreTheirRangesOverBoxes) {
  Random r(3);
  for (int trial = 0; trial < 3000; ++trial) {
    const double p = std::array{1.0, 2.0, 3.7}[size_t(trial % 3)];
    std::vector<Interval> d, g;
    for (int i = r.below(5); i >= 0; --i) {
      const double at = r.uniform(-1, trial % 2 ? 1 : 0), value = r.uniform(-1, 1);
      d.push_back({at, at + r.log_uniform(1e-3, 0.5)}), g.push_back({value, value + r.log_uniform(1e-3, 0.5)});
    }
    const Interval range = feature_weights::mean(std::span<const Interval>(d), std::span<const Interval>(g), p);
    for (int i = 0; i < 20; ++i) {
      std::vector<double> distances, values, weights;
      for (const Interval& x : d) distances.push_back(r.uniform(x.lo, x.hi));
      for (const Interval& x : g) values.push_back(r.uniform(x.lo, x.hi));
      feature_weights::normalised(distances, p, weights);
      double sum = 0, mean = 0;
      for (size_t k = 0; k < weights.size(); ++k) sum += weights[k], mean += weights[k] * values[k];
      EXPECT_NEAR(sum, 1, 1e-12);
      EXPECT_NEAR(feature_weights::mean(std::span<const double>(distances), std::span<const double>(values), p), mean, 1e-12);
      EXPECT_TRUE(holds(range, mean));
    }
  }
}

// Of one step along a line, by which no feature's distance changes more, weights change little, but where two borders cross.
TEST(FeatureWeights, AreContinuousAcrossBorders) {
  Random r(4);
  int crossed = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<double> before, after, distances{r.uniform(-1e-7, 0)};
    for (int i = 0; i < 3; ++i) distances.push_back(r.uniform(0.05, 1) * (trial % 2 || i > 0 ? -1 : 1));
    feature_weights::normalised(distances, 2, before);
    distances[0] += 1e-7; // in
    feature_weights::normalised(distances, 2, after);
    crossed += distances[0] > 0;
    for (size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(before[i], after[i], 1e-9);
  }
  EXPECT_GT(crossed, 1000);
}

// Equation 5 of the paper, outside all features: the product of the other distances.
TEST(FeatureWeights, OfSharpnessOneAreThoseOfThePaper) {
  const std::vector<double> d{-0.5, -1, -2};
  std::vector<double> weights;
  feature_weights::normalised(d, 1, weights);
  const double sum = d[1] * d[2] + d[0] * d[2] + d[0] * d[1];
  EXPECT_NEAR(weights[0], d[1] * d[2] / sum, 1e-12);
  EXPECT_NEAR(weights[2], d[0] * d[1] / sum, 1e-12);
}

// --- fields ---

class MetamorphosisTest : public ProgramTest {
protected:
  /// A scene with one shape.
  FieldProgram field_of(const std::string& field, const std::string& rest = "") {
    write("scene.json", R"({ "kelpie": 1, )" + rest + R"("shapes": [ { "name": "child", "field": )" + field + " } ] }");
    Diagnostics diagnostics;
    const Scene scene = read_scene(path("scene.json"), {}, diagnostics);
    const FrameScene moment = sample(scene, 1);
    program_ = compile(moment.shapes[0].field, moment.shapes[0].threshold);
    return program_;
  }
  FieldProgram metamorphosis(const std::string& body) { return field_of(R"({ "kind": "metamorphosis", )" + body + " }"); }

  /// The signed distance that the last field says, positive inside.
  double distance(const Vec3d& p) const {
    double reach = 1;
    for (const auto& node : program_.field.nodes)
      if (const auto* kind = std::get_if<Metamorphosis<SampledMode>>(&node)) reach = kind->reach;
    return reach * (evaluate(program_, program_.code, Point3<double>{p.x, p.y, p.z}) / program_.threshold - 1);
  }

  FieldProgram program_;
};

const std::string k_table = R"({ "kind": "union", "children": [
  { "kind": "sdf_box", "centre": [0, 1, 0], "size": [2, 0.2, 1] }, { "kind": "sdf_capsule", "from": [0, 0, 0], "to": [0, 1, 0], "capsule_radius": 0.1 } ] })";
const std::string k_stool = R"({ "kind": "union", "children": [
  { "kind": "sdf_cylinder", "from": [1, 0.6, 0], "to": [1, 0.7, 0], "cylinder_radius": 0.5 },
  { "kind": "sdf_capsule", "from": [1.2, 0, 0], "to": [1, 0.6, 0], "capsule_radius": 0.05 } ] })";
const std::string k_table_elements = R"("elements": [ { "name": "top", "centre": [0, 1, 0], "size": [2.2, 0.4, 1.2] },
  { "name": "leg", "centre": [0, 0.4, 0], "size": [0.4, 1, 0.4] } ])";
const std::string k_stool_elements = R"("elements": [ { "name": "top", "centre": [1, 0.65, 0], "size": [1.2, 0.3, 1.2] },
  { "name": "leg", "centre": [1.1, 0.3, 0], "size": [0.3, 0.7, 0.3], "axis": [-0.2, 0.6, 0] } ])";

std::string object(const std::string& field, double weight, const std::string& elements = "") {
  return "{ \"field\": " + field + ", \"weight\": " + std::to_string(weight) + (elements.empty() ? "" : ", " + elements) + " }";
}

// With one weight for all features each end is the object itself, to rounding.
TEST_F(MetamorphosisTest, IsOneObjectAtEachEnd) {
  Random r(5);
  for (const bool is_first : {true, false}) {
    const FieldProgram alone = field_of(is_first ? k_table : k_stool);
    metamorphosis("\"objects\": [" + object(k_table, is_first, k_table_elements) + ", " + object(k_stool, !is_first, k_stool_elements) +
                  "]");
    int inside = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3d p = r.in(Box3d{Vec3d(-1.5, -0.3, -1), Vec3d(2, 1.5, 1)});
      const bool is_in = evaluate(alone, alone.code, Point3<double>{p.x, p.y, p.z}) > alone.threshold;
      EXPECT_TRUE((distance(p) > 0) == is_in || std::abs(distance(p)) < 1e-6);
      inside += is_in;
    }
    EXPECT_GT(inside, 100);
  }
}

TEST_F(MetamorphosisTest, MixesDistancesWhereNothingElseIsSaid) {
  metamorphosis(R"("objects": [ { "field": { "kind": "sdf_sphere", "centre": [0, 0, 0], "sphere_radius": 1 }, "weight": 1 },
    { "field": { "kind": "sdf_sphere", "centre": [0, 0, 0], "sphere_radius": 2 }, "weight": 1 },
    { "field": { "kind": "sdf_sphere", "centre": [0, 0, 0], "sphere_radius": 5 }, "weight": 2 } ])");
  EXPECT_NEAR(distance({3, 0, 0}), (1 + 2 + 2 * 5) / 4.0 - 3, 1e-6);
  EXPECT_NEAR(distance({0, 20, 0}), (1 + 2 + 2 * 5) / 4.0 - 20, 1e-5); // a potential would be 0 there
}

// Deformation alone: the first object in the place, the size and the rotation of the second (Figure 5 of the paper).
TEST_F(MetamorphosisTest, DeformsWithoutMorphing) {
  metamorphosis(R"("objects": [
    { "field": { "kind": "sdf_box", "centre": [0, 0, 0], "size": [2, 1, 1] },
      "elements": [ { "name": "all", "centre": [0, 0, 0], "size": [2, 1, 1] } ] },
    { "field": { "kind": "sdf_sphere", "centre": [5, 0, 0], "sphere_radius": 1 },
      "elements": [ { "name": "all", "centre": [5, 0, 0], "size": [1, 4, 2], "axis": [1, 1, 0], "across": [1, -1, 0] } ] } ],
    "features": [ { "name": "all", "weights": [1, 0], "frame_weights": [0, 1] } ])");
  const Vec3d y = glm::normalize(Vec3d(1, 1, 0)), x = glm::normalize(Vec3d(1, -1, 0)), centre(5, 0, 0);
  for (const double part : {0.97, 1.03}) {
    const bool is_inside = part < 1;
    EXPECT_EQ(distance(centre + part * 2.0 * y) > 0, is_inside);
    EXPECT_EQ(distance(centre + part * 0.5 * x) > 0, is_inside);
    EXPECT_EQ(distance(centre + part * Vec3d(0, 0, 1)) > 0, is_inside);
  }
}

// Half of a mean frame: where the leg of the child stands, both legs are seen.
TEST_F(MetamorphosisTest, PlacesFeaturesBetweenThoseOfTheObjects) {
  metamorphosis("\"objects\": [" + object(k_table, 1, k_table_elements) + ", " + object(k_stool, 1, k_stool_elements) + "]");
  EXPECT_GT(distance({0.5, 0.825, 0}), 0);    // the tops' centres are at (0, 1, 0) and (1, 0.65, 0)
  EXPECT_GT(distance({0.55, 0.35, 0}), 0.02); // the legs' at (0, 0.4, 0) and (1.1, 0.3, 0)
  EXPECT_LT(distance({0, 0.35, 0}), 0);       // neither leg stands where it did
  EXPECT_LT(distance({1.1, 0.3, 0}), 0);
}

TEST_F(MetamorphosisTest, SeesAnObjectWithoutTheElementWhereItStands) {
  const auto bar = [](double x) {
    return R"({ "kind": "sdf_capsule", "from": [)" + std::to_string(x) + R"(, 0, 0], "to": [)" + std::to_string(x) +
           R"(, 1, 0], "capsule_radius": 0.2 })";
  };
  metamorphosis("\"objects\": [" + object(bar(0), 1, R"("elements": [ { "name": "bar", "centre": [0, 0.5, 0], "size": [1, 2, 1] } ])") +
                ", " + object(bar(3), 1) + R"(], "features": [ { "name": "bar" } ])");
  EXPECT_NEAR(distance({0, 0.5, 0}), 0.5 * 0.2 + 0.5 * (0.2 - 3), 1e-6);
}

TEST_F(MetamorphosisTest, OffsetsThicken) {
  const auto ball = [](const std::string& offset) {
    const std::string one = R"({ "field": { "kind": "sdf_sphere", "centre": [0, 0, 0], "sphere_radius": 1 },
      "elements": [ { "name": "all", "centre": [0, 0, 0], "size": 3 } ] })";
    return "\"objects\": [" + one + ", " + one + R"(], "features": [ { "name": "all", "offset": )" + offset + " } ]";
  };
  metamorphosis(ball("0.2"));
  EXPECT_LT(distance({1.21, 0, 0}), 0);
  EXPECT_GT(distance({1.19, 0, 0}), 0);
  metamorphosis(ball("-0.2"));
  EXPECT_LT(distance({0.81, 0, 0}), 0);
  EXPECT_GT(distance({0.79, 0, 0}), 0);
}

TEST_F(MetamorphosisTest, ABackgroundLeadsFarFromAllElements) {
  const auto ball = [](double x, const char* elements) {
    return R"({ "field": { "kind": "sdf_sphere", "centre": [)" + std::to_string(x) + R"(, 0, 0], "sphere_radius": 1 } )" + elements + "}";
  };
  const std::string body = "\"objects\": [" + ball(0, R"(, "elements": [ { "name": "a", "centre": [0, 0, 0], "size": 2 } ])") + ", " +
                           ball(10, R"(, "elements": [ { "name": "a", "centre": [10, 0, 0], "size": 2 } ])") + "]";
  metamorphosis(body + R"(, "features": [ { "name": "a" }, { "name": "background", "weights": [0, 1] } ], "margin": 1)");
  EXPECT_NEAR(distance({5, 0, 0}), 1, 1e-6);     // in the element: halfway between both
  EXPECT_NEAR(distance({14, 0, 0}), 1 - 4, 0.3); // far from it: the second where it stands
}

/// Two balls that do not touch, mixed by a function, on the way from the first to the second.
std::string balls_apart(const std::string& function, double t) {
  const auto ball = [](double x, double weight) {
    return R"({ "field": { "kind": "sdf_sphere", "centre": [)" + std::to_string(x) + R"(, 0, 0], "sphere_radius": 1 }, "weight": )" +
           std::to_string(weight) + " }";
  };
  return R"("function": ")" + function + R"(", "objects": [ )" + ball(-1.5, 1 - t) + ", " + ball(1.5, t) + " ]";
}

TEST_F(MetamorphosisTest, MatterFlowsBetweenWhatStandsApart) {
  const Box3d box{Vec3d(-3.5, -2, -2), Vec3d(3.5, 2, 2)};
  const auto volume = [&](const std::string& function, double t) {
    metamorphosis(balls_apart(function, t));
    Random r(11);
    int inside = 0;
    constexpr int k_places = 20000;
    for (int i = 0; i < k_places; ++i) inside += distance(r.in(box)) > 0;
    return inside * 7 * 4 * 4 / double(k_places);
  };
  const double ball = 4 * std::numbers::pi / 3;
  EXPECT_EQ(volume("linear", 0.5), 0);
  EXPECT_NEAR(volume("space_time", 0.5), ball, 0.1 * ball); // what the displacement is chosen for
  for (double t = 0; t <= 1; t += 0.125) {
    const double there = volume("space_time", t);
    EXPECT_GT(there, 0.6 * ball) << t;
    EXPECT_LT(there, 1.5 * ball) << t;
  }
}

// At either end of a blend, and of one among three, the object itself.
TEST_F(MetamorphosisTest, SpaceTimeBlendsEndExactly) {
  Random r(12);
  for (const double t : {0.0, 1.0}) {
    metamorphosis(balls_apart("space_time", t));
    for (int i = 0; i < 1000; ++i) {
      const Vec3d p = r.in(Box3d{Vec3d(-3), Vec3d(3)});
      EXPECT_NEAR(distance(p), 1 - glm::length(p - Vec3d(t > 0 ? 1.5 : -1.5, 0, 0)), 1e-5);
    }
  }
  const std::string three = "\"function\": \"space_time\", \"objects\": [" + object(k_table, 1, k_table_elements) + ", " +
                            object(k_stool, 0, k_stool_elements) + ", " + object(k_table, 0) + "]";
  const FieldProgram alone = field_of(k_table);
  metamorphosis(three);
  for (int i = 0; i < 5000; ++i) {
    const Vec3d p = r.in(Box3d{Vec3d(-1.5, -0.3, -1), Vec3d(2, 1.5, 1)});
    const bool is_in = evaluate(alone, alone.code, Point3<double>{p.x, p.y, p.z}) > alone.threshold;
    EXPECT_TRUE((distance(p) > 0) == is_in || std::abs(distance(p)) < 1e-6);
  }
}

// Small steps of the weights, also to where an object comes in or has gone, change the field little.
TEST_F(MetamorphosisTest, SpaceTimeBlendsOfThreeAreContinuous) {
  const auto mix = [&](const Vec3d& weights) {
    std::string objects;
    for (int j = 0; j < 3; ++j)
      objects += std::string(j ? ", " : "") + R"({ "field": { "kind": "sdf_sphere", "centre": [)" + std::to_string(j) +
                 R"(, 0, 0], "sphere_radius": 1 }, "weight": )" + std::to_string(weights[size_t(j)]) + " }";
    metamorphosis(R"("function": "space_time", "objects": [ )" + objects + " ]");
  };
  const Vec3d step(1e-4, 1e-4, -2e-4);
  for (const Vec3d& weights : {Vec3d(0.3, 0.3, 0.4), Vec3d(0.5, 0.5, 0), Vec3d(0, 0, 1), Vec3d(0, 0.5, 0.5)}) {
    const Vec3d other = glm::max(Vec3d(0), weights + (weights.z > 0 ? step : -step));
    for (double x = -1.5; x < 4; x += 0.1) {
      mix(weights);
      const double before = distance({x, 0.5, 0.2});
      mix(other);
      EXPECT_NEAR(distance({x, 0.5, 0.2}), before, 0.02) << x;
    }
  }
}

// A part that is used in several sizes is a distance in each.
TEST_F(MetamorphosisTest, InstancesOfOnePartAreDistancesInAllSizes) {
  const std::string bar = R"("parts": { "bar": { "kind": "sdf_capsule", "from": [0, 0, 0], "to": [0, 1, 0], "capsule_radius": 0.1 } }, )";
  const std::string both = R"({ "kind": "union", "children": [ { "kind": "instance", "of": "bar" },
    { "kind": "instance", "of": "bar", "position": [4, 0, 0], "scale": 2 } ] })";
  field_of(R"({ "kind": "metamorphosis", "objects": [ { "field": )" + both + R"( }, { "field": )" + both + " } ] }", bar);
  EXPECT_NEAR(distance({-1, 0.5, 0}), 0.1 - 1, 1e-6);
  EXPECT_NEAR(distance({5, 0.5, 0}), 2 * (0.1 - 0.5), 1e-6);
}

// --- distances of meshes, however far ---

TEST(FarDistances, GoOnBeyondTheBand) {
  const double voxel = 1.0 / 32;
  const auto ball = [](const Vec3d& p, double) { return glm::length(p) - 0.8; };
  const DistanceGrid grid(Box3d{Vec3d(-1), Vec3d(1)}, voxel, 4 * voxel, ball);
  const auto far = grid.far();
  Random r(6);
  for (int i = 0; i < 5000; ++i) {
    const Vec3d p = r.in(Box3d{Vec3d(-4), Vec3d(4)});
    const Point3<double> at{p.x, p.y, p.z};
    const double d = far->extend(distance_in(grid, at), at);
    if (ball(p, 0) < 1) {
      EXPECT_NEAR(d, ball(p, 0), 4 * voxel);
    } else {
      EXPECT_GT(d, 0.9); // it goes on, if not exactly
    }
    EXPECT_EQ(d > 0, ball(p, 0) > 0) << "within a voxel of the surface there is none of these places";
    EXPECT_TRUE(std::abs(ball(p, 0)) > 2 * voxel || d == distance_in(grid, at));
    const Box3d box = random_box(r, Box3d{p, p});
    const Interval range = far->extend(distance_in(grid, box_point(box)), box_point(box));
    for (int k = 0; k < 5; ++k) {
      const Point3<double> q = point<double>(r.in(box));
      EXPECT_TRUE(holds(range, far->extend(distance_in(grid, q), q), 1e-6));
    }
  }
}

// --- what may be wrong ---

class WrongMetamorphosis : public ProgramTest {
protected:
  void expect(const std::string& body, const std::string& message) {
    write("scene.json",
          "{ \"kelpie\": 1, \"shapes\": [ { \"name\": \"a\", \"field\": { \"kind\": \"metamorphosis\",\n" + body + " } } ] }");
    const Outcome o = kelpie("check scene.json");
    EXPECT_EQ(o.status, 65) << o.err;
    EXPECT_EQ(o.err, "error: scene.json:" + message + "\n");
  }
  static std::string ball(const std::string& elements) {
    return "{ \"field\": { \"kind\": \"sdf_sphere\", \"centre\": [0, 0, 0], \"sphere_radius\": 1 }, \"elements\": [" + elements + "] }";
  }
  static std::string element(const std::string& name, const std::string& rest = "") {
    return "{ \"name\": \"" + name + "\", \"centre\": [0, 0, 0], \"size\": 1" + rest + " }";
  }
};

TEST_F(WrongMetamorphosis, IsSaidInOneLine) {
  expect("\"objects\": [" + ball(element("seat")) + ", " + ball(element("saet")) + "]",
         R"(2:12: objects: no other object has an element "seat" (did you mean "saet"?); list it in `features` if only one is to have it)");
  expect("\"objects\": [" + ball(element("seat") + ", " + element("seat")) + ", " + ball("") + "]",
         R"(2:12: objects: object 1 has two elements called "seat")");
  const std::string two = "\"objects\": [" + ball(element("seat")) + ", " + ball(element("seat")) + "],\n\"features\": ";
  expect(two + R"([{ "name": "seat", "weights": [0, 0] }])", R"(3:13: features: all weights of "seat" are 0)");
  expect(two + R"([{ "name": "seat", "weights": [1, 2, 3] }])", R"(3:13: features: "seat" has 3 weights, and there are 2 objects)");
  expect(two + R"([{ "name": "leg" }])", R"(3:13: features: no object has an element "leg"; known: seat)");
  expect("\"objects\": [" + ball(element("seat")) + ", " +
             ball(element("seat", ", \"axis\": [0.87, -0.5, 0], \"across\": [0.5, 0.87, 0]")) + ", " +
             ball(element("seat", ", \"axis\": [-0.87, -0.5, 0], \"across\": [-0.5, 0.87, 0]")) + "]",
         "2:12: objects: the elements \"seat\" of objects 1, 2, 3 are turned too far apart for a mean: give them other axes, or "
         "\"rotation\": \"nearest\"");
  expect(R"("objects": [{ "field": { "kind": "point", "centre": [0, 0, 0], "radius": 1 } }, )" + ball("") + "]",
         "2:24: a metamorphosis mixes signed distances (sdf_ kinds, Booleans and warps of them); this point is no signed distance");
  expect("\"objects\": [" + ball("") + "]", "2:12: objects: expected at least 2 values, found one value");
}

} // namespace
} // namespace kelpie
