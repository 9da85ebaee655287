// How operators see their operands, and what becomes of those that are dropped.
#include <gtest/gtest.h>

#include "renderer/program/bound.h"
#include "tests/support/random_scene.h"

namespace kelpie {
namespace {

/// An operator that sees each child in two places, and weighs the second.
template <class Mode>
struct TwoPlaces {
  typename Mode::Children children;
  typename Mode::Child weight{};
  Value<Mode, Vec3> by{Vec3(0)};

  static constexpr auto parameters() {
    return std::tuple{parameter("children", &TwoPlaces::children, ""), parameter("weight", &TwoPlaces::weight, "").as(Role::weight),
                      parameter("by", &TwoPlaces::by, "")};
  }
  template <class Visit>
  void for_each_operand(Visit&& visit) const {
    for (const unsigned child : children)
      visit(Operand{child, Role::child, {}}), visit(Operand{child, Role::child, {Mat3d(1.0), Vec3d(by)}});
    visit(Operand{weight, Role::weight, {}});
  }
};

TEST(Operands, AreWhatTheTableSays) {
  LocalBlend<SampledMode> blend;
  blend.children = {3, 4}, blend.region = 7;
  const std::vector<Operand> operands = operands_of(blend);
  ASSERT_EQ(operands.size(), 3u);
  EXPECT_EQ(operands[0].node, 3u);
  EXPECT_EQ(operands[1].role, Role::child);
  EXPECT_EQ(operands[2].node, 7u);
  EXPECT_EQ(operands[2].role, Role::region);
  EXPECT_FALSE(k_sees_through_maps<LocalBlend<SampledMode>>);
}

TEST(Operands, AreSeenThroughMaps) {
  Translate<SampledMode> moved;
  moved.by = Vec3(1, 2, 3), moved.child = 5;
  const std::vector<Operand> one = operands_of(moved);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].parent_from_operand(Vec3d(0)), Vec3d(1, 2, 3));

  TwoPlaces<SampledMode> places;
  places.children = {1}, places.weight = 2, places.by = Vec3(4, 0, 0);
  const std::vector<Operand> three = operands_of(places);
  ASSERT_EQ(three.size(), 3u);
  EXPECT_EQ(three[0].node, three[1].node);
  EXPECT_EQ(three[1].parent_from_operand(Vec3d(0)), Vec3d(4, 0, 0));
  EXPECT_EQ(three[2].role, Role::weight);
  EXPECT_TRUE(k_sees_through_maps<TwoPlaces<SampledMode>>);
}

// Dropping would mix them up.
TEST(Operands, OfSeveralRolesAreToldApartByTheirPlaces) {
  int several = 0;
  FieldKinds::for_each([&]<template <class> class Kind>() {
    using K = Kind<SampledMode>;
    if constexpr (Operator<K>) {
      const K kind;
      bool has_roles = false;
      for_each_operand(kind, [&](const Operand& operand) { has_roles |= operand.role != Role::child; });
      EXPECT_TRUE(!has_roles || is_positional<K>()) << K::k_name;
      several += has_roles;
    }
  });
  EXPECT_GT(several, 0);
}

// --- pruning ---

Point<SampledMode> ball(const Vec3& centre) {
  Point<SampledMode> point;
  point.centre = centre, point.radius = 1, point.weight = 2;
  return point;
}

/// Cylinders at x = 0, 1 and 6, that flow together around x = 1/2.
FieldProgram three_cylinders() {
  SampledField field;
  LocalBlend<SampledMode> blend;
  for (const float x : {0.f, 1.f, 6.f}) {
    Cylinder<SampledMode> k; // which are no blobs: each stays a step
    k.from = Vec3(x, -0.1f, 0), k.to = Vec3(x, 0.1f, 0), k.cylinder_radius = 0.2f, k.radius = 0.8f, k.weight = 2;
    blend.children.push_back(add(field, k));
  }
  blend.region = add(field, ball(Vec3(0.5f, 0, 0)));
  add(field, blend);
  return compile(std::move(field), 1);
}

Code pruned(const FieldProgram& program, const Box3d& box) {
  std::vector<Interval> ranges;
  const Code reaching = bound(program, program.code, box, ranges);
  return prune(program, reaching, ranges);
}

void expect_same(const FieldProgram& program, const Code& code, const Box3d& box) {
  Random r(0);
  int inside = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3d p = r.in(box);
    const Point3<double> at{p.x, p.y, p.z};
    const double whole = evaluate(program, program.code, at);
    EXPECT_NEAR(evaluate(program, code, at), whole, 1e-12);
    inside += whole > 0;
  }
  EXPECT_GT(inside, 50);
}

TEST(PositionalOperands, LeaveTheConstantZeroInTheirPlace) {
  const FieldProgram program = three_cylinders();
  const Box3d box{Vec3d(0.3, -0.2, -0.2), Vec3d(0.7, 0.2, 0.2)};
  const Code code = pruned(program, box);
  const Instruction& root = code.steps.back();
  ASSERT_EQ(root.kind, Instruction::Kind::combine);
  ASSERT_EQ(root.count, 4u);
  const Instruction& dropped = code.steps[code.operands[root.first + 2]];
  EXPECT_EQ(dropped.kind, Instruction::Kind::blobs);
  EXPECT_EQ(dropped.count, 0u);
  expect_same(program, code, box);
}

TEST(PositionalOperands, AreReplacedByALoneChildOnlyWhereItIsAll) {
  const FieldProgram program = three_cylinders();
  const Box3d far{Vec3d(5.8, -0.2, -0.2), Vec3d(6.2, 0.2, 0.2)};
  const Code code = pruned(program, far);
  EXPECT_EQ(code.steps.size(), 1u);
  EXPECT_EQ(code.steps[0].kind, Instruction::Kind::skeleton);
  expect_same(program, code, far);
}

// Where only the region is, there is nothing.
TEST(Support, IsThatOfChildren) {
  SampledField field;
  LocalBlend<SampledMode> blend;
  blend.children = {add(field, ball(Vec3(0))), add(field, ball(Vec3(1, 0, 0)))};
  blend.region = add(field, ball(Vec3(100, 0, 0)));
  add(field, blend);
  const Box3d support = compile(std::move(field), 1).support;
  EXPECT_GE(support.upper.x, 2);
  EXPECT_LT(support.upper.x, 2.1);
}

TEST(Pieces, StandBelowTheUnionThatIsNamed) {
  SampledField field;
  GeneralizedCylinder<SampledMode> tube;
  tube.points = {Vec3(0), Vec3(1, 1, 0), Vec3(2, -1, 0), Vec3(3, 0, 0)}, tube.radii = {0.1f, 0.2f, 0.1f, 0.3f}, tube.radius = 0.3f;
  add(field, tube);
  const FieldProgram program = compile(std::move(field), 1);
  ASSERT_GT(program.field.piece_count, 2u);
  EXPECT_TRUE(std::holds_alternative<Union<SampledMode>>(program.field.nodes[program.field.union_of_pieces]));
  EXPECT_EQ(program.code.steps.back().node, program.field.union_of_pieces);
}

} // namespace
} // namespace kelpie
