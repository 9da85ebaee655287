#include "morph/tree/leaf_between.h"

#include "morph/tree/plain_tree.h"
#include "morph/tree/skeleton_graph.h"

namespace kelpie {

namespace {

AnimatedKind weighted(AnimatedKind kind, const Animated<float>& factor) {
  return weighted_tree(FieldNode{std::move(kind), {}, {}, {}}, factor)->kind; // a skeleton has a weight
}

/// None of a kind that has another sort of falloff.
std::optional<Falloff> falloff_of(const AnimatedKind& kind) {
  return std::visit(
      []<class Kind>(const Kind& k) -> std::optional<Falloff> {
        if constexpr (requires { k.falloff; })
          if constexpr (std::is_same_v<decltype(Kind::falloff), Falloff>) return k.falloff;
        return {};
      },
      kind);
}

AnimatedKind with_falloff(AnimatedKind kind, Falloff falloff) {
  std::visit(
      [&](auto& k) {
        if constexpr (requires { k.falloff = falloff; }) k.falloff = falloff;
      },
      kind);
  return kind;
}

} // namespace

std::vector<AnimatedKind> common_solids(const AnimatedKind& a, const AnimatedKind& b, const Animated<float>& s) {
  AnimatedKind from = a, to = b;
  make_comparable(from, to);
  if (auto one = mixed_kind(from, to, s)) return {std::move(*one)};
  const std::optional<SkeletonPath> path = skeleton_path(a, b);
  if (!path) return {};
  const auto stage = [&](size_t i, const Animated<float>& t) { return *mixed_kind(path->stages[i].from, path->stages[i].to, t); };
  if (path->stages.size() == 1) return {stage(0, s)};
  const auto first = computed<float>([](float t) { return std::min(1.f, 2 * t); }, s);
  const auto second = computed<float>([](float t) { return std::max(0.f, 2 * t - 1); }, s);
  const auto is_first = computed<float>([](float t) { return t < 0.5f ? 1.f : 0.f; }, s);
  return {weighted(stage(0, first), is_first), weighted(stage(1, second), rest_of(is_first))};
}

FieldPtr leaf_between(const FieldNode& a, const FieldNode& b, const Animated<float>& s, const AnimatedMode::Material& material) {
  std::vector<FieldPtr> leaves;
  const auto add = [&](AnimatedKind kind) {
    leaves.push_back(std::make_shared<FieldNode>(FieldNode{std::move(kind), a.where, material, a.name}));
  };
  const std::optional<Falloff> from = falloff_of(a.kind), to = falloff_of(b.kind);
  for (const AnimatedKind& kind : common_solids(a.kind, b.kind, s)) {
    if (from == to) {
      add(kind);
    } else { // the same solid with either falloff: their sum goes from the one to the other
      add(weighted(with_falloff(kind, *from), rest_of(s)));
      add(weighted(with_falloff(kind, *to), s));
    }
  }
  if (leaves.size() < 2) return leaves.empty() ? nullptr : leaves.front();
  return std::make_shared<FieldNode>(FieldNode{Blend<AnimatedMode>{std::move(leaves)}, a.where, {}, {}});
}

} // namespace kelpie
