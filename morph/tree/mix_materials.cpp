#include "morph/tree/mix_materials.h"

#include <algorithm>

#include <fmt/format.h>

#include "morph/tree/computed.h"
#include "morph/tree/mix_kinds.h"

namespace kelpie {

namespace {

using A = AnimatedMode;

/// Throws an Error (bad_data) where it would be more than a scene may ask for.
MaterialPtr node_of(MaterialKinds::Variant<A> kind, const SourcePosition& where) {
  constexpr int k_most = 1000;
  auto node = std::make_shared<MaterialNode>(MaterialNode{std::move(kind), where});
  const auto count_below = [&]<class T>(const ParameterRules&, const T& value) {
    if constexpr (IsMaterialEdge<T>) node->depth = std::max(node->depth, value->depth + 1), node->count += value->count;
  };
  std::visit([&](const auto& k) { for_each_value(count_below, k); }, node->kind);
  if (node->count > k_most) throw Error(ExitStatus::bad_data, fmt::format("animorphosis: more than {} materials in one", k_most), where);
  return node;
}

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
  return node_of(std::move(kind), node.where);
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
  return node_of(std::move(transition), a->where);
}

} // namespace kelpie
