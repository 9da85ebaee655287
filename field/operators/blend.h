#pragma once

#include "field/operators/operator.h"

namespace kelpie {

template <class Mode>
struct Blend {
  static constexpr std::string_view k_name = "blend";
  static constexpr std::string_view k_doc = R"(The sum of its children: they flow together where they meet.

    f = f_A + f_B + …

Source: methods.md section 2.)";

  typename Mode::Children children;

  static constexpr auto parameters() { return std::tuple{parameter("children", &Blend::children, "the fields to add").required()}; }

  template <class Real>
  Real combine(std::span<const Real> f, double /*threshold*/, Demand /*mine*/) const {
    Real sum = f[0];
    for (const Real& x : f.subspan(1)) sum = sum + x;
    return sum;
  }

  /// What reaches the cell: an operand that is 0 throughout adds nothing.
  void keep(std::span<const Interval> f, double /*threshold*/, Demand /*mine*/, std::span<char> kept) const {
    for (size_t i = 0; i < f.size(); ++i) kept[i] = f[i].lo != 0 || f[i].hi != 0;
  }
  /// A lone operand is the sum; of several, the values matter.
  Demand demand_of_operands(Demand mine, size_t count) const { return count == 1 ? mine : Demand::value; }
  void shares(std::span<const double> f, double /*threshold*/, std::span<double> shares) const { share_by(f, shares); }
};

} // namespace kelpie
