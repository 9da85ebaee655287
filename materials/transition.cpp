#include "materials/transition.h"

#include <fmt/format.h>

#include "base/sample_record.h"
#include "materials/add_stops.h"

namespace kelpie {

namespace {

// --- what materials are ---

/// Calls use(pattern) for a pattern as it is at `frame`; what it ranges over is not sampled.
template <class Use>
void with_pattern(const MaterialNode& material, double frame, const Use& use) {
  std::visit(
      [&]<template <class> class Kind>(const Kind<AnimatedMode>& kind) {
        if constexpr (Pattern<Kind<SampledMode>>) {
          const std::vector<MaterialIndex> none(kind.stops.size());
          use(sample_record(kind, frame, nullptr, none.data()), kind.stops);
        }
      },
      material.kind);
}

bool is_pattern(const MaterialNode& material) {
  return std::visit([]<template <class> class Kind>(const Kind<AnimatedMode>&) { return Pattern<Kind<SampledMode>>; }, material.kind);
}
bool has_phase(const MaterialNode& material) {
  return std::visit(
      []<class Kind>(const Kind&) {
        if constexpr (requires { Kind::k_domain; }) return Kind::k_domain.is_periodic;
        return false;
      },
      material.kind);
}

/// How light a material is, about: where it ranges over others, the mean of them.
float lightness(const MaterialNode& material, double frame) {
  const auto of_kind = [&]<template <class> class Kind>(const Kind<AnimatedMode>& kind) {
    if constexpr (requires(Kind<SampledMode> k) { k.surface(); }) {
      const SurfaceParameters surface = sample_record(kind, frame).surface();
      return glm::dot(surface.base_color.rgb * surface.base_weight, Vec3(0.27f, 0.67f, 0.06f));
    } else {
      float sum = 0, count = 0;
      for_each_value(
          [&]<class T>(const ParameterRules&, const T& value) {
            if constexpr (IsMaterialEdge<T>) sum += lightness(*value, frame), ++count;
          },
          kind);
      return sum / std::max(count, 1.f);
    }
  };
  return std::visit(of_kind, material.kind);
}

// --- phases ---

constexpr size_t k_phases = 256;

/// Over a period, less their mean.
std::array<float, k_phases> lightness_of_phases(const MaterialNode& material, double frame) {
  std::array<float, k_phases> light{};
  with_pattern(material, frame, [&](const auto& pattern, const auto& stops) {
    std::vector<float> shares(stops.size()), of_stops;
    for (const auto& stop : stops) of_stops.push_back(lightness(*stop.material, frame));
    for (size_t i = 0; i < k_phases; ++i) {
      pattern.shares(PhaseMixture({(float(i) + 0.5f) / k_phases, 0}), shares);
      for (size_t s = 0; s < shares.size(); ++s) light[i] += shares[s] * of_stops[s];
    }
  });
  float mean = 0;
  for (const float l : light) mean += l / k_phases;
  for (float& l : light) l -= mean;
  return light;
}

/// Where the light and the dark of two patterns of phases go best together, in [0, 1).
float best_shift(const MaterialNode& from, const MaterialNode& to, double frame) {
  const auto a = lightness_of_phases(from, frame), b = lightness_of_phases(to, frame);
  size_t best = 0;
  float most = -std::numeric_limits<float>::infinity();
  for (size_t shift = 0; shift < k_phases; ++shift) {
    float likeness = 0;
    for (size_t i = 0; i < k_phases; ++i) likeness += a[i] * b[(i + shift) % k_phases];
    if (likeness > most) most = likeness, best = shift;
  }
  return float(best) / k_phases;
}

PhaseMixture phases_of(const SampledMaterials& all, MaterialIndex pattern, const Vec3& p, const Footprint& footprint) {
  PhaseMixture phases(k_all_phases);
  std::visit(
      [&]<class Kind>(const Kind& kind) {
        if constexpr (Pattern<Kind>) phases = kind.phases(p, footprint);
      },
      all[pattern.index]);
  return phases;
}

// --- what a side looks like at a point ---

struct Spot {
  const SampledMaterials& all;
  const Vec3& p;
  const Footprint& footprint;
  SurfaceMix& mix;

  float value_of(MaterialIndex pattern) const {
    float value = 0;
    std::visit(
        [&]<class Kind>(const Kind& kind) {
          if constexpr (Pattern<Kind>) value = kind.value(p, footprint);
        },
        all[pattern.index]);
    return value;
  }
  void add(MaterialIndex material, float weight) const {
    if (weight > 0) add_material(all, material, p, footprint, weight, mix);
  }
  /// A pattern as it is at other phases, or at another value, than it has here.
  template <class Phases>
  void add_at(MaterialIndex pattern, const Phases& phases, float weight) const {
    if (weight <= 0) return;
    std::visit(
        [&]<class Kind>(const Kind& kind) {
          if constexpr (Pattern<Kind>)
            add_stops(
                all, kind, [&](std::span<float> shares) { kind.shares(phases, shares); }, p, footprint, weight, mix);
        },
        all[pattern.index]);
  }
};

/// What covers the veins of a pattern, or is drawn over its rings, stays with the pattern that has it.
void add_phases(const Spot& spot, const Transition<SampledMode>& t, float s, float weight) {
  const float shift = t.shift.value_or(0.f);
  PhaseMixture from = phases_of(spot.all, t.from, spot.p, spot.footprint), to = phases_of(spot.all, t.to, spot.p, spot.footprint);
  SpreadPhase &a = from.phases[0], &b = to.phases[0];
  const float mean = (1 - s) * a.mean + s * (b.mean - shift);
  const float variance = (1 - s) * (1 - s) * a.variance + s * s * b.variance; // as if the one did not know of the other
  a.mean = mean, b.mean = mean + shift, a.variance = b.variance = variance;
  spot.add_at(t.from, from, weight * (1 - s));
  spot.add_at(t.to, to, weight * s);
}

// --- growth ---

constexpr float k_patchiness = 0.9f; ///< how much patches count, beside the features of the pattern
constexpr float k_border = 0.06f;    ///< half of it, in shares of space

/// How much of all values u + k_patchiness v is below x, for u and v in [0, 1].
float share_of_sums_below(float x) {
  constexpr float k = k_patchiness;
  if (x < k) return x * x / (2 * k);
  if (x < 1) return x - k / 2;
  return 1 - (1 + k - x) * (1 + k - x) / (2 * k);
}

/// How much of a place is already `to`: `late` is its place in the order of growth, in [0, 1].
float grown_part(const Spot& spot, float late, float patch_size, float s) {
  const Place place = Place{spot.p, spot.footprint}.scaled(1 / patch_size);
  const float patches = normal_below(place.noise({.octaves = 2, .seed = 0x7a7c4}).value);
  const float order = share_of_sums_below(late + k_patchiness * patches);
  const float border = glm::mix(k_border, 1.f, std::min(1.f, place.width())); // what is finer than a pixel is its mean
  const float x = std::clamp((s * (1 + 2 * border) - border - order) / (2 * border) + 0.5f, 0.f, 1.f);
  return x * x * (3 - 2 * x);
}

/// Both sides have the colours that are between theirs: where so much of space has lower values.
void add_growth(const Spot& spot, const Transition<SampledMode>& t, float s, float weight) {
  const auto &from = t.tables->from, &to = t.tables->to;
  const float value_from = from ? spot.value_of(t.from) : 0, value_to = to ? spot.value_of(t.to) : 0;
  const float share_from = from ? from->share_below(value_from) : 0, share_to = to ? to->share_below(value_to) : 0;
  const float part = grown_part(spot, to ? 1 - share_to : share_from, t.patch_size.value_or(1.f), s);
  if (!from || !to) {
    spot.add(t.from, weight * (1 - part));
    spot.add(t.to, weight * part);
    return;
  }
  spot.add(t.from, weight * (1 - part) * (1 - s));
  spot.add_at(t.to, to->value_at(share_from), weight * (1 - part) * s);
  spot.add_at(t.from, from->value_at(share_to), weight * part * (1 - s));
  spot.add(t.to, weight * part * s);
}

} // namespace

void add_transition(const SampledMaterials& all, const Transition<SampledMode>& t, const Vec3& p, const Footprint& footprint, float weight,
                    SurfaceMix& mix) {
  const float s = t.progress;
  const Spot spot{all, p, footprint, mix};
  if (s <= 0 || s >= 1) return spot.add(s <= 0 ? t.from : t.to, weight);
  if (t.way == TransitionWay::phase) return add_phases(spot, t, s, weight);
  if (t.way == TransitionWay::growth) return add_growth(spot, t, s, weight);
  spot.add(t.from, weight * (1 - s));
  spot.add(t.to, weight * s);
}

std::optional<ParameterProblem> problem_of(const Transition<AnimatedMode>& t) {
  const auto problem = [](std::string_view side, std::string_view expected, const MaterialNode& material) {
    const std::string_view found = std::visit([](const auto& kind) { return kind.k_name; }, material.kind);
    return ParameterProblem{side, fmt::format("{}: expected {}, found {}", side, expected, found)};
  };
  if (t.way == TransitionWay::phase)
    for (const auto& [side, material] : {std::pair("from", t.from), std::pair("to", t.to)})
      if (!has_phase(*material)) return problem(side, "a pattern with a phase (marble, wood, strata, stripes)", *material);
  if (t.way == TransitionWay::growth && !is_pattern(*t.from) && !is_pattern(*t.to)) return problem("to", "a pattern", *t.to);
  return {};
}

void complete_transition(Transition<AnimatedMode>& t, double frame) {
  if (t.way == TransitionWay::automatic)
    t.way = has_phase(*t.from) && has_phase(*t.to)     ? TransitionWay::phase
            : is_pattern(*t.from) || is_pattern(*t.to) ? TransitionWay::growth
                                                       : TransitionWay::dissolve;
  if (t.way == TransitionWay::phase && !t.shift) t.shift = best_shift(*t.from, *t.to, frame);
  if (t.way != TransitionWay::growth) return;
  auto tables = std::make_shared<TransitionTables>();
  float size = 1;
  const auto measure = [&](auto& table) { return [&](const auto& pattern, const auto&) { table.emplace(pattern), size = pattern.size; }; };
  with_pattern(*t.from, frame, measure(tables->from));
  with_pattern(*t.to, frame, measure(tables->to));
  t.tables = std::move(tables);
  if (!t.patch_size) t.patch_size = 5 * size;
}

} // namespace kelpie
