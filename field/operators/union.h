#pragma once

#include "field/operators/operator.h"

namespace kelpie {

template <class Mode>
struct Union {
  static constexpr std::string_view k_name = "union";
  static constexpr std::string_view k_doc = R"(All that is inside one of its children.

    f = max(f_A, f_B, …)

Creased where the surfaces cross. Source: methods.md section 2.)";

  typename Mode::Children children;

  static constexpr auto parameters() { return std::tuple{parameter("children", &Union::children, "the fields to unite").required()}; }

  template <class Real>
  Real combine(std::span<const Real> f, double /*threshold*/, Demand /*mine*/) const {
    Real most = f[0];
    for (const Real& x : f.subspan(1)) most = max(most, x);
    return most;
  }

  /// An operand that is below another throughout is never the largest; where only the sign is asked
  /// for, neither is one that is outside throughout.
  void keep(std::span<const Interval> f, double threshold, Demand mine, std::span<char> kept) const {
    double floor = -std::numeric_limits<double>::infinity();
    for (const Interval& x : f) floor = std::max(floor, x.lo);
    for (size_t i = 0; i < f.size(); ++i) kept[i] = f[i].hi >= floor && !(mine == Demand::sign && f[i].hi < threshold);
  }
  Demand demand_of_operands(Demand mine, size_t /*count*/) const { return mine; }
};

} // namespace kelpie
