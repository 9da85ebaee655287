#include "morph/tree/mix_kinds.h"

namespace kelpie {

std::optional<AnimatedKind> mixed_kind(const AnimatedKind& a, const AnimatedKind& b, const Animated<float>& s) {
  if (a.index() != b.index()) return {};
  AnimatedKind out = a;
  const bool is_good = std::visit([&]<class Kind>(Kind& kind) { return mix_numbers(kind, std::get<Kind>(b), s); }, out);
  return is_good ? std::optional(std::move(out)) : std::nullopt;
}

void make_comparable(AnimatedKind& a, AnimatedKind& b) {
  auto* const hull = std::get_if<Polyhedron<AnimatedMode>>(&a);
  if (auto* other = std::get_if<Polyhedron<AnimatedMode>>(&b); hull && other) {
    for (auto [shorter, longer] : {std::pair(&hull->points, &other->points), std::pair(&other->points, &hull->points)})
      for (size_t i = 0, n = shorter->size(); shorter->size() < longer->size(); ++i) shorter->push_back((*shorter)[i % n]);
  }
  for (AnimatedKind* kind : {&a, &b})
    if (auto* limb = std::get_if<GeneralizedCylinder<AnimatedMode>>(kind)) {
      if (limb->radii.empty()) limb->radii.emplace_back(0.f);
      while (limb->radii.size() < limb->points.size()) limb->radii.push_back(limb->radii.front());
    }
}

AnimatedKind retimed_kind(AnimatedKind kind, const TimeMap& time) {
  const auto one = [&]<class T>(const ParameterRules&, T& value) {
    if constexpr (IsAnimated<T>) value = retimed(value, time);
  };
  std::visit([&](auto& k) { for_each_value(one, k); }, kind);
  return kind;
}

} // namespace kelpie
