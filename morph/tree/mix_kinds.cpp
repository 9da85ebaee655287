#include "morph/tree/mix_kinds.h"

#include <cmath>
#include <numbers>

#include "base/time_map.h"
#include "morph/tree/computed.h"

namespace kelpie {

Animated<Vec3> turned(const Animated<Vec3>& a, const Animated<Vec3>& b, const Animated<float>& s) {
  const auto turn = [](const Vec3& x, const Vec3& y, float t) {
    if (t <= 0) return x;
    if (t >= 1) return y;
    const Vec3d from = glm::normalize(Vec3d(x)), to = glm::normalize(Vec3d(y));
    const double cosine = std::clamp(glm::dot(from, to), -1.0, 1.0), angle = std::acos(cosine) * double(t);
    Vec3d aside = to - cosine * from;
    if (!(glm::length(aside) > 1e-6)) { // the same, or opposite: about any axis
      if (cosine > 0) return x;
      aside = std::abs(from.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
      aside -= glm::dot(aside, from) * from;
    }
    return Vec3(std::cos(angle) * from + std::sin(angle) * glm::normalize(aside));
  };
  return computed<Vec3>(turn, a, b, s);
}

namespace {

template <class T>
constexpr bool k_is_edge = IsEdge<T> || IsMaterialEdge<T>;
template <class T>
constexpr bool k_is_edge<std::vector<T>> = IsEdge<T>;

/// Whether lists are as long in both, and what may be left out is there in both or in none.
template <class Kind>
bool have_one_form(const Kind& a, const Kind& b) {
  bool is_one = true;
  const auto row = [&]<class T>(const T& x, const T& y) {
    if constexpr (IsList<T> && !k_is_edge<T>) is_one &= x.size() == y.size();
    if constexpr (IsOptional<T>) is_one &= x.has_value() == y.has_value();
  };
  std::apply([&](const auto&... r) { (row(a.*(r.member), b.*(r.member)), ...); }, k_table<Kind>);
  return is_one;
}

template <class Kind>
bool mix_into(Kind& a, const Kind& b, const Animated<float>& s) {
  if (!have_one_form(a, b)) return false;
  bool is_good = true;
  const auto one = [&]<class T>(const ParameterRules& rules, T& x, const T& y) {
    if constexpr (std::is_same_v<T, Animated<Vec3>>)
      x = rules.is_nonzero ? turned(x, y, s) : mixed<Vec3>(x, y, s);
    else if constexpr (IsAnimated<T>)
      x = mixed<typename AnimatedTrait<T>::Value>(x, y, s);
    else if constexpr (std::is_same_v<T, PartReference>)
      is_good = false; // nobody mixes instances
    else if constexpr (!k_is_edge<T> && !std::is_same_v<T, Falloff>)
      is_good &= x == y;
  };
  for_each_value(one, a, b);
  if constexpr (HasAssets<Kind>) std::apply([&](const auto... member) { is_good &= (... && (a.*member == b.*member)); }, Kind::assets());
  return is_good;
}

} // namespace

std::optional<AnimatedKind> mixed_kind(const AnimatedKind& a, const AnimatedKind& b, const Animated<float>& s) {
  if (a.index() != b.index()) return {};
  AnimatedKind out = a;
  const bool is_good = std::visit([&]<class Kind>(Kind& kind) { return mix_into(kind, std::get<Kind>(b), s); }, out);
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
