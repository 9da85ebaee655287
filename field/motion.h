// What moves while the shutter is open: kinds between two states.
//
// Within a slab of time every number of a kind is interpolated linearly between its values at both ends, and whatever is
// said of the slab holds for all states between.
#pragma once

#include <span>

#include "base/table.h"
#include "base/vec.h"
#include "field/operators/operator.h"

namespace kelpie {

inline float interpolate(float a, float b, double u) { return a + (b - a) * static_cast<float>(u); }
inline Vec3 interpolate(const Vec3& a, const Vec3& b, double u) { return a + (b - a) * static_cast<float>(u); }

/// The types of parameters that move: numbers, alone or in lists and records.
template <class T>
concept Moves = std::is_same_v<T, float> || std::is_same_v<T, Vec3>;
/// Those that are the same at all times.
template <class T>
concept Stands = std::is_same_v<T, bool> || std::is_same_v<T, int> || std::is_same_v<T, double> || std::is_enum_v<T> ||
    std::is_same_v<T, std::string> || std::is_same_v<T, SampledMode::File> || IsEdge<T> || IsMaterialEdge<T>;

/// Calls visit(numbers…) for every number of some sampled kinds of one type that may move, in step.
template <class Visit, class Kind, class... Others>
void for_each_number(Visit&& visit, Kind& first, Others&... others) {
  const auto one = [&]<class T>(const ParameterRules&, T& number, auto&... more) {
    using Plain = std::remove_const_t<T>;
    static_assert(Moves<Plain> || Stands<Plain>, "say above whether the new type moves");
    if constexpr (Moves<Plain>) visit(number, more...);
  };
  for_each_value(one, first, others...);
}

/// The numbers of `out` between a (u = 0) and b (u = 1); all else in it stays.
template <class Kind>
void interpolate(const Kind& a, const Kind& b, double u, Kind& out) {
  for_each_number([&](const auto& x, const auto& y, auto& z) { z = interpolate(x, y, u); }, a, b, out);
}
template <class Kind>
Kind interpolated(const Kind& a, const Kind& b, double u) {
  Kind out = a;
  interpolate(a, b, u, out);
  return out;
}

template <class Kind>
bool is_same(const Kind& a, const Kind& b) {
  bool same = true;
  for_each_number([&](const auto& x, const auto& y) { same = same && x == y; }, a, b);
  return same;
}

/// Bounds what an operator makes of its operands, for all states between a and b and all thresholds. One whose values are not always
/// between those of both states, and scale with the threshold, has `Interval combine_until(b, f, threshold, mine) const`.
template <class Kind>
Interval moving_combine(const Kind& a, const Kind& b, std::span<const Interval> f, Interval threshold, Demand mine) {
  const auto at = [&](const Kind& kind) {
    if constexpr (requires { kind.scales_with_threshold(mine); })
      if (kind.scales_with_threshold(mine) && threshold.width() > 0) {
        std::vector<Interval> scaled;
        for (const Interval& x : f) scaled.push_back(x / threshold);
        return kind.combine(std::span<const Interval>(scaled), 1.0, mine) * threshold;
      }
    return kind.combine(f, threshold.hi, mine);
  };
  if (is_same(a, b)) return at(a);
  if constexpr (requires { a.combine_until(b, f, 1.0, mine); }) {
    std::vector<Interval> scaled;
    for (const Interval& x : f) scaled.push_back(x / threshold);
    return a.combine_until(b, scaled, 1.0, mine) * threshold;
  } else {
    return hull(at(a), at(b));
  }
}

} // namespace kelpie
