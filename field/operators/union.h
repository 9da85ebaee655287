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

  static constexpr bool k_is_clamped = true;
  bool scales_with_threshold(Demand mine) const { return is_smooth(formula, mine); }

  template <class Real>
  Real combine(std::span<const Real> f, double threshold, Demand mine) const {
    if (is_smooth(formula, mine)) return r_function::fold<r_function::Unite>(f, threshold);
    Real most = f[0];
    for (const Real& x : f.subspan(1)) most = max(most, x);
    return most;
  }

  /// Where only the sign is asked for, an operand that is below another throughout decides nothing, nor does one that is
  /// outside throughout. For the value: the largest of all needs no other; an R-function needs whatever is above 0.
  void keep(std::span<const Interval> f, double threshold, Demand mine, std::span<char> kept) const {
    double floor = -std::numeric_limits<double>::infinity();
    for (const Interval& x : f) floor = std::max(floor, x.lo);
    for (size_t i = 0; i < f.size(); ++i)
      kept[i] = mine == Demand::sign ? f[i].hi >= floor && f[i].hi >= threshold : is_smooth(formula, mine) ? f[i].hi > 0 : f[i].hi >= floor;
  }
  Demand demand_of_operands(Demand mine, size_t /*count*/) const { return mine; }
};

} // namespace kelpie
