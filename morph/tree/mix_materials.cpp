#include "morph/tree/mix_materials.h"

#include <algorithm>

#include "morph/tree/computed.h"
#include "morph/tree/mix_kinds.h"

namespace kelpie {

namespace {

using A = AnimatedMode;

/// Null where the two differ in more than numbers that move.
template <class Kind>
MaterialPtr mixed_numbers(const MaterialNode& node, const Kind& a, const Kind& b, const Animated<float>& s, MaterialChange how,
                          double frame) {
  Kind kind = a;
  if (!mix_numbers(kind, b, s)) return nullptr;
  const auto mix_below = [&]<class T>(const ParameterRules&, T& x, const T& y) {
    if constexpr (IsMaterialEdge<T>) x = mixed_material(x, y, s, how, frame);
  };
  for_each_value(mix_below, kind, b);
  return std::make_shared<MaterialNode>(MaterialNode{std::move(kind), node.where, node.depth, node.count});
}

} // namespace

MaterialPtr mixed_material(const MaterialPtr& a, const MaterialPtr& b, const Animated<float>& s, MaterialChange how, double frame) {
  if (a == b) return a;
  if (a->kind.index() == b->kind.index()) {
    const auto mix = [&]<class Kind>(const Kind& kind) { return mixed_numbers(*a, kind, std::get<Kind>(b->kind), s, how, frame); };
    if (MaterialPtr one = std::visit(mix, a->kind)) return one;
  }
  Transition<A> transition{a, b, computed<float>([](float t) { return std::clamp(t, 0.f, 1.f); }, s)};
  if (how == MaterialChange::dissolve) transition.way = TransitionWay::dissolve;
  complete_transition(transition, frame);
  return std::make_shared<MaterialNode>(
      MaterialNode{std::move(transition), a->where, 1 + std::max(a->depth, b->depth), 1 + a->count + b->count});
}

} // namespace kelpie
