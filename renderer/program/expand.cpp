#include "renderer/program/expand.h"

namespace kelpie {

namespace {

using Nodes = std::vector<FieldKinds::Variant<SampledMode>>;

/// Whether there is anything to expand.
bool has_pieces(const FieldKinds::Variant<SampledMode>& node) {
  return std::visit([]<class Kind>(const Kind&) { return HasPieces<Kind>; }, node);
}

template <class Kind>
void expand_node(std::span<SampledField> moments, size_t index) {
  Divisions divisions;
  if constexpr (ComplexPrimitive<Kind>)
    for (const SampledField& field : moments) extend(divisions, std::get<Kind>(field.nodes[index]).divisions());
  for (SampledField& field : moments) {
    Nodes& nodes = field.nodes;
    Kind kind = std::move(std::get<Kind>(nodes[index])); // out of the list while that grows
    kind.expansion.first = static_cast<uint32_t>(nodes.size());
    kind.for_each_piece(divisions, [&](auto&& piece) { nodes.emplace_back(std::forward<decltype(piece)>(piece)); });
    kind.expansion.count = static_cast<uint32_t>(nodes.size()) - kind.expansion.first;
    nodes[index] = std::move(kind);
  }
}

} // namespace

void expand(std::span<SampledField> moments) {
  const size_t count = moments[0].nodes.size();
  if (moments[0].piece_count > 0 || std::none_of(moments[0].nodes.begin(), moments[0].nodes.end(), has_pieces)) return;
  for (size_t i = 0; i < count; ++i)
    std::visit(
        [&]<class Kind>(const Kind&) {
          if constexpr (HasPieces<Kind>) expand_node<Kind>(moments, i);
        },
        moments[0].nodes[i]);
  for (SampledField& field : moments) {
    Union<SampledMode> sharp; // also below a blend: what an R-function adds where pieces meet would be bulges
    sharp.formula = BooleanFormula::sharp;
    field.union_of_pieces = static_cast<uint32_t>(field.nodes.size());
    field.nodes.emplace_back(std::move(sharp));
    field.piece_count = field.nodes.size() - count;
  }
}

} // namespace kelpie
