#pragma once

#include "field/operators/boolean.h"

namespace kelpie {

template <class Mode>
struct Union {
  static constexpr std::string_view k_name = "union";
  static constexpr std::string_view k_doc = R"(All that is inside one of its children.

    sharp    f = max(f_A, f_B, …)
    smooth   f = T + (a + b + sqrt(a^2 + b^2)) / (2 - sqrt 2),   a = f_A - T, b = f_B - T, T the threshold of the shape

Both have the same surface, creased where the children's surfaces cross. The sharp field has creases off the surface too,
which a blend above it would show; so below a blend the smooth one is taken, an R-function in a localised form, which is f_A
where f_B is 0. Negative values count as 0 in it, and several children are joined from the first to the last.
Source: methods.md section 2.)";

  BooleanFormula formula = BooleanFormula::automatic;
  typename Mode::Children children;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("formula", &Union::formula, k_formula_doc),
        parameter("children", &Union::children, "the fields to unite").required(),
    };
  }

  static constexpr Lone k_lone = Lone::above_0;
  bool scales_with_threshold(Demand mine) const { return is_smooth(formula, mine); }

  template <class Real>
  Real combine(std::span<const Real> f, double threshold, Demand mine) const {
    if (is_smooth(formula, mine)) return r_function::fold<r_function::Unite>(f, threshold);
    Real most = f[0];
    for (const Real& x : f.subspan(1)) most = max(most, x);
    return most;
  }

  /// An operand that is nowhere above another is not needed beside it (of many that do not reach the cell, none beside one
  /// that may); where only the sign is asked for, neither is one that is outside throughout. The value of an R-function needs
  /// whatever is above 0.
  void keep(std::span<const Interval> f, double threshold, Demand mine, std::span<char> kept) const {
    const bool is_sign = mine == Demand::sign, is_r_function = !is_sign && is_smooth(formula, mine);
    size_t best = 0; // of the largest lower ends
    for (size_t i = 1; i < f.size(); ++i)
      if (f[i].lo > f[best].lo || (f[i].lo == f[best].lo && f[i].hi > f[best].hi)) best = i;
    for (size_t i = 0; i < f.size(); ++i)
      kept[i] = is_r_function ? f[i].hi > 0 : (i == best || f[i].hi > f[best].lo) && !(is_sign && f[i].hi < threshold);
  }
  Demand demand_of_operands(Demand mine, size_t /*count*/) const { return mine; }
  void shares(std::span<const double> f, double /*threshold*/, std::span<double> shares) const {
    share_all_to(static_cast<size_t>(std::max_element(f.begin(), f.end()) - f.begin()), shares);
  }
};

} // namespace kelpie
