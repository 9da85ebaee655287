#include "materials/material.h"

#include <algorithm>
#include <array>

#include "base/one_of.h"
#include "base/table.h"

namespace kelpie {

template struct OneOf<MaterialKinds, AnimatedMode>;
template struct OneOf<MaterialKinds, SampledMode>;

namespace {

/// Shares of stops that need no memory of their own.
constexpr size_t k_few_stops = 16;

/// Adds what a pattern has at some phases, or over a footprint: `shares_of(span)` says how much of each stop.
template <class Kind, class SharesOf>
void add_stops(const SampledMaterials& all, const Kind& pattern, const SharesOf& shares_of, const Vec3& p, const Footprint& footprint,
               float weight, SurfaceMix& mix) {
  std::array<float, k_few_stops> few;
  std::vector<float> many;
  if (pattern.stops.size() > few.size()) many.resize(pattern.stops.size());
  const std::span<float> shares = many.empty() ? std::span(few).first(pattern.stops.size()) : std::span<float>(many);
  shares_of(shares);
  for (size_t i = 0; i < shares.size(); ++i)
    if (shares[i] > 0) add_material(all, pattern.stops[i].material, p, footprint, weight * shares[i], mix);
}

template <class Kind>
concept IsPattern = Pattern<Kind>;

PhaseMixture phases_of(const SampledMaterials& all, MaterialIndex pattern, const Vec3& p, const Footprint& footprint) {
  return std::visit(
      [&]<class Kind>(const Kind& kind) {
        if constexpr (IsPattern<Kind>) return kind.phases(p, footprint);
        return PhaseMixture(k_all_phases); // not reached: problem_of_phases()
      },
      all[pattern.index]);
}

/// A pattern at phases that are not its own.
void add_at_phases(const SampledMaterials& all, MaterialIndex pattern, const PhaseMixture& phases, const Vec3& p,
                   const Footprint& footprint, float weight, SurfaceMix& mix) {
  std::visit(
      [&]<class Kind>(const Kind& kind) {
        if constexpr (IsPattern<Kind>)
          add_stops(
              all, kind, [&](std::span<float> shares) { kind.shares(phases, shares); }, p, footprint, weight, mix);
      },
      all[pattern.index]);
}

/// What covers the veins of a pattern, or is drawn over its rings, stays with the pattern that has it.
void add_phase_blend(const SampledMaterials& all, const PhaseBlend<SampledMode>& blend, const Vec3& p, const Footprint& footprint,
                     float weight, SurfaceMix& mix) {
  const float s = std::clamp(blend.progress, 0.f, 1.f), shift = blend.shift.value_or(0.f);
  PhaseMixture from = phases_of(all, blend.from, p, footprint), to = phases_of(all, blend.to, p, footprint);
  SpreadPhase &a = from.phases[0], &b = to.phases[0];
  if (s > 0 && s < 1) {
    const float mean = (1 - s) * a.mean + s * (b.mean - shift);
    const float variance = (1 - s) * (1 - s) * a.variance + s * s * b.variance; // as if the one did not know of the other
    a.mean = mean, b.mean = mean + shift, a.variance = b.variance = variance;
  }
  if (s < 1) add_at_phases(all, blend.from, from, p, footprint, weight * (1 - s), mix);
  if (s > 0) add_at_phases(all, blend.to, to, p, footprint, weight * s, mix);
}

} // namespace

void add_material(const SampledMaterials& all, MaterialIndex index, const Vec3& p, const Footprint& footprint, float weight,
                  SurfaceMix& mix) {
  std::visit(
      [&]<class Kind>(const Kind& kind) {
        if constexpr (requires { kind.surface(); })
          mix.add(kind.surface(), weight);
        else if constexpr (std::is_same_v<Kind, PhaseBlend<SampledMode>>)
          add_phase_blend(all, kind, p, footprint, weight, mix);
        else
          add_stops(
              all, kind, [&](std::span<float> shares) { kind.shares(p, footprint, shares); }, p, footprint, weight, mix);
      },
      all[index.index]);
}

bool is_uniform(const SampledMaterials& all, MaterialIndex index) {
  return std::visit(
      [](const auto& kind) {
        return requires { kind.surface(); };
      },
      all[index.index]);
}

SurfaceParameters surface_of(const SampledMaterials& all, MaterialIndex index) {
  SurfaceMix mix;
  add_material(all, index, Vec3(0), {}, 1, mix);
  return mix.sum();
}

bool has_height(const SampledMaterials& all, MaterialIndex index) {
  return std::visit(
      [&](const auto& kind) {
        if constexpr (requires { kind.surface(); }) return kind.surface().bump_height != 0;
        bool found = false;
        for_each_value(
            [&]<class T>(const ParameterRules&, const T& value) {
              if constexpr (IsMaterialEdge<T>) found = found || has_height(all, value);
            },
            kind);
        return found;
      },
      all[index.index]);
}

} // namespace kelpie
