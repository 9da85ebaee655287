#pragma once

#include "field/operators/boolean.h"

namespace kelpie {

template <class Mode>
struct Intersection {
  static constexpr std::string_view k_name = "intersection";
  static constexpr std::string_view k_doc = R"(All that is inside every one of its children.

    sharp    f = min(f_A, f_B, …)
    smooth   f = T + (a + b - sqrt(a^2 + b^2)) / (2 + sqrt 2),   a = f_A - T, b = f_B - T, T the threshold of the shape

Both have the same surface, creased where the children's surfaces cross. The sharp field has creases off the surface too,
which a blend above it would show; so below a blend the smooth one is taken, an R-function in a localised form, which is 0
where a child is. Negative values count as 0 in it, and several children are joined from the first to the last.
Source: methods.md section 2.)";

  BooleanFormula formula = BooleanFormula::automatic;
  typename Mode::Children children;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("formula", &Intersection::formula, k_formula_doc),
        parameter("children", &Intersection::children, "the fields to intersect").required(),
    };
  }

  static constexpr Lone k_lone = Lone::above_0;
  static constexpr ExtentOf k_extent = ExtentOf::all_children;
  bool scales_with_threshold(Demand mine) const { return is_smooth(formula, mine); }

  template <class Real>
  Real combine(std::span<const Real> f, double threshold, Demand mine) const {
    if (is_smooth(formula, mine)) return r_function::fold<r_function::Intersect>(f, threshold);
    Real least = f[0];
    for (const Real& x : f.subspan(1)) least = min(least, x);
    return least;
  }

  /// Where only the sign is asked for, an operand that is above another throughout decides nothing, nor does one that is
  /// inside throughout. For the value: the smallest of all needs no other; an R-function needs all, and an operand that does
  /// not reach is the constant 0 in it.
  void keep(std::span<const Interval> f, double threshold, Demand mine, std::span<char> kept) const {
    double ceiling = std::numeric_limits<double>::infinity();
    for (const Interval& x : f) ceiling = std::min(ceiling, x.hi);
    for (size_t i = 0; i < f.size(); ++i)
      kept[i] = mine == Demand::sign ? f[i].lo <= ceiling && f[i].lo <= threshold : is_smooth(formula, mine) || f[i].lo <= ceiling;
    if (std::find(kept.begin(), kept.end(), char(true)) == kept.end()) kept[0] = true; // full: nothing is left, but "inside" must be said
  }
  Demand demand_of_operands(Demand mine, size_t /*count*/) const { return mine; }
  void shares(std::span<const double> f, double /*threshold*/, std::span<double> shares) const {
    share_all_to(static_cast<size_t>(std::min_element(f.begin(), f.end()) - f.begin()), shares);
  }
};

} // namespace kelpie
