// The leaves of trees in SIMD lanes. Lanes are places along a ray, rays, or leaves. Included once a target.
#if defined(KELPIE_TREE_LEAF_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_TREE_LEAF_INL
#undef KELPIE_TREE_LEAF_INL
#else
#define KELPIE_TREE_LEAF_INL
#endif

#include "renderer/cells/tree.h"
#include "renderer/trace/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

/// A place or a velocity in the frame of a leaf whose numbers are row(r).
template <class Row>
V3 place_in_frame(const Row& row, const V3& p) {
  const auto along = [&](uint32_t r) {
    return hn::MulAdd(row(r), p.x, hn::MulAdd(row(r + 1), p.y, hn::MulAdd(row(r + 2), p.z, row(r + 3))));
  };
  return {along(leaf_xx), along(leaf_yx), along(leaf_zx)};
}
template <class Row>
V3 velocity_in_frame(const Row& row, const V3& v) {
  const auto along = [&](uint32_t r) { return hn::MulAdd(row(r), v.x, hn::MulAdd(row(r + 1), v.y, hn::Mul(row(r + 2), v.z))); };
  return {along(leaf_xx), along(leaf_yx), along(leaf_zx)};
}

/// The numbers of a leaf in every lane, or of a leaf a lane.
struct Leaf {
  V s_low, s_high, r, sine, slope, k, a, b;

  static Leaf each(const TreeView& tree, size_t first) {
    const auto row = [&](LeafRow r) { return hn::LoadU(k_lanes, tree.leaves + r * tree.leaf_count + first); };
    return of(row);
  }
  static Leaf all(const TreeView& tree, size_t i) {
    const auto row = [&](LeafRow r) { return set(tree.leaves[r * tree.leaf_count + i]); };
    return of(row);
  }

  /// q^2 (a + b q), q = max(0, 1 - k d^2).
  V potential(V d2) const {
    const V q = hn::Max(hn::NegMulAdd(k, d2, set(1)), hn::Zero(k_lanes));
    return hn::Mul(hn::Mul(q, q), hn::MulAdd(b, q, a));
  }

private:
  template <class Row>
  static Leaf of(const Row& row) {
    return {row(leaf_s_low), row(leaf_s_high), row(leaf_r), row(leaf_sine), row(leaf_slope), row(leaf_k), row(leaf_a), row(leaf_b)};
  }
};

/// A place in a leaf's frame, seen from the nearest point of its axis: the distance is length - radius.
struct Offset {
  V x, y, z, length, radius;

  Offset(const Leaf& leaf, const V3& p) : x(p.x), y(p.y) {
    const V across2 = hn::MulAdd(x, x, hn::Mul(y, y));
    const V s = hn::Min(hn::Max(hn::NegMulAdd(leaf.slope, hn::Sqrt(across2), p.z), leaf.s_low), leaf.s_high);
    z = hn::Sub(p.z, s);
    length = hn::Sqrt(hn::MulAdd(z, z, across2));
    radius = hn::NegMulAdd(leaf.sine, s, leaf.r);
  }

  V distance() const { return hn::Sub(length, radius); }
  /// The distance's derivative at a velocity.
  V rate(const V3& v) const { return hn::Div(hn::MulAdd(x, v.x, hn::MulAdd(y, v.y, hn::Mul(z, v.z))), hn::Max(length, set(1e-30f))); }
  /// A bound of the distance from below on the stretch h either way: the distance is convex, so on a line it lies
  /// above its tangent, and from a line a ray parts by `drift` times h at most.
  V least(const V3& v, V drift, V h) const { return hn::NegMulAdd(hn::Add(hn::Abs(rate(v)), drift), h, distance()); }
};

/// The same from above, around a place with a velocity: on a line it is the larger of the ends.
inline V most_distance(const Leaf& leaf, const V3& p, const V3& v, V drift, V h) {
  const auto end = [&](V t) {
    return Offset(leaf, {hn::MulAdd(v.x, t, p.x), hn::MulAdd(v.y, t, p.y), hn::MulAdd(v.z, t, p.z)}).distance();
  };
  return hn::MulAdd(drift, h, hn::Max(end(h), end(hn::Neg(h))));
}

inline V square_of_positive(V v) {
  const V p = hn::Max(v, hn::Zero(k_lanes));
  return hn::Mul(p, p);
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
