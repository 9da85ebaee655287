#include "scene/check_distances.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "morph/field_fold.h"

namespace kelpie {

namespace {

/// Something below a node that keeps its field from being a distance, and why.
struct NoDistance {
  const FieldNode* node = nullptr;
  std::string_view why{};
};

/// Whether a curve is 1 at all times.
bool is_one(const Animated<float>& curve) {
  const std::vector<double> frames = curve.frames();
  if (frames.empty()) return curve.at(0) == 1;
  return std::all_of(frames.begin(), frames.end(), [&](double frame) { return curve.at(frame) == 1; });
}

template <class Kind>
std::string_view why_no_distance(const Kind& kind) {
  if constexpr (requires(Kind k) { k.falloff = DistanceFalloff::distance; }) {
    if (kind.falloff != DistanceFalloff::distance) return "has a soft falloff";
    return is_one(kind.weight) ? "" : "has a weight other than 1";
  }
  if constexpr (requires(Kind k) { k.formula = BooleanFormula::sharp; })
    return kind.formula == BooleanFormula::smooth ? "has the smooth formula" : "";
  if constexpr (requires(Kind k) { k.child; }) return ""; // a warp
  return "is no signed distance";
}

} // namespace

void check_distances(const Scene& scene, ProblemList& problems) {
  FieldFold<NoDistance> fold(PartsShared::always);
  std::set<const FieldNode*> told;
  const auto visit = [&](const FieldNode& node, const auto& kind, const TimeMap&, std::span<const NoDistance> below) -> NoDistance {
    using Kind = std::decay_t<decltype(kind)>;
    if constexpr (std::is_same_v<Kind, Metamorphosis<AnimatedMode>>) {
      for (const NoDistance& no : below)
        if (no.node && told.insert(no.node).second)
          problems.add(no.node->where,
                       fmt::format("a metamorphosis mixes signed distances (sdf_ kinds, Booleans and warps of them); this {} {}",
                                   std::visit([](const auto& k) { return k.k_name; }, no.node->kind), no.why));
      return {&node, "is no signed distance"};
    } else {
      for (const NoDistance& no : below)
        if (no.node) return no;
      const std::string_view why = why_no_distance(kind);
      return why.empty() ? NoDistance{} : NoDistance{&node, why};
    }
  };
  for (const Shape& shape : scene.shapes)
    for (const auto* tree : {&shape.field, &shape.texture})
      if (*tree) fold(**tree, visit);
}

} // namespace kelpie
