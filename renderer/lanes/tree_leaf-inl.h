// The leaves of trees in SIMD lanes. Lanes are places along a ray, rays, or leaves. Included once a target.
#if defined(KELPIE_TREE_LEAF_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_TREE_LEAF_INL
#undef KELPIE_TREE_LEAF_INL
#else
#define KELPIE_TREE_LEAF_INL
#endif

#include "renderer/lanes/potentials-inl.h"
#include "renderer/lanes/tree_view.h"

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
  V s_low, s_high, r, sine, slope, k, a, b, crest;

  static Leaf each(const TreeView& tree, size_t first) {
    const auto row = [&](LeafRow number) { return hn::LoadU(k_lanes, tree.leaves + number * tree.leaf_count + first); };
    return of(row);
  }
  static Leaf all(const TreeView& tree, size_t i) {
    const auto row = [&](LeafRow number) { return set(tree.row(number, i)); };
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
    return {row(leaf_s_low), row(leaf_s_high), row(leaf_r), row(leaf_sine), row(leaf_slope),
            row(leaf_k),     row(leaf_a),      row(leaf_b), row(leaf_crest)};
  }
};

/// From its tangent a ray parts by no more than this times h, h away from where it touches; row(r) as the leaf's numbers.
template <class Row>
V drift_within(const Row& row, V h) {
  return hn::Min(row(leaf_drift), hn::Mul(row(leaf_bending), h));
}

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

/// The same bound, and nearly the least distance itself: by the tangent where the ray is about nearest to the axis.
inline V nearest_approach(const Leaf& leaf, const V3& p, const V3& v, V drift, V h) {
  const V tiny = set(1e-20f);
  const V across = hn::MulAdd(v.x, v.x, hn::Mul(v.y, v.y)), inward = hn::MulAdd(p.x, v.x, hn::Mul(p.y, v.y));
  // On the endless axis, then on its part.
  const V on_axis = hn::Div(hn::Neg(inward), hn::Max(across, tiny));
  const V height = hn::Min(hn::Max(hn::MulAdd(on_axis, v.z, p.z), leaf.s_low), leaf.s_high);
  const V along = hn::MulAdd(hn::Sub(p.z, height), v.z, inward);
  const V nearest = hn::Div(hn::Neg(along), hn::Max(hn::MulAdd(v.z, v.z, across), tiny)), t = hn::Min(hn::Max(nearest, hn::Neg(h)), h);
  const Offset offset(leaf, {hn::MulAdd(v.x, t, p.x), hn::MulAdd(v.y, t, p.y), hn::MulAdd(v.z, t, p.z)});
  const V rate = offset.rate(v), falls = hn::Min(hn::Mul(rate, hn::Sub(h, t)), hn::Neg(hn::Mul(rate, hn::Add(h, t))));
  return hn::NegMulAdd(drift, h, hn::Add(offset.distance(), falls));
}

/// Bounds of the distance from above, around a place with a velocity: on a line it lies below its chord.
inline Line most_distances(const Leaf& leaf, const V3& p, const V3& v, V drift, V h) {
  const auto end = [&](V t) {
    return Offset(leaf, {hn::MulAdd(v.x, t, p.x), hn::MulAdd(v.y, t, p.y), hn::MulAdd(v.z, t, p.z)}).distance();
  };
  return Line{end(hn::Neg(h)), end(h)} + hn::Mul(drift, h);
}

/// Adds a leaf at a place with a velocity, and its bounds on the stretch h either way, to a sum.
HWY_INLINE void add_leaf(const Leaf& leaf, bool is_positive, bool wants_low, const V3& place, const V3& velocity, V drift, V h,
                         Slope& sum) {
  const Offset offset(leaf, place);
  const V distance = offset.distance(), rise = hn::Mul(offset.rate(velocity), h), near = hn::NegMulAdd(drift, h, distance);
  sum.value = hn::Add(sum.value, leaf.potential(square_of_positive(distance)));
  const auto far = [&] { return most_distances(leaf, place, velocity, drift, h); };
  add_lines(Bump{leaf.k, leaf.a, leaf.b, leaf.crest}, is_positive, wants_low, {hn::Sub(near, rise), hn::Add(near, rise)}, far, sum);
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
