// The leaves of trees in SIMD lanes. Lanes are places along a ray, rays, or leaves. Included once a target.
#if defined(KELPIE_TREE_LEAF_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_TREE_LEAF_INL
#undef KELPIE_TREE_LEAF_INL
#else
#define KELPIE_TREE_LEAF_INL
#endif

#include <hwy/contrib/math/math-inl.h>

#include "renderer/lanes/lanes-inl.h"
#include "renderer/lanes/tree_view.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

inline V square_of_positive(V v) {
  const V p = hn::Max(v, hn::Zero(k_lanes));
  return hn::Mul(p, p);
}

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

/// What lies on a line between two values, which are meant at the ends of a stretch.
struct Line {
  V left, right;

  V least() const { return hn::Min(left, right); }
  V most() const { return hn::Max(left, right); }
  V middle() const { return hn::Mul(set(0.5f), hn::Add(left, right)); }
};
inline Line operator+(const Line& a, const Line& b) { return {hn::Add(a.left, b.left), hn::Add(a.right, b.right)}; }
inline Line operator+(const Line& a, V b) { return {hn::Add(a.left, b), hn::Add(a.right, b)}; }
inline Line choose(M first, const Line& a, const Line& b) {
  return {hn::IfThenElse(first, a.left, b.left), hn::IfThenElse(first, a.right, b.right)};
}
/// f(a, b), end by end.
template <class Join>
Line join_ends(const Line& a, const Line& b, const Join& f) {
  return {f(a.left, b.left), f(a.right, b.right)};
}

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

/// The localised R-functions as in field/operators/r_functions.h, of fields in units of the threshold.
struct RFunctions {
  static V norm(V a, V b) {
    const V x = hn::Sub(a, set(1)), y = hn::Sub(b, set(1));
    return hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y)));
  }
  static V u(V a, V b) { return hn::MulAdd(hn::Add(hn::Sub(hn::Add(a, b), set(2)), norm(a, b)), set(1.7071067811865475f), set(1)); }
  static V r(V a, V b) { return hn::MulAdd(hn::Sub(hn::Sub(hn::Add(a, b), set(2)), norm(a, b)), set(0.2928932188134525f), set(1)); }
  static V k(V f) { return square_of_positive(hn::Sub(set(1), f)); }
  static V rest(V f) { return hn::Sub(f, u(hn::Zero(k_lanes), f)); }
  static V unite(V a, V b) { return hn::MulAdd(k(a), rest(b), hn::MulAdd(k(b), rest(a), u(a, b))); }
  static V intersect(V a, V b) {
    return hn::NegMulAdd(k(a), r(hn::Zero(k_lanes), b), hn::NegMulAdd(k(b), r(a, hn::Zero(k_lanes)), r(a, b)));
  }
};

/// The hyper-blend of two fields, the part below 0 counting as 0: m (1 + r^n)^(1/n), m the larger and r the ratio.
static HWY_NOINLINE V hyper_blend(float exponent, V a, V b) {
  const V zero = hn::Zero(k_lanes), least = set(std::numeric_limits<float>::min());
  const V m = hn::Max(hn::Max(a, b), zero), ratio = hn::Div(hn::Max(hn::Min(a, b), zero), hn::Max(m, least));
  const V power = hn::Exp(k_lanes, hn::Mul(set(exponent), hn::Log(k_lanes, hn::Max(ratio, least))));
  const V factor = hn::Exp(k_lanes, hn::Mul(set(1 / exponent), hn::Log1p(k_lanes, power)));
  return hn::Mul(m, hn::IfThenElse(hn::Gt(ratio, least), factor, set(1)));
}

/// Two fields joined. `b` is what is subtracted, as it is. Where one of them is 0, the R-functions are exactly what they should be: as
/// if the step were not there.
HWY_INLINE V join_two(const TreeStep& step, float threshold, V a, V b) {
  const V zero = hn::Zero(k_lanes), units = set(1 / threshold), t = set(threshold);
  const auto in_units = [&](V f) { return hn::Mul(hn::Max(f, zero), units); };
  switch (step.kind) {
  case TreeStep::Kind::maximum: return hn::Max(a, b);
  case TreeStep::Kind::minimum: return hn::Min(a, b);
  case TreeStep::Kind::difference: return hn::Max(zero, hn::Min(a, hn::Sub(set(2 * threshold), b)));
  case TreeStep::Kind::r_union: {
    const V both = hn::Mul(t, RFunctions::unite(in_units(a), in_units(b)));
    return hn::IfThenElse(hn::Le(a, zero), hn::Max(b, zero), hn::IfThenElse(hn::Le(b, zero), a, both));
  }
  case TreeStep::Kind::r_intersection:
    return hn::IfThenZeroElse(hn::Or(hn::Le(a, zero), hn::Le(b, zero)), hn::Mul(t, RFunctions::intersect(in_units(a), in_units(b))));
  case TreeStep::Kind::r_difference:
    return hn::IfThenZeroElse(hn::Le(a, zero), hn::Mul(t, RFunctions::intersect(in_units(a), in_units(hn::Sub(set(2 * threshold), b)))));
  case TreeStep::Kind::hyper_blend: return hyper_blend(step.exponent, a, b);
  default: return hn::Add(a, b);
  }
}

/// The sum of some fields where `region` is 1, the largest where it is 0.
template <class At>
V mix(uint32_t count, const At& at, V region) {
  V most = at(0), sum = most;
  for (uint32_t i = 1; i < count; ++i) most = hn::Max(most, at(i)), sum = hn::Add(sum, at(i));
  return hn::MulAdd(hn::Min(hn::Max(region, hn::Zero(k_lanes)), set(1)), hn::Sub(sum, most), most);
}

/// A field at a place, and its bounds around it; of these only those that the tree asks for are meant.
struct Range {
  V value, low, high;
};

/// Every step rises with its operands, or falls with what it subtracts; but the R-union falls a little in places,
/// with a slope of -0.1664 at most, and the local blend may fall with its region.
template <class At>
HWY_NOINLINE Range join_rare_ranges(const TreeStep& step, float threshold, const At& at) {
  const auto value = [&](uint32_t i) { return at(i).value; };
  const auto low = [&](uint32_t i) { return at(i).low; };
  const auto high = [&](uint32_t i) { return at(i).high; };
  if (step.kind == TreeStep::Kind::local_blend) {
    const uint32_t count = step.count - 1;
    const Range& region = at(count);
    return {mix(count, value, region.value), hn::Min(mix(count, low, region.low), mix(count, low, region.high)),
            hn::Max(mix(count, high, region.low), mix(count, high, region.high))};
  }
  const Range &a = at(0), &b = at(1);
  const bool subtracts = step.kind == TreeStep::Kind::difference || step.kind == TreeStep::Kind::r_difference;
  Range r{join_two(step, threshold, a.value, b.value), join_two(step, threshold, a.low, subtracts ? b.high : b.low),
          join_two(step, threshold, a.high, subtracts ? b.low : b.high)};
  const V zero = hn::Zero(k_lanes);
  if (step.kind == TreeStep::Kind::r_union) {
    const auto width = [&](const Range& f) { return hn::Sub(hn::Max(f.high, zero), hn::Max(f.low, zero)); };
    const M is_alone = hn::Or(hn::Le(a.high, zero), hn::Le(b.high, zero));
    const V slack = hn::IfThenZeroElse(is_alone, hn::Mul(set(0.167f), hn::Add(width(a), width(b))));
    r.low = hn::Sub(r.low, slack), r.high = hn::Add(r.high, slack);
  }
  return r;
}

/// The operands at(0), at(1), … joined, those joins that are most of a scene without a call.
template <class At>
HWY_INLINE Range join_ranges(const TreeStep& step, float threshold, const At& at) {
  const auto each = [&](const auto& joined) {
    const Range &a = at(0), &b = at(1);
    return Range{joined(a.value, b.value), joined(a.low, b.low), joined(a.high, b.high)};
  };
  switch (step.kind) {
  case TreeStep::Kind::sum: return each([](V a, V b) { return hn::Add(a, b); });
  case TreeStep::Kind::maximum: return each([](V a, V b) { return hn::Max(a, b); });
  case TreeStep::Kind::minimum: return each([](V a, V b) { return hn::Min(a, b); });
  default: return join_rare_ranges(step, threshold, at);
  }
}

/// Adds a leaf at a place with a velocity, and its bounds on the stretch h either way, to a sum.
HWY_INLINE void add_leaf(const Leaf& leaf, bool is_positive, bool wants_low, bool wants_high, const V3& place, const V3& velocity, V drift,
                         V h, Range& sum) {
  const Offset offset(leaf, place);
  sum.value = hn::Add(sum.value, leaf.potential(square_of_positive(offset.distance())));
  const bool wants_nearest = is_positive ? wants_high : wants_low, wants_farthest = is_positive ? wants_low : wants_high;
  V &with_nearest = is_positive ? sum.high : sum.low, &with_farthest = is_positive ? sum.low : sum.high;
  if (wants_nearest) with_nearest = hn::Add(with_nearest, leaf.potential(square_of_positive(offset.least(velocity, drift, h))));
  if (wants_farthest)
    with_farthest = hn::Add(with_farthest, leaf.potential(square_of_positive(most_distances(leaf, place, velocity, drift, h).most())));
}

/// A field at a place, and its bounds on the stretch around it. They are lines, so that one look tells how far a stretch is clear, and
/// about where it ceases to be. `low` is meant only where the tree asks for it.
struct Slope {
  V value;
  Line high, low;
};

/// The numbers of a potential q^2 (a + b q), q = max(0, 1 - k d^2), with a >= 0 and a + b >= 0, as every falloff has.
struct Bump {
  V k, a, b, crest;

  V closeness(V d) const { return hn::Max(hn::NegMulAdd(k, square_of_positive(d), set(1)), hn::Zero(k_lanes)); }
  V at(V q) const { return hn::Mul(hn::Mul(q, q), hn::MulAdd(b, q, a)); }

  /// Above the potential where the distance is at least what lies on a line. On the line the potential parts from its chord by its
  /// second derivative: -2 k c times the square of the line's slope, c = 15 b q^2 + (6 a - 12 b) q - 4 a. That is largest at the largest q,
  /// or at the crest.
  Line above(const Line& distance) const {
    const Line q{closeness(distance.left), closeness(distance.right)}, ends{at(q.left), at(q.right)};
    const V x = hn::Min(q.most(), crest), linear = hn::MulSub(set(6), a, hn::Mul(set(12), b));
    const V c = hn::MulSub(hn::MulAdd(hn::Mul(set(15), b), x, linear), x, hn::Mul(set(4), a));
    return ends + hn::Mul(scale(distance), hn::Max(c, hn::Zero(k_lanes)));
  }
  /// Below it where the distance is at most what lies on a line.
  Line below(const Line& distance) const {
    const Line ends{at(closeness(distance.left)), at(closeness(distance.right))};
    const V peak = hn::Max(hn::MulSub(set(12), b, hn::Mul(set(6), a)), hn::Zero(k_lanes)); // of -c, where b > 0
    const V c = hn::MulAdd(set(4), a, hn::Div(hn::Mul(peak, peak), hn::Mul(set(60), hn::Max(b, set(1e-30f)))));
    const Line line = ends + hn::Neg(hn::Mul(scale(distance), c));
    const V least = ends.least(); // it is nowhere less than that
    return choose(hn::And(hn::Gt(line.middle(), least), hn::Ge(line.least(), hn::Zero(k_lanes))), line, {least, least});
  }

private:
  V scale(const Line& distance) const {
    const V rise = hn::Mul(set(0.5f), hn::Sub(distance.right, distance.left));
    return hn::Mul(k, hn::Mul(rise, rise));
  }
};

/// Adds the bounds of a potential to those of a sum. `far()`: above the distance; asked for only if it matters.
template <class Far>
HWY_INLINE void add_lines(const Bump& bump, bool is_positive, bool wants_low, const Line& near, const Far& far, Slope& sum) {
  if (is_positive) {
    sum.high = sum.high + bump.above(near);
    if (wants_low) sum.low = sum.low + bump.below(far());
    return;
  }
  const Bump positive{bump.k, hn::Neg(bump.a), hn::Neg(bump.b), bump.crest};
  const auto negative = [](const Line& line) { return Line{hn::Neg(line.left), hn::Neg(line.right)}; };
  sum.high = sum.high + negative(positive.below(far()));
  if (wants_low) sum.low = sum.low + negative(positive.above(near));
}

/// Adds a leaf at a place with a velocity, and its bounds on the stretch h either way, to a sum.
HWY_INLINE void add_leaf(const Leaf& leaf, bool is_positive, bool wants_low, const V3& place, const V3& velocity, V drift, V h,
                         Slope& sum) {
  const Offset offset(leaf, place);
  const V distance = offset.distance(), rise = hn::Mul(offset.rate(velocity), h), near = hn::NegMulAdd(drift, h, distance);
  sum.value = hn::Add(sum.value, leaf.potential(square_of_positive(distance)));
  const auto far = [&] { return most_distances(leaf, place, velocity, drift, h); };
  add_lines({leaf.k, leaf.a, leaf.b, leaf.crest}, is_positive, wants_low, {hn::Sub(near, rise), hn::Add(near, rise)}, far, sum);
}

/// Above an R-union of fields in units of the threshold. It rises with its operands but for a slope of -0.1664 at most; and between two
/// places (a, b) it parts from its chord by less than `bends` / 8 times the square of their distance.
inline Line above_r_union(const Line& a, const Line& b, const Line& least_a, const Line& least_b) {
  const Line all = join_ends(a, b, RFunctions::unite);
  const Line slack = join_ends(a + b, least_a + least_b, [](V most, V least) { return hn::Mul(set(0.167f), hn::Sub(most, least)); });
  const V da = hn::Sub(a.right, a.left), db = hn::Sub(b.right, b.left), over = hn::Sub(hn::Max(a.most(), b.most()), set(1));
  const V bends = hn::MulAdd(set(5), hn::Max(over, hn::Zero(k_lanes)), set(2.6f));
  return all + slack + hn::Mul(hn::Mul(bends, set(0.125f)), hn::MulAdd(da, da, hn::Mul(db, db)));
}

/// The operands at(0), at(1), … joined where a join bends. Where one of two is nothing, the result is exactly the other.
template <class At>
HWY_NOINLINE Slope join_rare_slopes(const TreeStep& step, float threshold, const At& at) {
  using Kind = TreeStep::Kind;
  const Range r = join_rare_ranges(step, threshold, [&](uint32_t i) {
    const Slope& f = at(i);
    return Range{f.value, f.low.least(), f.high.most()};
  });
  Slope s{r.value, {r.high, r.high}, {r.low, r.low}};
  if (step.kind == Kind::local_blend) return s;
  const Slope &a = at(0), &b = at(1);
  const V zero = hn::Zero(k_lanes);
  const auto scaled = [](const Line& l, float factor) { return Line{hn::Mul(l.left, set(factor)), hn::Mul(l.right, set(factor))}; };
  const auto positive = [&](const Line& l) { return Line{hn::Max(l.left, zero), hn::Max(l.right, zero)}; };
  if (step.kind == Kind::r_union) {
    const auto in_units = [&](const Line& l) { return scaled(l, 1 / threshold); };
    const Line high = above_r_union(positive(in_units(a.high)), positive(in_units(b.high)), in_units(a.low), in_units(b.low));
    s.high = choose(hn::Lt(hn::Mul(high.middle(), set(threshold)), r.high), scaled(high, threshold), s.high);
  } else if (step.kind == Kind::hyper_blend && step.exponent >= 1) { // convex
    s.high = join_ends(a.high, b.high, [&](V x, V y) { return join_two(step, threshold, x, y); });
  } else if (step.kind == Kind::difference) { // below each of the two, and clamped: convex again
    const V twice = set(2 * threshold);
    const Line rest{hn::Sub(twice, b.low.left), hn::Sub(twice, b.low.right)};
    s.high = positive(choose(hn::Lt(a.high.most(), rest.most()), a.high, rest));
  }
  if (step.kind == Kind::r_union || step.kind == Kind::hyper_blend) {
    const M only_a = hn::Le(b.high.most(), zero), only_b = hn::Le(a.high.most(), zero);
    s.low = choose(only_a, a.low, choose(only_b, b.low, s.low));
    s.high = choose(only_a, positive(a.high), choose(only_b, positive(b.high), s.high));
  }
  return s;
}

/// The operands at(0), at(1), … joined, those joins that are most of a scene without a call. Unless WantsLow, `low` is left out.
template <bool WantsLow, class At>
HWY_INLINE Slope join_slopes(const TreeStep& step, float threshold, const At& at) {
  const Slope &a = at(0), &b = at(1);
  Slope s;
  switch (step.kind) {
  case TreeStep::Kind::sum:
    s.value = hn::Add(a.value, b.value), s.high = a.high + b.high;
    if constexpr (WantsLow) s.low = a.low + b.low;
    return s;
  case TreeStep::Kind::maximum: // convex: below its chord, and above each of the two
    s.value = hn::Max(a.value, b.value), s.high = join_ends(a.high, b.high, [](V x, V y) { return hn::Max(x, y); });
    if constexpr (WantsLow) s.low = choose(hn::Gt(a.low.middle(), b.low.middle()), a.low, b.low);
    return s;
  case TreeStep::Kind::minimum:
    s.value = hn::Min(a.value, b.value), s.high = choose(hn::Lt(a.high.most(), b.high.most()), a.high, b.high);
    if constexpr (WantsLow) s.low = join_ends(a.low, b.low, [](V x, V y) { return hn::Min(x, y); });
    return s;
  default: break;
  }
  return join_rare_slopes(step, threshold, [&](uint32_t i) {
    Slope f = at(i);
    if constexpr (!WantsLow) f.low = {hn::Zero(k_lanes), hn::Zero(k_lanes)};
    return f;
  });
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
