// What unions, intersections and differences share: the choice of their formula.
#pragma once

#include "field/operators/r_functions.h"

namespace kelpie {

/// Both formulas have the same surface. Maxima and minima crease the field wherever two operands are equal, and a blend above
/// would show those creases; R-functions crease it only where the surfaces cross, and cost more.
enum class BooleanFormula { automatic, sharp, smooth };

template <>
struct EnumNames<BooleanFormula> {
  static constexpr std::array<std::pair<std::string_view, BooleanFormula>, 3> values{
      {{"automatic", BooleanFormula::automatic}, {"sharp", BooleanFormula::sharp}, {"smooth", BooleanFormula::smooth}}};
};

/// Whether the formula is the R-function; `mine` is what the whole tree asks of the node.
constexpr bool is_smooth(BooleanFormula formula, Demand mine) {
  return formula == BooleanFormula::smooth || (formula == BooleanFormula::automatic && mine == Demand::value);
}

inline constexpr std::string_view k_formula_doc =
    "automatic: smooth below a blend, else sharp; sharp: maxima and minima; smooth: R-functions, without creases off the surface";

} // namespace kelpie
