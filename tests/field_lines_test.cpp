// The lines that the solver for packets draws above and below fields along a stretch: no place is past them.
#define HWY_COMPILE_ONLY_STATIC
#include <gtest/gtest.h>

#include "renderer/cells/tree.h"
#include "renderer/lanes/solid_leaf-inl.h"
#include "renderer/lanes/tree_joins-inl.h"
#include "tests/support/random_scene.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

constexpr int k_places = 33;

float at(const Line& line, float u) { return (1 - u) * hn::GetLane(line.left) + u * hn::GetLane(line.right); }
Line line(double left, double right) { return {set(static_cast<float>(left)), set(static_cast<float>(right))}; }

/// How far a potential comes out above the line above it, or below the one below it, where the distance goes along a line.
double past_lines_of_bump(Random& r) {
  constexpr double k_shapes[][2] = {{1, 0}, {0, 1}, {3, -2}, {5 / 9.0, 4 / 9.0}}; // a, b
  const auto& [a, b] = k_shapes[r.below(4)];
  const double weight = r.uniform(0.2, 4), radius = r.uniform(0.1, 3);
  const double crest = b < 0 ? std::clamp(0.4 - 0.2 * a / b, 0.0, 1.0) : 1;
  const auto vector = [](double x) { return set(static_cast<float>(x)); };
  const Bump bump{vector(1 / (radius * radius)), vector(weight * a), vector(weight * b), vector(crest)};
  const Line distance = line(radius * r.uniform(-0.7, 1.5), radius * r.uniform(-0.7, 1.5));
  const Line above = bump.above(distance), below = bump.below(distance);
  double most = 0;
  for (int i = 0; i < k_places; ++i) {
    const float u = float(i) / (k_places - 1);
    const float f = hn::GetLane(bump.at(bump.closeness(set(at(distance, u)))));
    most = std::max({most, double(f - at(above, u)), double(at(below, u) - f)});
  }
  return most / weight;
}

/// The same for a ramp; without limits, too, as signed distances are where nothing cuts them off.
double past_lines_of_ramp(Random& r) {
  constexpr float k_infinity = std::numeric_limits<float>::infinity();
  const float a = float(r.uniform(-1, 3)), b = float(r.log_uniform(0.3, 30));
  const bool is_cut = r.below(3) > 0;
  const Ramp ramp{set(a), set(b), set(is_cut ? 0 : -k_infinity), set(is_cut ? 2 : k_infinity)};
  const Line distance = line((a - r.uniform(-1, 3)) / b, (a - r.uniform(-1, 3)) / b);
  const Line above = ramp.above(distance), below = ramp.below(distance);
  double most = 0;
  for (int i = 0; i < k_places; ++i) {
    const float u = float(i) / (k_places - 1);
    const float f = hn::GetLane(ramp.at(set(at(distance, u))));
    most = std::max({most, double(f - at(above, u)), double(at(below, u) - f)});
    if (!is_cut) most = std::max({most, double(at(above, u) - f), double(f - at(below, u))}); // it is the line
  }
  return most;
}

/// How far the signed distance to a solid, along a ray, comes out of what is said of it: below the line below it, above the one above it,
/// or off the value and the rate of change in the middle.
template <class Kind>
double past_lines_of_distance(Random& r, const Kind& kind, const Box3d& around) {
  SampledField field;
  add(field, kind);
  const FieldProgram program = compile(std::move(field), 1);
  const Vec3 middle(r.in(around.padded(0.3)));
  const std::optional<Tree> tree = make_tree(program, program.code, {middle - 0.3f, middle + 0.3f}, middle);
  if (!tree || tree->solids.size() != 1) return std::numeric_limits<double>::infinity();
  const TreeView leaves = tree->view();
  const SolidView view(leaves.solids, tree->solids[0]);
  const Vec3 place(0.2 * r.direction()), velocity(r.direction());
  const double half = r.log_uniform(1e-3, 0.3);
  const auto vector = [](const Vec3& v) { return V3{set(v.x), set(v.y), set(v.z)}; };
  const SolidRange range = view.range(vector(place), vector(velocity), set(float(half)), true);
  const auto exact = [&](double s) {
    const Vec3d p = Vec3d(middle) + Vec3d(place) + s * Vec3d(velocity);
    return kind.signed_distance(Point3<double>{p.x, p.y, p.z});
  };
  V rate;
  double most = std::abs(double(hn::GetLane(view.distance(vector(place)))) - exact(0));
  most = std::max(most, std::abs(double(hn::GetLane(view.distance(vector(place), vector(velocity), rate))) - exact(0)));
  for (int i = 0; i < k_places; ++i) {
    const float u = float(i) / (k_places - 1);
    const double s = half * (2 * double(u) - 1), d = exact(s);
    most = std::max({most, double(at(range.near, u)) - d, d - double(at(range.far, u))});
    // A tangent below it; of what is not convex a bound of the slope.
    const double slope = double(hn::GetLane(rate));
    most = std::max(most, (tree->solids[0].is_convex ? exact(0) + slope * s : exact(0) - slope * std::abs(s)) - d);
  }
  return most;
}

double past_lines_of_any_distance(Random& r, int kind) {
  const auto special = [&](auto k) {
    make_special(k, r);
    return past_lines_of_distance(r, k, k.solid_box());
  };
  switch (kind) {
  case 0: return special(random_kind<SdfSphere>(r));
  case 1: return special(random_kind<SdfBox>(r));
  case 2: return special(random_kind<SdfCylinder>(r));
  case 3: return special(random_kind<SdfCapsule>(r));
  case 4: return special(random_kind<SdfTorus>(r));
  }
  SdfPlane<SampledMode> plane;
  plane.point = random_point(r), plane.normal = Vec3(r.direction());
  return past_lines_of_distance(r, plane, {Vec3d(plane.point), Vec3d(plane.point)}); // it has no end
}

/// The same for an R-union of fields between two lines each.
double past_line_of_r_union(Random& r) {
  const double largest = r.below(2) ? 1.2 : 4;
  const double a0 = r.uniform(0, largest), a1 = r.uniform(0, largest), b0 = r.uniform(0, largest), b1 = r.uniform(0, largest);
  const bool is_tight = r.below(2);
  const auto less = [&](double x) { return is_tight ? x : x * r.uniform(0, 1); };
  const Line a = line(a0, a1), b = line(b0, b1), least_a = line(less(a0), less(a1)), least_b = line(less(b0), less(b1));
  const Line above = above_r_union(a, b, least_a, least_b);
  double most = 0;
  for (int i = 0; i < k_places; ++i) {
    const float u = float(i) / (k_places - 1);
    const auto between = [&](const Line& low, const Line& high) { return std::lerp(at(low, u), at(high, u), float(r.uniform(0, 1))); };
    const float f = hn::GetLane(RFunctions::unite(set(between(least_a, a)), set(between(least_b, b))));
    most = std::max(most, double(f - at(above, u)));
  }
  return most;
}

/// The same for any join of fields that lie between two lines each.
double past_lines_of_join(Random& r, Join join) {
  const auto count = join == Join::local_blend ? uint32_t(3 + r.below(3)) : 2u; // with its region
  const auto threshold = float(r.log_uniform(0.3, 3));
  const TreeStep step{TreeStep::Kind::join, false, join, Demand::value, float(r.log_uniform(0.3, 30)), 0, count};
  const double largest = (r.below(2) ? 1.2 : 4) * double(threshold);
  std::vector<Slope> fields(count);
  for (Slope& f : fields) {
    const double lowest = r.below(3) ? 0 : -largest; // a weight may be negative; often one does not reach
    const double a = r.below(6) ? r.uniform(lowest, largest) : 0, b = r.below(6) ? r.uniform(lowest, largest) : 0;
    const double wide = r.below(3) ? r.log_uniform(1e-3, 1) * largest : 0;
    f.high = line(a, b), f.low = line(a - r.uniform(0, wide), b - r.uniform(0, wide)), f.value = f.high.middle();
  }
  std::vector<Slope> joined = fields;
  join_slopes<true>(step, threshold, joined.data());
  double most = 0;
  for (int i = 0; i < k_places; ++i) {
    const float u = float(i) / (k_places - 1);
    std::vector<Slope> at_u(count);
    for (uint32_t j = 0; j < count; ++j) {
      const float share = r.below(3) ? float(r.uniform(0, 1)) : float(r.below(2)); // often at one end
      at_u[j].value = set(std::lerp(at(fields[j].low, u), at(fields[j].high, u), share));
      at_u[j].low = at_u[j].high = {at_u[j].value, at_u[j].value};
    }
    join_slopes<true>(step, threshold, at_u.data());
    const float f = hn::GetLane(at_u[0].value);
    most = std::max({most, double(f - at(joined[0].high, u)), double(at(joined[0].low, u) - f)});
  }
  return most / largest;
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

namespace kelpie {
namespace {

TEST(FieldLines, APotentialLiesBetweenItsLines) {
  Random r(1);
  for (int trial = 0; trial < 50'000; ++trial) ASSERT_LT(HWY_STATIC_DISPATCH(past_lines_of_bump)(r), 1e-5) << trial;
}

TEST(FieldLines, ARampLiesBetweenItsLines) {
  Random r(1);
  for (int trial = 0; trial < 50'000; ++trial) ASSERT_LT(HWY_STATIC_DISPATCH(past_lines_of_ramp)(r), 2e-5) << trial;
}

TEST(FieldLines, ASignedDistanceLiesBetweenItsLines) {
  Random r(1);
  for (int trial = 0; trial < 12'000; ++trial) ASSERT_LT(HWY_STATIC_DISPATCH(past_lines_of_any_distance)(r, trial % 6), 1e-5) << trial;
}

TEST(FieldLines, AnRUnionLiesBelowItsLine) {
  Random r(1);
  for (int trial = 0; trial < 50'000; ++trial) ASSERT_LT(HWY_STATIC_DISPATCH(past_line_of_r_union)(r), 1e-5) << trial;
}

struct NamedJoin {
  const char* name;
  Join join;
};

class Joins : public testing::TestWithParam<NamedJoin> {};

// Lines above and below the operands make lines above and below what joins them.
TEST_P(Joins, LieBetweenTheirLines) {
  Random r(1);
  for (int trial = 0; trial < 30'000; ++trial) ASSERT_LT(HWY_STATIC_DISPATCH(past_lines_of_join)(r, GetParam().join), 1e-5) << trial;
}

INSTANTIATE_TEST_SUITE_P(FieldLines, Joins,
                         testing::Values(NamedJoin{"sum", Join::sum}, NamedJoin{"maximum", Join::maximum},
                                         NamedJoin{"minimum", Join::minimum}, NamedJoin{"difference", Join::difference},
                                         NamedJoin{"r_union", Join::r_union}, NamedJoin{"r_intersection", Join::r_intersection},
                                         NamedJoin{"r_difference", Join::r_difference}, NamedJoin{"hyper_blend", Join::hyper_blend},
                                         NamedJoin{"local_blend", Join::local_blend}),
                         [](const auto& join) { return join.param.name; });

} // namespace
} // namespace kelpie
