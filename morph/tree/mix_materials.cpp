#include "morph/tree/mix_materials.h"

#include <algorithm>
#include <random>

#include "base/sample_record.h"
#include "morph/tree/computed.h"
#include "morph/tree/mix_kinds.h"

namespace kelpie {

namespace {

using A = AnimatedMode;

/// A pattern that has the value s everywhere.
MaterialPtr dissolved(const MaterialPtr& a, const MaterialPtr& b, const Animated<float>& s) {
  Gradient<A> everywhere;
  everywhere.contrast = 0.f;
  everywhere.bias = computed<float>([](float t) { return t - 0.5f; }, s);
  everywhere.stops = {{0.f, a}, {1.f, b}};
  return std::make_shared<MaterialNode>(
      MaterialNode{std::move(everywhere), a->where, 1 + std::max(a->depth, b->depth), 1 + a->count + b->count});
}

/// Which values of a pattern how much of space is below.
class Quantiles {
public:
  template <class SampledPattern>
  explicit Quantiles(const SampledPattern& pattern) : values_(k_count) {
    std::minstd_rand random(1);
    const float reach = std::min(50 * pattern.size, 1e6f);
    const auto coordinate = [&] { return reach * (2 * float(random()) / float(random.max()) - 1); };
    for (float& value : values_) {
      const float x = coordinate(), y = coordinate(), z = coordinate();
      value = pattern.value(Vec3(x, y, z), Footprint{});
    }
    std::sort(values_.begin(), values_.end());
    values_.front() = 0, values_.back() = 1; // there is nothing beyond, whatever the samples met
  }

  /// Beyond 0 and 1 it goes on straight.
  float operator()(float share) const {
    if (share <= 0 || share >= 1) return share;
    const float place = share * float(k_count - 1);
    const size_t i = std::min(size_t(place), k_count - 2);
    return values_[i] + (values_[i + 1] - values_[i]) * (place - float(i));
  }

private:
  static constexpr size_t k_count = 4096;
  std::vector<float> values_;
};

/// b where the values of a pattern are highest: in the share s of all space, with a soft border.
template <template <class> class Kind>
MaterialPtr grown(const Kind<A>& pattern, const MaterialPtr& a, const MaterialPtr& b, const Animated<float>& s, double frame) {
  static constexpr float k_width = 0.06f; // half a border's, in shares of space
  const std::vector<MaterialIndex> none(pattern.stops.size());
  const auto below = std::make_shared<const Quantiles>(sample_record(pattern, frame, nullptr, none.data()));
  struct Border {
    float at, steepness;
  };
  const auto border = [below](float t) {
    const float outside = 1 + k_width - t * (1 + 2 * k_width); // 1 + w at t = 0, where none is left above it; -w at 1
    return Border{(*below)(outside), 1 / std::max((*below)(outside + k_width) - (*below)(outside - k_width), 1e-4f)};
  };
  Kind<A> mask = pattern;
  mask.contrast = computed<float>([border](float contrast, float t) { return contrast * border(t).steepness; }, pattern.contrast, s);
  mask.bias = computed<float>(
      [border](float bias, float t) {
        const Border at = border(t);
        return at.steepness * (bias + 0.5f - at.at);
      },
      pattern.bias, s);
  mask.stops = {{0.f, a}, {1.f, b}};
  return std::make_shared<MaterialNode>(MaterialNode{std::move(mask), b->where, 1 + std::max(a->depth, b->depth), 1 + a->count + b->count});
}

/// Along a pattern; null if it is none.
MaterialPtr grown_along(const MaterialPtr& pattern, const MaterialPtr& a, const MaterialPtr& b, const Animated<float>& s, double frame) {
  return std::visit(
      [&]<template <class> class Kind>(const Kind<A>& kind) -> MaterialPtr {
        if constexpr (Pattern<Kind<SampledMode>>) return grown(kind, a, b, s, frame);
        return nullptr;
      },
      pattern->kind);
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
  return std::make_shared<MaterialNode>(MaterialNode{std::move(kind), node.where, node.depth, node.count});
}

} // namespace

MaterialPtr mixed_material(const MaterialPtr& a, const MaterialPtr& b, const Animated<float>& s, MaterialChange how, double frame) {
  if (a == b) return a;
  if (a->kind.index() == b->kind.index()) {
    const auto mix = [&]<class Kind>(const Kind& kind) { return mixed_numbers(*a, kind, std::get<Kind>(b->kind), s, how, frame); };
    if (MaterialPtr one = std::visit(mix, a->kind)) return one;
  }
  if (how == MaterialChange::grow && !problem_of_phases(a, b)) {
    const PhaseBlend<A> blend{a, b, computed<float>([](float t) { return std::clamp(t, 0.f, 1.f); }, s), best_phase_shift(a, b, frame)};
    return std::make_shared<MaterialNode>(MaterialNode{blend, a->where, 1 + std::max(a->depth, b->depth), 1 + a->count + b->count});
  }
  if (how == MaterialChange::grow)
    for (const MaterialPtr& pattern : {b, a})
      if (MaterialPtr one = grown_along(pattern, a, b, s, frame)) return one;
  return dissolved(a, b, s);
}

} // namespace kelpie
