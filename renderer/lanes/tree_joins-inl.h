// The operators of trees in SIMD lanes, and the walk through a tree. Lanes are places along a ray, rays, or parts of a box. Included once
// a target.
#if defined(KELPIE_TREE_JOINS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_TREE_JOINS_INL
#undef KELPIE_TREE_JOINS_INL
#else
#define KELPIE_TREE_JOINS_INL
#endif

#include <cstddef>
#include <hwy/contrib/math/math-inl.h>
#include <new>

#include "renderer/lanes/potentials-inl.h"
#include "renderer/lanes/tree_view.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

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
inline HWY_NOINLINE V hyper_blend(float exponent, V a, V b) {
  const V zero = hn::Zero(k_lanes), least = set(std::numeric_limits<float>::min()), m = hn::Max(hn::Max(a, b), zero);
  if (hn::AllTrue(k_lanes, hn::Le(hn::Min(a, b), zero))) return m; // mostly: the fields overlap in a few places only
  const V ratio = hn::Div(hn::Max(hn::Min(a, b), zero), hn::Max(m, least));
  const V power = hn::Exp(k_lanes, hn::Mul(set(exponent), hn::Log(k_lanes, hn::Max(ratio, least))));
  const V factor = hn::Exp(k_lanes, hn::Mul(set(1 / exponent), hn::Log1p(k_lanes, power)));
  return hn::Mul(m, hn::IfThenElse(hn::Gt(ratio, least), factor, set(1)));
}

/// The sum of some fields where `region` is 1, the largest where it is 0.
template <class At>
V mix(uint32_t count, const At& at, V region) {
  V most = at(0), sum = most;
  for (uint32_t i = 1; i < count; ++i) most = hn::Max(most, at(i)), sum = hn::Add(sum, at(i));
  return hn::MulAdd(hn::Min(hn::Max(region, hn::Zero(k_lanes)), set(1)), hn::Sub(sum, most), most);
}

/// The values at(0), at(1), … joined. Where one of two is 0, the R-functions are exactly what they should be: as if the step were
/// not there.
template <class At>
HWY_INLINE V join_values(const TreeStep& step, float threshold, const At& at) {
  const V zero = hn::Zero(k_lanes), t = set(threshold), twice = set(2 * threshold), a = at(0), b = at(1);
  const auto in_units = [&](V f) { return hn::Mul(hn::Max(f, zero), set(1 / threshold)); };
  switch (step.join) {
  case Join::sum: return hn::Add(a, b);
  case Join::maximum: return hn::Max(a, b);
  case Join::minimum: return hn::Min(a, b);
  case Join::difference: return hn::Max(zero, hn::Min(a, hn::Sub(twice, b)));
  case Join::r_union: {
    const M only_b = hn::Le(a, zero), only_a = hn::Le(b, zero);
    const V alone = hn::IfThenElse(only_b, hn::Max(b, zero), a);
    if (hn::AllTrue(k_lanes, hn::Or(only_a, only_b))) return alone; // mostly: the fields overlap in a few places only
    return hn::IfThenElse(hn::Or(only_a, only_b), alone, hn::Mul(t, RFunctions::unite(in_units(a), in_units(b))));
  }
  case Join::r_intersection:
    return hn::IfThenZeroElse(hn::Or(hn::Le(a, zero), hn::Le(b, zero)), hn::Mul(t, RFunctions::intersect(in_units(a), in_units(b))));
  case Join::r_difference:
    return hn::IfThenZeroElse(hn::Le(a, zero), hn::Mul(t, RFunctions::intersect(in_units(a), in_units(hn::Sub(twice, b)))));
  case Join::hyper_blend: return hyper_blend(step.exponent, a, b);
  case Join::local_blend: return mix(step.count - 1, at, at(step.count - 1));
  }
  return zero;
}

/// The ranges at(0), at(1), … joined. Every join rises with its operands, or falls with what it subtracts; but the R-union falls a
/// little in places, with a slope of -0.1664 at most, and the local blend may fall with its region.
template <class At>
HWY_NOINLINE Range join_rare_ranges(const TreeStep& step, float threshold, const At& at) {
  const auto joined = [&](const auto& end) { return join_values(step, threshold, end); };
  const auto falls_with = [&](uint32_t i) { return i > 0 && subtracts(step.join); };
  Range r{joined([&](uint32_t i) { return at(i).value; }), joined([&](uint32_t i) { return falls_with(i) ? at(i).high : at(i).low; }),
          joined([&](uint32_t i) { return falls_with(i) ? at(i).low : at(i).high; })};
  const V zero = hn::Zero(k_lanes);
  if (step.join == Join::local_blend) {
    const auto is_region = [&](uint32_t i) { return i + 1 == step.count; };
    r.low = hn::Min(r.low, joined([&](uint32_t i) { return is_region(i) ? at(i).high : at(i).low; }));
    r.high = hn::Max(r.high, joined([&](uint32_t i) { return is_region(i) ? at(i).low : at(i).high; }));
  } else if (step.join == Join::r_union) {
    const Range &a = at(0), &b = at(1);
    const auto width = [&](const Range& f) { return hn::Sub(hn::Max(f.high, zero), hn::Max(f.low, zero)); };
    const M is_alone = hn::Or(hn::Le(a.high, zero), hn::Le(b.high, zero));
    const V slack = hn::IfThenZeroElse(is_alone, hn::Mul(set(0.167f), hn::Add(width(a), width(b))));
    r.low = hn::Sub(r.low, slack), r.high = hn::Add(r.high, slack);
  }
  return r;
}

/// The same, those joins that are most of a scene without a call.
template <class At>
HWY_INLINE Range join_ranges(const TreeStep& step, float threshold, const At& at) {
  const auto each = [&](const auto& joined) {
    const Range &a = at(0), &b = at(1);
    return Range{joined(a.value, b.value), joined(a.low, b.low), joined(a.high, b.high)};
  };
  if (step.join == Join::sum) return each([](V a, V b) { return hn::Add(a, b); });
  if (step.join == Join::maximum) return each([](V a, V b) { return hn::Max(a, b); });
  if (step.join == Join::minimum) return each([](V a, V b) { return hn::Min(a, b); });
  return join_rare_ranges(step, threshold, at);
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

/// Slopes joined where a join bends: lines where it is known how far it bends, else the ends of its range. Where one of two is nothing,
/// the result is exactly the other.
inline HWY_NOINLINE Slope join_rare_slopes(const TreeStep& step, float threshold, const Slope* operands) {
  const Range r = join_rare_ranges(step, threshold, [&](uint32_t i) {
    const Slope& f = operands[i];
    return Range{f.value, f.low.least(), f.high.most()};
  });
  Slope s{r.value, {r.high, r.high}, {r.low, r.low}};
  const Slope &a = operands[0], &b = operands[1];
  const V zero = hn::Zero(k_lanes);
  const auto scaled = [](const Line& l, float factor) { return Line{hn::Mul(l.left, set(factor)), hn::Mul(l.right, set(factor))}; };
  const auto positive = [&](const Line& l) { return Line{hn::Max(l.left, zero), hn::Max(l.right, zero)}; };
  const auto be_the_other_of_nothing = [&] {
    const M only_a = hn::Le(b.high.most(), zero), only_b = hn::Le(a.high.most(), zero);
    s.low = choose(only_a, a.low, choose(only_b, b.low, s.low));
    s.high = choose(only_a, positive(a.high), choose(only_b, positive(b.high), s.high));
  };
  switch (step.join) {
  case Join::r_union: {
    const auto in_units = [&](const Line& l) { return scaled(l, 1 / threshold); };
    const Line high = above_r_union(positive(in_units(a.high)), positive(in_units(b.high)), in_units(a.low), in_units(b.low));
    s.high = choose(hn::Lt(hn::Mul(high.middle(), set(threshold)), r.high), scaled(high, threshold), s.high);
    be_the_other_of_nothing();
    break;
  }
  case Join::hyper_blend:
    if (step.exponent >= 1) s.high = join_ends(a.high, b.high, [&](V x, V y) { return hyper_blend(step.exponent, x, y); }); // convex
    be_the_other_of_nothing();
    break;
  case Join::difference: { // below each of the two, and clamped: convex again
    const V twice = set(2 * threshold);
    const Line rest{hn::Sub(twice, b.low.left), hn::Sub(twice, b.low.right)};
    s.high = positive(choose(hn::Lt(a.high.most(), rest.most()), a.high, rest));
    break;
  }
  case Join::sum:
  case Join::maximum:
  case Join::minimum:
  case Join::r_intersection:
  case Join::r_difference:
  case Join::local_blend: break;
  }
  return s;
}

/// Makes operands[0] what a step makes of its operands, those joins that are most of a scene without a call. Unless WantsLow, `low` is
/// left out.
template <bool WantsLow>
HWY_INLINE void join_slopes(const TreeStep& step, float threshold, Slope* operands) {
  Slope& a = operands[0];
  const Slope& b = operands[1];
  if (step.join == Join::sum) {
    a.value = hn::Add(a.value, b.value), a.high = a.high + b.high;
    if constexpr (WantsLow) a.low = a.low + b.low;
  } else if (step.join == Join::maximum) { // convex: below its chord, and above each of the two
    a.value = hn::Max(a.value, b.value), a.high = join_ends(a.high, b.high, [](V x, V y) { return hn::Max(x, y); });
    if constexpr (WantsLow) a.low = choose(hn::Gt(a.low.middle(), b.low.middle()), a.low, b.low);
  } else if (step.join == Join::minimum) {
    a.value = hn::Min(a.value, b.value), a.high = choose(hn::Lt(a.high.most(), b.high.most()), a.high, b.high);
    if constexpr (WantsLow) a.low = join_ends(a.low, b.low, [](V x, V y) { return hn::Min(x, y); });
  } else {
    for (uint32_t i = 0; i < step.count && !WantsLow; ++i) operands[i].low = {hn::Zero(k_lanes), hn::Zero(k_lanes)};
    a = join_rare_slopes(step, threshold, operands);
  }
}

/// Computes a tree. push(step, value) says what leaves or a solid are; join(step, operands) makes operands[0] what the operator makes
/// of operands[0], operands[1], ….
template <class Value, class Push, class JoinOperands>
HWY_INLINE Value fold_tree(std::span<const TreeStep> steps, const Push& push, const JoinOperands& join) {
  alignas(Value) std::byte memory[(k_tree_depth + 1) * sizeof(Value)]; // a value is made when it is pushed: most trees are shallow
  Value* const stack = new (memory) Value;
  *stack = Value{}; // there is always a step, but compilers do not know
  size_t depth = 0;
  for (const TreeStep& step : steps) {
    if (step.kind == TreeStep::Kind::join) {
      depth -= step.count - 1;
      join(step, stack + depth - 1);
    } else {
      push(step, *new (stack + depth++) Value);
    }
  }
  return stack[0];
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
