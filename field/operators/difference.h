#pragma once

#include "field/operators/operator.h"

namespace kelpie {

template <class Mode>
struct Difference {
  static constexpr std::string_view k_name = "difference";
  static constexpr std::string_view k_doc = R"(The first child without the others.

    f = max(0, min(f_A, 2T - f_B, 2T - f_C, …)),   T the threshold of the shape

Clamped at 0, because below 0 it would spoil a blend above it. Source: methods.md section 2.)";

  typename Mode::Children children;

  static constexpr auto parameters() {
    return std::tuple{parameter("children", &Difference::children, "what to carve, then what to carve away").required()};
  }

  static constexpr bool k_is_clamped = true;
  static constexpr bool k_scales_with_threshold = true;

  template <class Real>
  Real combine(std::span<const Real> f, double threshold, Demand /*mine*/) const {
    Real least = f[0];
    for (const Real& x : f.subspan(1)) least = min(least, Real(2 * threshold) - x);
    return max(Real(0.0), least);
  }

  /// What is carved away is dropped where it does not reach: under `sign` where it is outside
  /// throughout, under `value` where 2T - f_B is never below f_A.
  void keep(std::span<const Interval> f, double threshold, Demand mine, std::span<char> kept) const {
    kept[0] = true;
    for (size_t i = 1; i < f.size(); ++i) {
      const bool outside = mine == Demand::sign && f[i].hi < threshold;
      kept[i] = !(outside || 2 * threshold - f[i].hi >= f[0].hi);
    }
  }
  Demand demand_of_operands(Demand mine, size_t /*count*/) const { return mine; }
};

} // namespace kelpie
