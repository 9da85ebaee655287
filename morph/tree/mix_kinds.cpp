#include "morph/tree/mix_kinds.h"

#include "morph/tree/limbs.h"

namespace kelpie {

namespace detail {

namespace {
/// When one of two values moves, or any moment.
template <class T>
double some_frame(const Animated<T>& a, const Animated<T>& b) {
  const std::vector<double> frames = a.is_constant() ? b.frames() : a.frames();
  return frames.empty() ? 0 : frames.front();
}
} // namespace

bool have_equal_signs(const Animated<float>& a, const Animated<float>& b) {
  const double frame = some_frame(a, b);
  return (a.at(frame) < 0) == (b.at(frame) < 0);
}
bool have_equal_signs(const Animated<Vec3>& a, const Animated<Vec3>& b) {
  const double frame = some_frame(a, b);
  const Vec3 x = a.at(frame), y = b.at(frame);
  return (x.x < 0) == (y.x < 0) && (x.y < 0) == (y.y < 0) && (x.z < 0) == (y.z < 0);
}

} // namespace detail

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
  auto* const limb_a = std::get_if<GeneralizedCylinder<AnimatedMode>>(&a);
  if (auto* limb_b = std::get_if<GeneralizedCylinder<AnimatedMode>>(&b); limb_a && limb_b) give_equal_pieces(*limb_a, *limb_b);
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
