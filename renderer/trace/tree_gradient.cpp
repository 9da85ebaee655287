// The gradient of a tree: values and gradients of the leaves in SIMD lanes, a leaf a lane, then the operators' own derivatives.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "renderer/trace/tree_gradient.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>

#include "renderer/lanes/tree_joins-inl.h"
#include "renderer/lanes/tree_leaf-inl.h"
#include "renderer/lanes/warp_lanes-inl.h"
#include "renderer/lanes/warped_ray.h"
#include "renderer/trace/solve.h"
#include "renderer/trace/tree_values.h"

#ifndef KELPIE_TREE_GRADIENT_ONCE
#define KELPIE_TREE_GRADIENT_ONCE
namespace kelpie {

using ValueAndSlopes = Dual<double, 3>;

/// By the skeleton's own formula.
inline ValueAndSlopes solid_value(const FieldProgram& program, const SolidLeaf& leaf, const Vec3& place) {
  thread_local SpacePoints<ValueAndSlopes> points;
  points.begin(program);
  const Point3<ValueAndSlopes> world{ValueAndSlopes::variable(place.x, 0), ValueAndSlopes::variable(place.y, 1),
                                     ValueAndSlopes::variable(place.z, 2)};
  const Point3<ValueAndSlopes> p = points.at(program, leaf.space, world);
  return std::visit(
      [&](const auto& kind) -> ValueAndSlopes {
        using K = std::decay_t<decltype(kind)>;
        if constexpr (Skeleton<K>) return potential(kind, p) * potential_unit(kind, program.threshold);
        return {};
      },
      program.field.nodes[leaf.node]);
}

} // namespace kelpie
#endif

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

/// Where a point is in the spaces of a tree, from their centres, and how gradients get from there to the world.
class SpaceGradients {
public:
  SpaceGradients(const ShapeCells& shape, const TreeView& tree, const Cell& cell, const Vec3& place) : world_(place - cell.centre) {
    if (tree.spaces.empty()) return;
    const WarpedRay curves(shape.program, tree.spaces);
    count_ = tree.spaces.size();
    // The curves of the lines along x, y and z, as many at a time as there are lanes.
    for (size_t first = 0; first < 3; first += k_width) {
      const size_t axes = std::min<size_t>(k_width, 3 - first);
      const auto by_points = [&](size_t i) {
        CurveRows rows;
        for (size_t j = 0; j < axes; ++j) rows.set_lane(j, curves.find(place, unit(first + j), 0, i));
        return rows.curve();
      };
      CurveRows lines;
      for (size_t j = 0; j < k_width; ++j) lines.set_lane(j, WarpedRay::Place{world_, unit(first + j)});
      Curve found[k_tree_spaces];
      find_curves(tree, lines.curve(), axes, by_points, found);
      for (size_t i = 0; i < count_; ++i) {
        const V3 &at = found[i].place, &by = found[i].velocity;
        warped_[i].place[0] = hn::GetLane(at.x), warped_[i].place[1] = hn::GetLane(at.y), warped_[i].place[2] = hn::GetLane(at.z);
        alignas(64) float rates[3][k_width];
        hn::Store(by.x, k_lanes, rates[0]), hn::Store(by.y, k_lanes, rates[1]), hn::Store(by.z, k_lanes, rates[2]);
        for (int c = 0; c < 3; ++c)
          for (size_t j = 0; j < axes; ++j) warped_[i].gradients[c][first + j] = rates[c][j];
      }
    }
  }

  /// In the spaces of leaves, by their numbers `leaf_space`.
  V3 places(V slots) const {
    V3 p = vector(&world_.x);
    for_each_space(slots, [&](M is_here, const Warped& w) { p = choose(is_here, vector(w.place), p); });
    return p;
  }
  V3 in_world(V slots, const V3& g) const {
    V3 all = g;
    for_each_space(slots, [&](M is_here, const Warped& w) {
      const V3 x = vector(w.gradients[0]), y = vector(w.gradients[1]), z = vector(w.gradients[2]);
      const auto along = [&](V a, V b, V c) { return hn::MulAdd(g.x, a, hn::MulAdd(g.y, b, hn::Mul(g.z, c))); };
      all = choose(is_here, {along(x.x, y.x, z.x), along(x.y, y.y, z.y), along(x.z, y.z, z.z)}, all);
    });
    return all;
  }

private:
  struct Warped {
    float place[3], gradients[3][3]; ///< of its coordinates
  };
  static Vec3 unit(size_t axis) { return Vec3(axis == 0, axis == 1, axis == 2); }
  static V3 vector(const float* v) { return {set(v[0]), set(v[1]), set(v[2])}; }
  static V3 choose(M first, const V3& a, const V3& b) {
    return {hn::IfThenElse(first, a.x, b.x), hn::IfThenElse(first, a.y, b.y), hn::IfThenElse(first, a.z, b.z)};
  }
  template <class Visit>
  void for_each_space(V slots, const Visit& visit) const {
    for (size_t i = 0; i < count_; ++i) visit(hn::Eq(slots, set(static_cast<float>(i + 1))), warped_[i]);
  }

  Vec3 world_;
  Warped warped_[k_tree_spaces];
  size_t count_ = 0;
};

/// Values and gradients of the leaves, a leaf a lane, then the operators.
Vec3 TreeGradient(const ShapeCells& shape, const Cell& cell, const Vec3& place) {
  thread_local std::array<std::vector<float>, 4> leaves; // value, gradient
  const TreeView tree = shape.tree(cell);
  const size_t n = tree.leaf_count;
  for (auto& list : leaves)
    if (list.size() < n) list.resize(n);
  const SpaceGradients spaces(shape, tree, cell, place);
  for (size_t i = 0; i < n; i += k_width) {
    const auto row = [&](uint32_t r) { return hn::LoadU(k_lanes, tree.leaves + r * n + i); };
    const V slots = row(leaf_space);
    const Leaf leaf = Leaf::each(tree, i);
    const Offset offset(leaf, place_in_frame(row, spaces.places(slots)));
    const V d = hn::Max(offset.distance(), hn::Zero(k_lanes));
    const V q = hn::Max(hn::NegMulAdd(leaf.k, hn::Mul(d, d), set(1)), hn::Zero(k_lanes));
    // d/dd of q^2 (a + b q) is -2 k d q (2 a + 3 b q).
    const V slope =
        hn::Mul(hn::Mul(hn::Mul(leaf.k, d), hn::Mul(q, set(-2))), hn::MulAdd(hn::Mul(set(3), leaf.b), q, hn::Add(leaf.a, leaf.a)));
    const V factor = hn::Div(slope, hn::Max(offset.length, set(1e-30f)));
    const auto component = [&](uint32_t c) {
      return hn::Mul(factor,
                     hn::MulAdd(row(leaf_xx + c), offset.x, hn::MulAdd(row(leaf_yx + c), offset.y, hn::Mul(row(leaf_zx + c), offset.z))));
    };
    const V3 g = spaces.in_world(slots, {component(0), component(1), component(2)});
    hn::StoreU(leaf.potential(hn::Mul(d, d)), k_lanes, &leaves[0][i]);
    hn::StoreU(g.x, k_lanes, &leaves[1][i]), hn::StoreU(g.y, k_lanes, &leaves[2][i]), hn::StoreU(g.z, k_lanes, &leaves[3][i]);
  }

  const auto add_step = [&](const TreeStep& step, ValueAndSlopes& out) {
    if (step.kind == TreeStep::Kind::solid) {
      out = solid_value(shape.program, tree.solids.leaves[step.first], place);
      return;
    }
    ValueAndSlopes sum;
    for (uint32_t i = step.first; i < step.first + step.count; ++i)
      if (leaves[0][i] != 0) sum = sum + ValueAndSlopes(leaves[0][i], {double(leaves[1][i]), double(leaves[2][i]), double(leaves[3][i])});
    out = sum;
  };
  const auto join = [&](const TreeStep& step, ValueAndSlopes* operands) { operands[0] = combine(shape.program, step, operands); };
  const ValueAndSlopes f = fold_tree<ValueAndSlopes>(tree.steps, add_step, join);
  return Vec3(Vec3d(f.d[0], f.d[1], f.d[2]));
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kelpie {

HWY_EXPORT(TreeGradient);

Vec3 tree_gradient(const ShapeCells& shape, const Cell& cell, const Vec3& p) { return HWY_DYNAMIC_DISPATCH(TreeGradient)(shape, cell, p); }

} // namespace kelpie
#endif
