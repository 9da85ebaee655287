#include "materials/phase_blend.h"

#include <array>

#include <fmt/format.h>

#include "base/sample_record.h"
#include "materials/material.h"

namespace kelpie {

namespace {

constexpr size_t k_phases = 256;

template <class Kind>
constexpr bool has_phase() {
  if constexpr (requires { Kind::k_domain; }) return Kind::k_domain.is_periodic;
  return false;
}
bool has_phase(const MaterialNode& material) {
  return std::visit([]<class Kind>(const Kind&) { return has_phase<Kind>(); }, material.kind);
}

/// How light a material is, about: of a pattern the mean of its stops.
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

/// Over a period, less their mean.
std::array<float, k_phases> lightness_of_phases(const MaterialNode& material, double frame) {
  std::array<float, k_phases> light{};
  const auto of_kind = [&]<template <class> class Kind>(const Kind<AnimatedMode>& kind) {
    if constexpr (has_phase<Kind<SampledMode>>()) {
      const std::vector<MaterialIndex> none(kind.stops.size());
      const auto pattern = sample_record(kind, frame, nullptr, none.data());
      std::vector<float> shares(kind.stops.size());
      for (size_t i = 0; i < k_phases; ++i) {
        pattern.shares(PhaseMixture({(float(i) + 0.5f) / k_phases, 0}), shares);
        for (size_t s = 0; s < shares.size(); ++s) light[i] += shares[s] * lightness(*kind.stops[s].material, frame);
      }
    }
  };
  std::visit(of_kind, material.kind);
  float mean = 0;
  for (const float l : light) mean += l / k_phases;
  for (float& l : light) l -= mean;
  return light;
}

} // namespace

std::optional<ParameterProblem> problem_of_phases(const AnimatedMode::Material& from, const AnimatedMode::Material& to) {
  for (const auto& [name, material] : {std::pair("from", &from), std::pair("to", &to)})
    if (*material && !has_phase(**material))
      return ParameterProblem{name, fmt::format("{}: expected a pattern with a phase (marble, wood, strata, stripes), found {}", name,
                                                std::visit([](const auto& kind) { return std::string(kind.k_name); }, (*material)->kind))};
  return {};
}

float best_phase_shift(const AnimatedMode::Material& from, const AnimatedMode::Material& to, double frame) {
  const auto a = lightness_of_phases(*from, frame), b = lightness_of_phases(*to, frame);
  size_t best = 0;
  float most = -std::numeric_limits<float>::infinity();
  for (size_t shift = 0; shift < k_phases; ++shift) {
    float likeness = 0;
    for (size_t i = 0; i < k_phases; ++i) likeness += a[i] * b[(i + shift) % k_phases];
    if (likeness > most) most = likeness, best = shift;
  }
  return float(best) / k_phases;
}

} // namespace kelpie
