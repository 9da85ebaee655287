#include "materials/material.h"

#include "base/one_of.h"
#include "base/sample_record.h"
#include "materials/add_stops.h"

namespace kelpie {

template struct OneOf<MaterialKinds, AnimatedMode>;
template struct OneOf<MaterialKinds, SampledMode>;

Vec3 mean_colour(const MaterialNode& material, double frame) {
  const auto of_kind = [&]<template <class> class Kind>(const Kind<AnimatedMode>& kind) {
    if constexpr (requires(Kind<SampledMode> k) { k.surface(); }) {
      const SurfaceParameters surface = sample_record(kind, frame).surface();
      return surface.base_color.rgb * surface.base_weight;
    } else {
      Vec3 sum(0);
      float count = 0;
      for_each_value(
          [&]<class T>(const ParameterRules&, const T& value) {
            if constexpr (IsMaterialEdge<T>) sum += mean_colour(*value, frame), ++count;
          },
          kind);
      return sum / std::max(count, 1.f);
    }
  };
  return std::visit(of_kind, material.kind);
}

template <class Mix>
void add_material(const SampledMaterials& all, MaterialIndex index, const Vec3& p, const Footprint& footprint, float weight, Mix& mix) {
  std::visit(
      [&]<class Kind>(const Kind& kind) {
        if constexpr (requires { kind.surface(); })
          mix.add(kind, weight);
        else if constexpr (std::is_same_v<Kind, Transition<SampledMode>>)
          add_transition(all, kind, p, footprint, weight, mix);
        else
          add_stops(
              all, kind, [&](std::span<float> shares) { kind.shares(p, footprint, shares); }, p, footprint, weight, mix);
      },
      all[index.index]);
}

template void add_material(const SampledMaterials&, MaterialIndex, const Vec3&, const Footprint&, float, SurfaceMix&);
template void add_material(const SampledMaterials&, MaterialIndex, const Vec3&, const Footprint&, float, HeightMix&);

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
