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

  Offset(const Leaf& leaf, V x_, V y_, V z_) : x(x_), y(y_) {
    const V across2 = hn::MulAdd(x, x, hn::Mul(y, y));
    const V s = hn::Min(hn::Max(hn::NegMulAdd(leaf.slope, hn::Sqrt(across2), z_), leaf.s_low), leaf.s_high);
    z = hn::Sub(z_, s);
    length = hn::Sqrt(hn::MulAdd(z, z, across2));
    radius = hn::NegMulAdd(leaf.sine, s, leaf.r);
  }

  V distance() const { return hn::Sub(length, radius); }
  /// The distance's derivative along (x1, y1, z1).
  V rate(V x1, V y1, V z1) const { return hn::Div(hn::MulAdd(x, x1, hn::MulAdd(y, y1, hn::Mul(z, z1))), hn::Max(length, set(1e-30f))); }
};

inline V square_of_positive(V v) {
  const V p = hn::Max(v, hn::Zero(k_lanes));
  return hn::Mul(p, p);
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
