// How a node of a sampled field sees those that it stands on.
#pragma once

#include "base/affine.h"
#include "base/table.h"

namespace kelpie {

/// A field as an operator (or an affine warp) has it. One node may be several operands, each seen through a map of its own.
struct Operand {
  unsigned node = 0; ///< into SampledField::nodes
  Role role = Role::child;
  Affine parent_from_operand{}; ///< the operand's field at p is that of the node at the inverse image of p
};

/// Moves the space of its child affinely.
template <class K>
concept AffineWarp = requires(const K k) {
  k.parent_from_child();
};

/// Says itself what its operands are: `void for_each_operand(visit) const` calls visit(Operand) for each. How many there are, of which
/// nodes and in which roles does not depend on numbers, which may differ from moment to moment.
template <class K>
concept HasOwnOperands = requires(const K k) {
  k.for_each_operand([](const Operand&) {});
};

/// Whether any operand is moved before it is looked at.
template <class K>
inline constexpr bool k_sees_through_maps = AffineWarp<K> || HasOwnOperands<K>;

/// Calls visit(Operand) for each, in the order in which `combine` has their values: of a kind that does not say otherwise whatever its
/// table leads to, where it stands.
template <class Kind, class Visit>
void for_each_operand(const Kind& kind, Visit&& visit) {
  if constexpr (HasOwnOperands<Kind>)
    kind.for_each_operand(visit);
  else
    for_each_edge(kind, [&](unsigned node, const ParameterRules& rules) {
      if constexpr (AffineWarp<Kind>)
        visit(Operand{node, rules.role, kind.parent_from_child()});
      else
        visit(Operand{node, rules.role, {}});
    });
}

template <class Kind>
std::vector<Operand> operands_of(const Kind& kind) {
  std::vector<Operand> operands;
  for_each_operand(kind, [&](const Operand& operand) { operands.push_back(operand); });
  return operands;
}

} // namespace kelpie
