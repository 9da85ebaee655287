// How the first root of a field is found along segments of rays, a segment a lane, by lines above the field. Included once a target.
#if defined(KELPIE_TREE_MARCH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_TREE_MARCH_INL
#undef KELPIE_TREE_MARCH_INL
#else
#define KELPIE_TREE_MARCH_INL
#endif

#include <limits>

#include "renderer/lanes/potentials-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

/// Seeks the first place in [-half, half] where g >= 0, in each lane, by stretches of the lane's own length:
///   while (some lane is live) { const Stretch s = next(); learn(s, g in its middle, a line above g within it, enough); }
/// Up to where the line reaches 0 there is no root, and with its slope Newton's step says where the root may be. There the next stretch
/// is centred, so that what is left of it shrinks quadratically if the line parts from g by the square of the stretch's length.
/// No lane's arithmetic looks at another's.
class TreeMarch {
public:
  struct Stretch {
    V middle, half;
  };

  /// `tiny`: a length within which a root is not told from its neighbours; `negligible`: a value of g that counts as 0.
  TreeMarch(V half, M live, float tiny, float negligible)
      : tiny_(set(tiny)), negligible_(negligible), half_(half), from_(hn::Neg(half)), outside_(set(-k_infinity)), g_outside_(set(-1)),
        inside_(set(k_infinity)), g_inside_(hn::Zero(k_lanes)), step_(hn::Mul(set(0.8f), hn::Max(half, tiny_))), root_(from_), live_(live),
        hit_(no_lanes()) {}

  M live() const { return live_; } ///< lanes without an answer
  M hit() const { return hit_; }
  V root() const { return root_; } ///< of those that hit

  Stretch next() {
    step_ = hn::Max(hn::Min(step_, hn::Sub(half_, from_)), hn::Mul(set(1e-3f), tiny_));
    return {hn::MulAdd(set(0.5f), step_, from_), hn::Mul(set(0.5005f), step_)};
  }

  /// g in the middle of the stretch, and a line above it. Up to `enough` any place inside will do, in place of the first root.
  void learn(const Stretch& stretch, V g, const Line& above, V enough) {
    remember(stretch.middle, g);
    const V rise = hn::Sub(above.right, above.left), slope = hn::Div(rise, hn::Add(stretch.half, stretch.half)), before = from_;
    const M is_clear = hn::Lt(above.most(), set(negligible_));
    leave_behind(stretch, above, slope, is_clear);
    const M rises = hn::Gt(rise, hn::Zero(k_lanes));
    const V newton = hn::IfThenElse(rises, hn::Sub(stretch.middle, hn::Div(g, slope)), set(-k_infinity));
    const Look look{
        stretch.middle, g, above, slope, newton, hn::Sub(newton, from_), rises, is_clear, hn::Not(hn::Lt(g, hn::Zero(k_lanes)))};
    answer(look, enough);
    choose_step(look, before);
  }

private:
  static constexpr float k_infinity = std::numeric_limits<float>::infinity();

  /// What is known of a stretch.
  struct Look {
    V middle, g;
    Line above;
    V slope, newton, ahead; ///< where Newton's step leads, and how far from what is left
    M rises, is_clear, is_inside;
  };

  void remember(V place, V g) {
    const M is_outside = hn::Lt(g, hn::Zero(k_lanes)), is_first = hn::AndNot(is_outside, hn::Lt(place, inside_));
    outside_ = hn::IfThenElse(is_outside, place, outside_), g_outside_ = hn::IfThenElse(is_outside, g, g_outside_);
    inside_ = hn::IfThenElse(is_first, place, inside_), g_inside_ = hn::IfThenElse(is_first, g, g_inside_);
  }

  /// As far as the line is below 0 there is no root.
  void leave_behind(const Stretch& stretch, const Line& above, V slope, M is_clear) {
    const V end = hn::Add(from_, step_), crossing = hn::Sub(hn::Sub(stretch.middle, stretch.half), hn::Div(above.left, slope));
    const M begins_clear = hn::Lt(above.left, hn::Zero(k_lanes));
    from_ = hn::IfThenElse(is_clear, end, hn::IfThenElse(begins_clear, hn::Min(hn::Max(from_, crossing), end), from_));
  }

  M is_bracketed() const { return hn::And(hn::Lt(outside_, inside_), hn::Lt(hn::Sub(inside_, outside_), set(k_infinity))); }
  /// Where the line through the last place outside and the first inside is 0.
  V between() const { return hn::MulAdd(hn::Div(g_outside_, hn::Sub(g_outside_, g_inside_)), hn::Sub(inside_, outside_), outside_); }

  /// Lanes whose root is known, or that have none. Where the line hardly parts from g, the root is Newton's.
  void answer(const Look& look, V enough) {
    const M is_line = hn::And(hn::And(look.rises, hn::Le(step_, hn::Mul(set(8), tiny_))),
                              hn::Le(hn::Sub(look.above.middle(), look.g), hn::Mul(look.slope, hn::Mul(set(0.02f), tiny_))));
    const M is_at_from = hn::And(hn::Lt(look.above.left, set(3 * negligible_)), hn::Lt(look.ahead, hn::Mul(set(0.5f), tiny_)));
    const M is_close = hn::Le(hn::Sub(inside_, from_), tiny_), is_short = hn::Le(step_, hn::Mul(set(0.3f), tiny_));
    const M by_line = hn::And(look.is_inside, hn::And(is_line, is_at_from)), by_bracket = hn::And(is_close, hn::Or(is_line, is_short));
    const M found = hn::And(live_, hn::Or(by_line, by_bracket));
    const M will_do = hn::And(live_, hn::And(look.is_inside, hn::Le(look.middle, enough))), answered = hn::Or(will_do, found);
    const V estimate = hn::IfThenElse(hn::Or(is_line, hn::Not(is_bracketed())), look.newton, between());
    const V at_surface = hn::Min(hn::Max(estimate, from_), inside_);
    root_ = hn::IfThenElse(will_do, look.middle, hn::IfThenElse(found, at_surface, root_));
    hit_ = hn::Or(hit_, answered);
    live_ = hn::AndNot(hn::Or(answered, hn::And(look.is_clear, hn::Ge(from_, half_))), live_);
  }

  /// The next stretch has the root in its middle, or a little before it: Newton's, or that of the line between what is known.
  void choose_step(const Look& look, V before) {
    const M is_ahead = hn::And(hn::Gt(look.ahead, hn::Zero(k_lanes)), hn::Le(look.newton, inside_));
    const V target = hn::IfThenElse(is_ahead, look.newton, hn::IfThenElse(is_bracketed(), between(), set(k_infinity)));
    const V centred = hn::MulAdd(set(2), hn::Sub(target, from_), hn::Mul(set(0.8f), tiny_));
    const M was_worth_it = hn::Gt(hn::Sub(from_, before), hn::Mul(set(0.3f), step_));
    const V half_step = hn::Mul(set(0.5f), step_);
    const V longest = hn::IfThenElse(look.is_clear, hn::Mul(set(32), step_), hn::IfThenElse(was_worth_it, step_, half_step));
    const V blind = hn::IfThenElse(look.is_clear, hn::Mul(set(3), step_), hn::Mul(set(0.4f), step_));
    const M starts_inside =
        hn::And(look.is_inside, hn::And(hn::Le(from_, hn::Neg(half_)), hn::Le(look.ahead, hn::Zero(k_lanes)))); // it may
    step_ = hn::IfThenElse(hn::Lt(target, set(k_infinity)), hn::Min(centred, longest), blind);
    step_ = hn::IfThenElse(starts_inside, hn::Min(step_, tiny_), step_);
  }

  V tiny_;
  float negligible_;
  V half_, from_;         ///< there is no root before `from`
  V outside_, g_outside_; ///< the last place seen outside
  V inside_, g_inside_;   ///< the first place seen inside
  V step_, root_;
  M live_, hit_;
};

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
