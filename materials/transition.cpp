#include "materials/transition.h"

#include <numeric>

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

// --- phases ---

constexpr size_t k_phases = 2048; ///< as many as a table of shares looks at

/// A pattern over a period of its phase. Among all phases those are alike that have as many darker ones.
PhaseRanks ranked_phases(const MaterialNode& material, double frame) {
  PhaseRanks ranks;
  std::vector<float> light(k_phases), value(k_phases);
  with_pattern(material, frame, [&](const auto& pattern, const auto& stops) {
    std::vector<float> shares(stops.size()), of_stops;
    for (const auto& stop : stops) {
      ranks.stops.push_back(stop.at.at(frame));
      of_stops.push_back(glm::dot(mean_colour(*stop.material, frame), Vec3(0.27f, 0.67f, 0.06f)));
    }
    for (size_t i = 0; i < k_phases; ++i) {
      value[i] = pattern.value_of_phase((float(i) + 0.5f) / k_phases);
      pattern.shares(value[i], shares);
      for (size_t s = 0; s < shares.size(); ++s) light[i] += shares[s] * of_stops[s];
    }
  });
  std::vector<uint32_t> order(k_phases);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return light[a] < light[b]; });
  ranks.darker.resize(k_phases);
  for (size_t first = 0, last = 0; first < k_phases; first = last) { // those that are as light have one rank
    while (last < k_phases && light[order[last]] == light[order[first]]) ++last;
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

class Spot {
public:
  Spot(const SampledMaterials& a, const Vec3& place, const Footprint& f, SurfaceMix& m) : all(a), p(place), footprint(f), mix(m) {}

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
    add_with(
        pattern, [&](const auto& kind) { return [&](std::span<float> shares) { kind.shares(phases, shares); }; }, weight);
  }
  /// As much of its stops as `shares_of` says.
  template <class SharesOf>
  void add_shares(MaterialIndex pattern, const SharesOf& shares_of, float weight) const {
    add_with(
        pattern, [&](const auto&) { return shares_of; }, weight);
  }

private:
  template <class SharesOfKind>
  void add_with(MaterialIndex pattern, const SharesOfKind& shares_of_kind, float weight) const {
    if (weight <= 0) return;
    std::visit(
        [&]<class Kind>(const Kind& kind) {
          if constexpr (Pattern<Kind>) add_stops(all, kind, shares_of_kind(kind), p, footprint, weight, mix);
        },
        all[pattern.index]);
  }
};

/// What covers the veins of a pattern, or is drawn over its rings, stays with the pattern that has it.
void add_phases(const Spot& spot, const Transition<SampledMode>& t, float s, float weight) {
  const PhaseMixture from = phases_of(spot.all, t.from, spot.p, spot.footprint), to = phases_of(spot.all, t.to, spot.p, spot.footprint);
  const SpreadPhase &a = from.phases[0], &b = to.phases[0];
  SpreadPhase blended{(1 - s) * a.mean + s * (b.mean - t.shift.value_or(0.f)),
                      (1 - s) * (1 - s) * a.variance + s * s * b.variance}; // as if the one did not know of the other
  const auto add_side = [&](MaterialIndex pattern, const PhaseMixture& own, const ShareTable& table, float side_weight) {
    spot.add_at(pattern, own.without_first(), side_weight);
    blended.weight = own.phases[0].weight;
    spot.add_shares(
        pattern,
        [&](std::span<float> shares) {
          std::fill(shares.begin(), shares.end(), 0.f);
          table.add_shares(blended.mean, blended.variance, blended.weight, shares);
        },
        side_weight);
  };
  add_side(t.from, from, t.blended->from, weight * (1 - s));
  add_side(t.to, to, t.blended->to, weight * s);
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
  const Spot spot(all, p, footprint, mix);
  if (s <= 0 || s >= 1) return spot.add(s <= 0 ? t.from : t.to, weight);
  if (t.way == TransitionWay::phase) return add_phases(spot, t, s, weight);
  if (t.way == TransitionWay::growth) return add_growth(spot, t, s, weight);
  spot.add(t.from, weight * (1 - s));
  spot.add(t.to, weight * s);
}

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
  float size = 1;
  const auto measure = [&](auto& table) { return [&](const auto& pattern, const auto&) { table.emplace(pattern), size = pattern.size; }; };
  with_pattern(*t.from, frame, measure(tables->from));
  with_pattern(*t.to, frame, measure(tables->to));
  t.tables = std::move(tables);
  if (!t.patch_size) t.patch_size = 5 * size;
}

} // namespace kelpie
