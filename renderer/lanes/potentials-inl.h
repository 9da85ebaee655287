// Fields along a stretch of a ray in SIMD lanes: their bounds as numbers and as lines, and those of potentials. Included once a target.
#if defined(KELPIE_POTENTIALS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_POTENTIALS_INL
#undef KELPIE_POTENTIALS_INL
#else
#define KELPIE_POTENTIALS_INL
#endif

#include "renderer/lanes/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

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
template <class Function>
Line join_ends(const Line& a, const Line& b, const Function& f) {
  return {f(a.left, b.left), f(a.right, b.right)};
}

/// A field at a place, and its bounds around it; of these only those that the tree asks for are meant.
struct Range {
  V value, low, high;
};

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

  Bump negated() const { return {k, hn::Neg(a), hn::Neg(b), crest}; }

private:
  V scale(const Line& distance) const {
    const V rise = hn::Mul(set(0.5f), hn::Sub(distance.right, distance.left));
    return hn::Mul(k, hn::Mul(rise, rise));
  }
};

/// The numbers of a potential a - b d, but at least `low` and at most `high` (which may be infinite), with b >= 0.
struct Ramp {
  V a, b, low, high;

  V at(V distance) const { return hn::Min(hn::Max(hn::NegMulAdd(b, distance, a), low), high); }

  /// Above the potential where the distance is at least what lies on a line. Cut off below it is convex, and so lies below its chord.
  Line above(const Line& distance) const {
    const Line raised = join_ends(linear(distance), {low, low}, [](V x, V y) { return hn::Max(x, y); });
    return choose(hn::Ge(raised.least(), high), {high, high}, raised);
  }
  /// Below it where the distance is at most what lies on a line. Cut off above it is concave.
  Line below(const Line& distance) const {
    const Line capped = join_ends(linear(distance), {high, high}, [](V x, V y) { return hn::Min(x, y); });
    return choose(hn::Gt(capped.middle(), low), capped, {low, low});
  }

  Ramp negated() const { return {hn::Neg(a), hn::Neg(b), hn::Neg(high), hn::Neg(low)}; }

private:
  Line linear(const Line& d) const { return {hn::NegMulAdd(b, d.left, a), hn::NegMulAdd(b, d.right, a)}; }
};

/// Adds the bounds of a potential to those of a sum. `far()`: above the distance; asked for only if it matters.
template <class Potential, class Far>
HWY_INLINE void add_lines(const Potential& potential, bool is_positive, bool wants_low, const Line& near, const Far& far, Slope& sum) {
  if (is_positive) {
    sum.high = sum.high + potential.above(near);
    if (wants_low) sum.low = sum.low + potential.below(far());
    return;
  }
  const Potential positive = potential.negated();
  const auto negative = [](const Line& line) { return Line{hn::Neg(line.left), hn::Neg(line.right)}; };
  sum.high = sum.high + negative(positive.below(far()));
  if (wants_low) sum.low = sum.low + negative(positive.above(near));
}

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
