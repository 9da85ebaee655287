#include "morph/tree/leaf_between.h"

#include "morph/tree/kept_volume.h"
#include "morph/tree/plain_tree.h"

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

AnimatedKind with_radius(AnimatedKind kind, const Animated<float>& factor) {
  std::visit(
      [&](auto& k) {
        if constexpr (requires { k.radius = factor; }) k.radius = computed<float>([](float r, float f) { return r * f; }, k.radius, factor);
      },
      kind);
  return kind;
}

AnimatedKind with_falloff(AnimatedKind kind, Falloff falloff) {
  std::visit(
      [&](auto& k) {
        if constexpr (requires { k.falloff = falloff; }) k.falloff = falloff;
      },
      kind);
  return kind;
}

/// The one or two skeletons that go along a path; of two the one has weight before the middle, the other after it.
std::vector<AnimatedKind> along(const SkeletonPath& path, const Animated<float>& s, double frame) {
  const auto stage = [&](size_t i, const Animated<float>& t) { return *mixed_kind(path.stages[i].from, path.stages[i].to, t); };
  if (path.stages.size() == 1) return {stage(0, s)}; // the only one that overshoots
  const auto first = computed<float>([](float t) { return std::clamp(2 * t, 0.f, 1.f); }, s);
  const auto second = computed<float>([](float t) { return std::clamp(2 * t - 1, 0.f, 1.f); }, s);
  const auto is_first = computed<float>([](float t) { return t < 0.5f ? 1.f : 0.f; }, s);
  const auto factor = computed<float>([curve = factor_for_volume(path, frame)](float t) { return curve.at(t); }, held(s));
  return {weighted(with_radius(stage(0, first), factor), is_first), weighted(with_radius(stage(1, second), factor), rest_of(is_first))};
}

} // namespace

std::optional<SkeletonPath> common_path(const AnimatedKind& a, const AnimatedKind& b) {
  AnimatedKind from = a, to = b;
  make_comparable(from, to);
  if (mixed_kind(from, to, 0.5f)) return SkeletonPath{{{std::move(from), std::move(to)}}, 0};
  return skeleton_path(a, b);
}

FieldPtr leaf_between(const FieldNode& a, const FieldNode& b, const Animated<float>& s, const AnimatedMode::Material& material,
                      double frame) {
  const std::optional<SkeletonPath> path = common_path(a.kind, b.kind);
  if (!path) return nullptr;
  std::vector<FieldPtr> leaves;
  const auto add = [&](AnimatedKind kind) {
    leaves.push_back(std::make_shared<FieldNode>(FieldNode{std::move(kind), a.where, material, a.name}));
  };
  const std::optional<Falloff> from = falloff_of(a.kind), to = falloff_of(b.kind);
  for (const AnimatedKind& kind : along(*path, s, frame)) {
    if (from == to) {
      add(kind);
    } else { // the same solid with either falloff: their sum goes from the one to the other
      add(weighted(with_falloff(kind, *from), rest_of(held(s))));
      add(weighted(with_falloff(kind, *to), held(s)));
    }
  }
  if (leaves.size() == 1) return leaves.front();
  return std::make_shared<FieldNode>(FieldNode{Blend<AnimatedMode>{std::move(leaves)}, a.where, {}, {}});
}

} // namespace kelpie
