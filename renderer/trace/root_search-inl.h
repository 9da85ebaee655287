// The first root of a field along one ray, by lines above it: the lanes are stretches of the ray. Included once a target.
#if defined(KELPIE_ROOT_SEARCH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef KELPIE_ROOT_SEARCH_INL
#undef KELPIE_ROOT_SEARCH_INL
#else
#define KELPIE_ROOT_SEARCH_INL
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "renderer/lanes/potentials-inl.h"

#ifndef KELPIE_ROOT_SEARCH_ONCE
#define KELPIE_ROOT_SEARCH_ONCE
namespace kelpie {

/// How exactly roots are sought.
struct RootTolerance {
  float tiny;       ///< within this length a root is not told from its neighbours
  float least;      ///< a shorter stretch is a point
  float negligible; ///< a value of g that counts as 0
};

} // namespace kelpie
#endif

HWY_BEFORE_NAMESPACE();
namespace kelpie {
namespace HWY_NAMESPACE {

/// g in the middle of a stretch, and a line above it within; a stretch a lane.
struct Look {
  V g;
  Line above;
};

/// So many stretches make a look.
constexpr size_t k_stretches = std::max<size_t>(k_width, 8);

/// Seeks the first place in [-half, half] where g >= 0; look_at(middle, half length) makes a Look of stretches.
/// It looks at some stretches at a time, one after the other, and goes on behind those that are clear: where the line above g
/// stays below 0. It looks into the first that is not clear again, with stretches around the place where Newton's method sees the root;
/// so what is left shrinks quadratically if lines part from g by the square of a stretch's length, and k_stretches-fold in any case.
/// Nothing is missed: a stretch that is never clear ends as points.
template <class LookAt>
class RootSearch {
public:
  RootSearch(const LookAt& look_at, float half, const RootTolerance& tolerance)
      : look_at_(look_at), half_(half), tolerance_(tolerance), from_(-half), step_(2 * half / k_stretches) {}

  bool run(float& root) {
    while (from_ < half_) {
      step_ = std::min(step_, (half_ - from_) / k_stretches);
      look();
      if (unclear_ == 0)
        go_on();
      else if (step_ <= tolerance_.least ? find_among_points(root) : find_root(first(unclear_), root))
        return true;
    }
    return false;
  }

private:
  static size_t first(uint32_t lanes) { return static_cast<size_t>(std::countr_zero(lanes)); }
  float begin(size_t lane) const { return from_ + static_cast<float>(lane) * step_; }
  float middle(size_t lane) const { return begin(lane) + 0.5f * step_; }
  float slope(size_t lane) const { return (right_[lane] - left_[lane]) / (2 * k_half * step_); }
  /// Where Newton's method sees the root from the middle of a stretch, with the slope of the line above.
  float newton(size_t lane) const { return middle(lane) - g_[lane] / slope(lane); }

  void look() {
    unclear_ = inside_ = 0;
    for (size_t i = 0; i < k_stretches; i += k_width) {
      const V lanes = hn::Add(hn::Iota(k_lanes, static_cast<float>(i)), set(0.5f));
      const Look look = look_at_(hn::MulAdd(lanes, set(step_), set(from_)), set(k_half * step_));
      hn::Store(look.g, k_lanes, g_ + i), hn::Store(look.above.left, k_lanes, left_ + i), hn::Store(look.above.right, k_lanes, right_ + i);
      const M is_inside = hn::Ge(look.g, hn::Zero(k_lanes)), is_clear = hn::Lt(look.above.most(), set(tolerance_.negligible));
      inside_ |= bits_of(is_inside) << i, unclear_ |= bits_of(hn::Or(is_inside, hn::Not(is_clear))) << i;
    }
  }

  void go_on() {
    be_outside(k_stretches - 1);
    from_ = begin(k_stretches), step_ *= k_stretches;
  }

  void be_outside(size_t lane) { outside_ = middle(lane), g_outside_ = g_[lane]; }

  /// All are points: the first of them that is inside is the root.
  bool find_among_points(float& root) {
    if (inside_ != 0) {
      root = begin(first(inside_));
      return true;
    }
    from_ = std::max(begin(k_stretches), std::nextafter(from_, half_));
    return false;
  }

  /// The root in the first stretch that is not clear, if it is known by now; else says where to look next.
  bool find_root(size_t lane, float& root) {
    if (is_root_known(lane)) {
      root = std::max(newton(lane), outside_);
      return true;
    }
    const float end = begin(lane + 1), target = newton(lane);
    const bool rises = slope(lane) > 0;
    // As far as the line is below 0 there is no root.
    const float crossing = middle(lane) - k_half * step_ - left_[lane] / slope(lane);
    from_ = begin(lane);
    if (rises && left_[lane] < 0) from_ = std::min(std::max(from_, crossing), end);
    const bool is_ahead = rises && target > from_ && target < end;
    const float whole = end - from_, centred = 2 * (target - from_) + 0.8f * tolerance_.tiny;
    step_ = std::max((is_ahead ? std::min(centred, whole) : whole) / k_stretches, 0.5f * tolerance_.least);
    return false;
  }

  /// Whether Newton's place is the root: it lies between a place outside and the next, which is inside; the line above hardly parts from
  /// g; and the line through the two places says the same.
  bool is_root_known(size_t lane) {
    const size_t next_inside = inside_ == 0 ? k_stretches : first(inside_);
    if (next_inside > 0) be_outside(std::min(next_inside - 1, lane));
    if (next_inside > lane + 1 || next_inside == k_stretches || !(slope(lane) > 0)) return false;
    const float inside = middle(next_inside), root = newton(lane);
    if (std::isinf(outside_) || outside_ >= inside || root > inside) return false;
    const float secant = outside_ + (inside - outside_) * (g_outside_ / (g_outside_ - g_[next_inside]));
    const float gap = 0.5f * (left_[lane] + right_[lane]) - g_[lane], error = std::abs(root - secant) * slope(lane);
    return std::max(gap, error) <= std::max(0.02f * tolerance_.tiny * slope(lane), 0.1f * tolerance_.negligible);
  }

  /// Of a stretch's length, half of it: stretches overlap a little.
  static constexpr float k_half = 0.5005f;

  const LookAt& look_at_;
  float half_;
  RootTolerance tolerance_;
  float from_, step_; ///< there is no root before `from`; the length of the next stretches
  float outside_ = -std::numeric_limits<float>::infinity(), g_outside_ = -1; ///< the last place seen outside
  // Of the latest look:
  alignas(64) float g_[k_stretches], left_[k_stretches], right_[k_stretches];
  uint32_t unclear_ = 0, inside_ = 0; ///< lanes that are not clear; that are inside in their middle
};

} // namespace HWY_NAMESPACE
} // namespace kelpie
HWY_AFTER_NAMESPACE();

#endif
