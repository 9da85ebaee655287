// What moves while the shutter is open: kinds between two states.
//
// Within a slab of time every number of a kind is interpolated linearly between its values at both ends, and whatever is
// said of the slab holds for all states between.
#pragma once

#include <span>

#include "base/kind.h"
#include "base/vec.h"
#include "field/operators/operator.h"

namespace kelpie {

inline float interpolate(float a, float b, double u) { return a + (b - a) * static_cast<float>(u); }
inline Vec3 interpolate(const Vec3& a, const Vec3& b, double u) { return a + (b - a) * static_cast<float>(u); }

/// As many as both have.
inline std::vector<Vec3> interpolate(std::vector<Vec3> a, const std::vector<Vec3>& b, double u) {
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) a[i] = interpolate(a[i], b[i], u);
  return a;
}

/// Calls visit(row) for every parameter of a sampled kind that is a number or a list of places, and so may move.
template <class Kind, class Visit>
void for_each_number(Visit&& visit) {
  const auto one = [&](const auto& row) {
    using T = std::decay_t<decltype(std::declval<Kind>().*(row.member))>;
    if constexpr (std::is_same_v<T, float> || std::is_same_v<T, Vec3> || std::is_same_v<T, std::vector<Vec3>>) visit(row);
  };
  std::apply([&](const auto&... rows) { (one(rows), ...); }, Kind::parameters());
}

/// The numbers of `out` between a (u = 0) and b (u = 1); all else in it stays.
template <class Kind>
void interpolate(const Kind& a, const Kind& b, double u, Kind& out) {
  for_each_number<Kind>([&](const auto& row) { out.*(row.member) = interpolate(a.*(row.member), b.*(row.member), u); });
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
  for_each_number<Kind>([&](const auto& row) { same = same && a.*(row.member) == b.*(row.member); });
  return same;
}

/// Bounds what an operator makes of its operands, for all states between a and b and all thresholds.
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
  return is_same(a, b) ? at(a) : hull(at(a), at(b));
}

} // namespace kelpie
