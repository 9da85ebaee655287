#pragma once

#include "field/operators/operator.h"

namespace kelpie {

template <class Mode>
struct Intersection {
  static constexpr std::string_view k_name = "intersection";
  static constexpr std::string_view k_doc = R"(All that is inside every one of its children.

    f = min(f_A, f_B, …)

Creased where the surfaces cross. Source: methods.md section 2.)";

  typename Mode::Children children;

  static constexpr auto parameters() {
    return std::tuple{parameter("children", &Intersection::children, "the fields to intersect").required()};
  }

  template <class Real>
  Real combine(std::span<const Real> f, double /*threshold*/, Demand /*mine*/) const {
    Real least = f[0];
    for (const Real& x : f.subspan(1)) least = min(least, x);
    return least;
  }

  /// An operand that is above another throughout is never the smallest; where only the sign is asked
  /// for, neither is one that is inside throughout.
  void keep(std::span<const Interval> f, double threshold, Demand mine, std::span<char> kept) const {
    double ceiling = std::numeric_limits<double>::infinity();
    for (const Interval& x : f) ceiling = std::min(ceiling, x.hi);
    for (size_t i = 0; i < f.size(); ++i) kept[i] = f[i].lo <= ceiling && !(mine == Demand::sign && f[i].lo > threshold);
    if (std::find(kept.begin(), kept.end(), char(true)) == kept.end()) kept[0] = true; // full: nothing is left, but "inside" must be said
  }
  Demand demand_of_operands(Demand mine, size_t /*count*/) const { return mine; }
};

} // namespace kelpie
