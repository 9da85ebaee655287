// What the operators of trees make of their operands, one place at a time.
#pragma once

#include "renderer/lanes/tree_view.h"
#include "renderer/program/program.h"

namespace kelpie {

/// Joins a step's operands by the operator's own formula: operands[0], operands[1], ….
template <class Real>
Real combine(const FieldProgram& program, const TreeStep& step, const Real* operands) {
  if (step.join == Join::sum) return operands[0] + operands[1]; // most steps: without looking for the operator
  if (step.join == Join::maximum) return max(operands[0], operands[1]);
  if (step.join == Join::minimum) return min(operands[0], operands[1]);
  return std::visit(
      [&](const auto& kind) -> Real {
        if constexpr (Operator<std::decay_t<decltype(kind)>>)
          return kind.combine(std::span<const Real>(operands, step.count), program.threshold, step.demand);
        return Real(0.0);
      },
      program.field.nodes[step.first]);
}

} // namespace kelpie
