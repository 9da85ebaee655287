#pragma once

#include "field/operators/boolean.h"

namespace kelpie {

template <class Mode>
struct Difference {
  static constexpr std::string_view k_name = "difference";
  static constexpr std::string_view k_doc = R"(The first child without the others.

    sharp    f = max(0, min(f_A, 2T - f_B, 2T - f_C, …)),   T the threshold of the shape
    smooth   f = the smooth `intersection` of f_A, 2T - f_B, 2T - f_C, …

Clamped at 0, because below 0 it would spoil a blend above it. Both have the same surface; below a blend the smooth one is
taken, whose field has no crease off the surface. Source: methods.md section 2.)";

  BooleanFormula formula = BooleanFormula::automatic;
  typename Mode::Children children;

  static constexpr auto parameters() {
    return std::tuple{
        parameter("formula", &Difference::formula, k_formula_doc),
        parameter("children", &Difference::children, "what to carve, then what to carve away").required(),
    };
  }

  static constexpr Lone k_lone = Lone::above_0;
  static constexpr ExtentOf k_extent = ExtentOf::first_child;
  bool scales_with_threshold(Demand /*mine*/) const { return true; }

  template <class Real>
  Real combine(std::span<const Real> f, double threshold, Demand mine) const {
    const auto rest = [&](const Real& x) { return Real(2 * threshold) - x; };
    if (is_smooth(formula, mine)) return r_function::fold<r_function::Intersect>(f, threshold, rest);
    Real least = f[0];
    for (const Real& x : f.subspan(1)) least = min(least, rest(x));
    return max(Real(0.0), least);
  }

  /// What is carved away is dropped where 2T - f_B is never below f_A, and under `sign` where it is outside throughout. An
  /// R-function needs all.
  void keep(std::span<const Interval> f, double threshold, Demand mine, std::span<char> kept) const {
    kept[0] = true;
    for (size_t i = 1; i < f.size(); ++i) {
      const bool outside = mine == Demand::sign && f[i].hi < threshold, never_less = 2 * threshold - f[i].hi >= f[0].hi;
      kept[i] = !(outside || (never_less && (mine == Demand::sign || !is_smooth(formula, mine))));
    }
  }
  Demand demand_of_operands(Demand mine, size_t /*count*/) const { return mine; }
  void shares(std::span<const double> f, double threshold, std::span<double> shares) const {
    size_t least = 0;
    double value = f[0];
    for (size_t i = 1; i < f.size(); ++i)
      if (2 * threshold - f[i] < value) value = 2 * threshold - f[i], least = i;
    share_all_to(least, shares);
  }
};

} // namespace kelpie
