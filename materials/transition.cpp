#include "materials/transition.h"

#include <numeric>

#include <fmt/format.h>

#include "base/sample_record.h"
#include "materials/material.h"

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

/// Calls use(lightness of a value) for a pattern.
template <class Use>
void with_lightness(const MaterialNode& material, double frame, const Use& use) {
  with_pattern(material, frame, [&](const auto& pattern, const auto& stops) {
    std::vector<float> shares(stops.size()), of_stops;
    for (const auto& stop : stops) of_stops.push_back(glm::dot(mean_colour(*stop.material, frame), Vec3(0.27f, 0.67f, 0.06f)));
    use([&](float value) {
      pattern.shares(value, shares);
      return std::inner_product(shares.begin(), shares.end(), of_stops.begin(), 0.f);
    });
  });
}

// --- growth ---

/// Over the quantiles of a pattern, less their mean.
std::array<float, 64> lightness_of_quantiles(const MaterialNode& material, const ValueDistribution& values, double frame) {
  std::array<float, 64> light{};
  with_lightness(material, frame, [&](const auto& lightness) {
    for (size_t i = 0; i < light.size(); ++i) light[i] = lightness(values.value_at((float(i) + 0.5f) / float(light.size())));
  });
  const float mean = std::accumulate(light.begin(), light.end(), 0.f) / float(light.size());
  for (float& l : light) l -= mean;
  return light;
}

// --- phases ---

constexpr size_t k_phases = 2048; ///< as many as a table of shares looks at

/// A pattern over a period of its phase. Among all phases those are alike that have as many darker ones.
PhaseRanks ranked_phases(const MaterialNode& material, double frame) {
  PhaseRanks ranks;
  std::vector<float> light(k_phases), value(k_phases);
  with_pattern(material, frame, [&](const auto& pattern, const auto& stops) {
    for (const auto& stop : stops) ranks.stops.push_back(stop.at.at(frame));
    for (size_t i = 0; i < k_phases; ++i) value[i] = pattern.value_of_phase((float(i) + 0.5f) / k_phases);
  });
  with_lightness(material, frame, [&](const auto& lightness) { std::transform(value.begin(), value.end(), light.begin(), lightness); });
  const auto look = [&](uint32_t phase) { return std::pair(light[phase], value[phase]); }; // what is as light may differ in other things
  std::vector<uint32_t> order(k_phases);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return look(a) < look(b); });
  ranks.darker.resize(k_phases);
  for (size_t first = 0, last = 0; first < k_phases; first = last) { // those that look alike have one rank
    while (last < k_phases && look(order[last]) == look(order[first])) ++last;
    for (size_t i = first; i < last; ++i) ranks.darker[order[i]] = float(first + last) / (2 * k_phases);
  }
  for (const uint32_t phase : order) ranks.values.push_back(value[phase]);
  return ranks;
}

size_t shifted(size_t phase, float shift) {
  const float steps = shift * k_phases;
  return size_t(std::lround(steps - std::floor(steps / k_phases) * k_phases) + long(phase)) % k_phases;
}

/// Where the light and the dark of two patterns go best together, in [0, 1).
float best_shift(const PhaseRanks& a, const PhaseRanks& b) {
  constexpr size_t k_step = 8;
  size_t best = 0;
  float most = -std::numeric_limits<float>::infinity();
  for (size_t shift = 0; shift < k_phases; shift += k_step) {
    float likeness = 0;
    for (size_t i = 0; i < k_phases; i += k_step) likeness += (a.darker[i] - 0.5f) * (b.darker[(i + shift) % k_phases] - 0.5f);
    if (likeness > most) most = likeness, best = shift;
  }
  return float(best) / k_phases;
}

} // namespace

/// Over a period of the blended phase each place has a rank between those that it has on both sides; and the materials that both have at
/// such a rank among all. So light and dark have as much of space as is between what they have on either side.
std::shared_ptr<const BlendedPhases> blended_phases(const Transition<SampledMode>& t) {
  const auto& [from, to] = t.tables->ranks;
  const float s = std::clamp(t.progress, 0.f, 1.f), shift = t.shift.value_or(0.f);
  std::vector<float> score(k_phases);
  for (size_t i = 0; i < k_phases; ++i) score[i] = (1 - s) * from.darker[i] + s * to.darker[shifted(i, shift)];
  std::vector<uint32_t> order(k_phases), rank(k_phases);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return score[a] < score[b]; });
  for (size_t i = 0; i < k_phases; ++i) rank[order[i]] = uint32_t(i);
  const auto table = [&](const PhaseRanks& side) {
    const auto value = [&](float phase) { return side.values[rank[std::min(size_t(phase * k_phases), k_phases - 1)]]; };
    return ShareTable(PhaseDomain{0, 1, true}, side.stops, value);
  };
  return std::make_shared<const BlendedPhases>(BlendedPhases{table(from), table(to)});
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
  if (t.way == TransitionWay::dissolve) return;
  auto tables = std::make_shared<TransitionTables>();
  if (t.way == TransitionWay::phase) {
    tables->ranks = {ranked_phases(*t.from, frame), ranked_phases(*t.to, frame)};
    if (!t.shift) t.shift = best_shift(tables->ranks[0], tables->ranks[1]);
    t.tables = std::move(tables);
    return;
  }
  float size = 0;
  const auto measure = [&](auto& table) {
    return [&](const auto& pattern, const auto&) { table.emplace(pattern), size = std::max(size, pattern.size); };
  };
  with_pattern(*t.from, frame, measure(tables->from));
  with_pattern(*t.to, frame, measure(tables->to));
  if (tables->from && tables->to) {
    const auto a = lightness_of_quantiles(*t.from, *tables->from, frame), b = lightness_of_quantiles(*t.to, *tables->to, frame);
    tables->is_opposed = std::inner_product(a.begin(), a.end(), b.begin(), 0.f) < 0;
  }
  t.tables = std::move(tables);
  if (!t.patch_size) t.patch_size = 5 * size;
}

} // namespace kelpie
