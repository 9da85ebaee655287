// Two nodes of one kind, mixed.
#pragma once

#include <limits>
#include <optional>

#include "base/time_map.h"
#include "morph/field_node.h"
#include "morph/tree/computed.h"

namespace kelpie {

namespace detail {
template <class T>
constexpr bool k_is_edge = IsEdge<T> || IsMaterialEdge<T>;
template <class T>
constexpr bool k_is_edge<std::vector<T>> = IsEdge<T>;

/// Whether two values have the same signs, by components.
bool have_equal_signs(const Animated<float>& a, const Animated<float>& b);
bool have_equal_signs(const Animated<Vec3>& a, const Animated<Vec3>& b);
template <class T>
bool have_equal_signs(const T&, const T&) {
  return true;
}

/// Whether any number will do.
constexpr bool is_unlimited(const Range& r) {
  return r.lower == -std::numeric_limits<double>::infinity() && r.upper == std::numeric_limits<double>::infinity() && !r.without_zero;
}

/// Whether lists are as long in both, and what may be left out is there in both or in none.
template <class Kind>
bool have_one_form(const Kind& a, const Kind& b) {
  bool is_one = true;
  const auto row = [&]<class T>(const T& x, const T& y) {
    if constexpr (IsList<T> && !k_is_edge<T>) {
      is_one &= x.size() == y.size();
      if constexpr (Record<typename ListTrait<T>::Element>)
        for (size_t i = 0; is_one && i < x.size(); ++i) is_one &= have_one_form(x[i], y[i]);
    }
    if constexpr (IsOptional<T>) is_one &= x.has_value() == y.has_value();
  };
  std::apply([&](const auto&... r) { (row(a.*(r.member), b.*(r.member)), ...); }, k_table<Kind>);
  return is_one;
}
} // namespace detail

/// Mixes every number of a record that may move into those of `a`: a at s = 0, b at s = 1; directions turn. Where s leaves [0, 1]
/// directions and what may be any number go on beyond the ends; all else is held. Children and materials stay those of a, and so does its
/// falloff. False where the two differ in anything else: a file, the length of a list, how a curve is made, the sign of what is never 0.
template <class Kind>
bool mix_numbers(Kind& a, const Kind& b, const Animated<float>& s) {
  if (!detail::have_one_form(a, b)) return false;
  bool is_good = true;
  const auto one = [&]<class T>(const ParameterRules& rules, T& x, const T& y) {
    if (rules.range.without_zero) is_good &= detail::have_equal_signs(x, y); // else it is 0 on the way
    if constexpr (IsAnimated<T>) {
      using Value = typename AnimatedTrait<T>::Value;
      const auto mix = [&] { return detail::is_unlimited(rules.range) ? overshooting<Value>(x, y, s) : mixed<Value>(x, y, s); };
      if constexpr (std::is_same_v<Value, Vec3>)
        x = rules.is_nonzero ? turned(x, y, s) : mix();
      else
        x = mix();
    }
    if constexpr (std::is_same_v<T, PartReference>)
      is_good = false; // nobody mixes instances
    else if constexpr (!IsAnimated<T> && !detail::k_is_edge<T> && !std::is_same_v<T, Falloff>)
      is_good &= x == y;
  };
  for_each_value(one, a, b);
  if constexpr (HasAssets<Kind>) std::apply([&](const auto... member) { is_good &= (... && (a.*member == b.*member)); }, Kind::assets());
  return is_good;
}

/// A node without its place in a tree.
using AnimatedKind = FieldKinds::Variant<AnimatedMode>;

/// Two nodes of one kind by mix_numbers(); none where that cannot be.
std::optional<AnimatedKind> mixed_kind(const AnimatedKind& a, const AnimatedKind& b, const Animated<float>& s);

/// Gives two nodes of one kind lists of equal lengths, where that changes neither: corners of hulls are repeated, one radius for all
/// becomes one for each; limbs of other curves, numbers of points or details become cubic Bézier curves of as many pieces, which are
/// expanded within the finer detail.
void make_comparable(AnimatedKind& a, AnimatedKind& b);

/// The same with each of its numbers at another time.
AnimatedKind retimed_kind(AnimatedKind kind, const TimeMap& time);

} // namespace kelpie
