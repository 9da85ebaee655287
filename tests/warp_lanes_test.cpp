// Warps in SIMD lanes are the warps that every kind's own formula makes.
#define HWY_COMPILE_ONLY_STATIC
#include <gtest/gtest.h>

#include "field/warps/axis_tube.h"
#include "renderer/lanes/warp_lanes-inl.h"
#include "tests/support/random_scene.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

/// How far apart the two are, in places (of the cell's size) and velocities, at a place of a ray through the cell.
Vec2d difference(const FieldProgram& program, const TreeView& tree, const Vec3& centre, const Vec3& from_centre, const Vec3& direction,
                 float size) {
  const auto in_lanes = [](const Vec3& v) { return V3{set(v.x), set(v.y), set(v.z)}; };
  Curve curves[k_tree_spaces];
  const auto none = [](size_t) -> Curve { throw std::logic_error("no form in lanes"); };
  find_curves(tree, {in_lanes(from_centre), in_lanes(direction)}, 1, none, curves);
  using D = Dual<double, 1>;
  SpacePoints<D> points;
  points.begin(program);
  const auto coordinate = [&](int i) { return D{double(centre[i]) + double(from_centre[i]), {double(direction[i])}}; };
  const Point3<D> world{coordinate(0), coordinate(1), coordinate(2)};
  Vec2d most(0);
  for (size_t i = 0; i < tree.spaces.size(); ++i) {
    const Point3<D>& p = points.at(program, tree.spaces[i].space, world);
    const auto apart = [](const V3& a, const Vec3d& b) {
      return glm::distance(Vec3d(hn::GetLane(a.x), hn::GetLane(a.y), hn::GetLane(a.z)), b);
    };
    const Vec3d from_image = Vec3d(p.x.value, p.y.value, p.z.value) - Vec3d(tree.spaces[i].centre);
    most =
        glm::max(most, Vec2d(apart(curves[i].place, from_image) / double(size), apart(curves[i].velocity, {p.x.d[0], p.y.d[0], p.z.d[0]})));
  }
  return most;
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

namespace kelpie {
namespace {

template <template <class> class Kind>
unsigned add_warp(Random& r, SampledField& field, unsigned child) {
  auto warp = random_kind<Kind>(r);
  make_special(warp, r);
  warp.child = child;
  if constexpr (requires { warp.rate; }) warp.rate *= 40; // degrees
  return add(field, warp);
}

// To about 1e-6 of the cell's size, wherever the cell is: numbers are as large as the cell.
TEST(WarpLanes, AreTheFormulasOfTheKinds) {
  size_t compared = 0;
  double most_place = 0, most_velocity = 0;
  for (unsigned trial = 0; trial < 3000; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    SampledField field;
    Point<SampledMode> point;
    point.radius = 10, point.weight = 2;
    unsigned node = add(field, point);
    for (int depth = 1 + r.below(2); depth > 0; --depth) {
      switch (r.below(3)) {
      case 0: node = add_warp<Twist>(r, field, node); break;
      case 1: node = add_warp<Taper>(r, field, node); break;
      default: node = add_warp<Bend>(r, field, node); break;
      }
      Rotate<SampledMode> rotate = random_kind<Rotate>(r);
      rotate.child = node;
      if (r.below(2)) node = add(field, rotate);
    }
    const FieldProgram program = compile(field, 1);
    const float size = float(r.log_uniform(1e-3, 0.2));
    const Vec3 middle = random_point(r, 2);
    const Box3 cell{middle - size, middle + size};
    const Vec3 centre = cell.centre();
    const std::optional<Tree> tree = make_tree(program, program.code, cell, centre);
    if (!tree) continue; // too far from a line
    const TreeView view = tree->view();
    if (std::any_of(view.spaces.begin(), view.spaces.end(), [](const TreeSpace& s) { return s.warp.form == LaneWarp::Form::none; }))
      continue; // nearly straight
    for (int i = 0; i < 10; ++i) {
      const Vec2d d = HWY_STATIC_DISPATCH(difference)(program, view, Box3{centre - size, centre + size}.centre(), random_point(r, size),
                                                      Vec3(r.direction()), size);
      most_place = std::max(most_place, d.x), most_velocity = std::max(most_velocity, d.y), ++compared;
      EXPECT_LT(d.x, 2e-5);
      EXPECT_LT(d.y, 2e-3);
    }
  }
  RecordProperty("most_place", std::to_string(most_place));
  RecordProperty("most_velocity", std::to_string(most_velocity));
  EXPECT_GT(compared, 5000u);
}

// As precise as its frames are, a few 1e-6 of the tube's radius, and where it is in lanes at all: of most cells that one axis has
// to itself.
TEST(WarpLanes, AreAxialDeformationsWhereOneAxisActsAlone) {
  size_t compared = 0, joined = 0, still = 0, at_ends = 0;
  double most_place = 0, most_velocity = 0;
  for (unsigned trial = 0; trial < 4000; ++trial) {
    SCOPED_TRACE(trial);
    Random r(trial);
    SampledField field;
    Point<SampledMode> point;
    point.radius = 10, point.weight = 2;
    Rotate<SampledMode> rotate = random_kind<Rotate>(r);
    auto axial = random_kind<Axial>(r);
    if (axial.map->tubes().empty()) continue;
    const AxisCurve& axis = axial.map->tubes()[0].deformed();
    axial.child = add(field, point);
    const unsigned node = add(field, axial);
    rotate.child = node;
    const bool is_rotated = r.below(2);
    if (is_rotated) add(field, rotate);
    const FieldProgram program = compile(field, 1);
    const float size = float(r.log_uniform(1e-3, 0.2));
    Vec3 centre = random_point(r, 2);
    if (!is_rotated && r.below(8) > 0) { // near the axis; sometimes near its end
      const size_t step = r.below(2) ? axis.steps() - 1 : r.below(unsigned(axis.steps()));
      centre = Vec3(axis.step(step)(r.below(2) ? r.uniform(0, 1) : 0) + 0.5 * axis.reach(step, 0.5) * r.uniform(0, 1) * r.direction());
    }
    const Box3 cell{centre - size, centre + size};
    const std::optional<Tree> tree = make_tree(program, program.code, cell, cell.centre());
    if (!tree) continue; // torn, or too far from a line
    const TreeView view = tree->view();
    if (view.spaces[0].warp.form == LaneWarp::Form::none) continue; // several axes, or borders
    joined += view.spaces[0].warp.piece_count > 1, still += view.spaces[0].warp.piece_count == 0;
    for (int i = 0; i < 10; ++i) {
      const Vec3 from_centre = random_point(r, size);
      AxisFoot foot;
      at_ends += !is_rotated && axis.find(Vec3d(centre + from_centre), foot) && foot.is_at_end;
      const Vec2d d = HWY_STATIC_DISPATCH(difference)(program, view, cell.centre(), from_centre, Vec3(r.direction()), size);
      const double place = d.x * double(size);
      most_place = std::max(most_place, place), most_velocity = std::max(most_velocity, d.y), ++compared;
      EXPECT_LT(place, 4e-6 + 2e-5 * double(size));
      EXPECT_LT(d.y, 2e-3);
    }
  }
  RecordProperty("most_place", std::to_string(most_place));
  RecordProperty("most_velocity", std::to_string(most_velocity));
  EXPECT_GT(compared, 5000u);
  EXPECT_GT(joined, 10u) << "cells where an axis has a knot";
  EXPECT_GT(still, 50u) << "cells where nothing moves";
  EXPECT_GT(at_ends, 500u) << "points beyond an end";
}

} // namespace
} // namespace kelpie
