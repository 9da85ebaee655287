#include "materials/material.h"

#include <algorithm>
#include <array>

#include "base/one_of.h"

namespace kelpie {

template struct OneOf<MaterialKinds, AnimatedMode>;
template struct OneOf<MaterialKinds, SampledMode>;

namespace {

/// Shares of stops that need no memory of their own.
constexpr size_t k_few_stops = 16;

template <class Kind>
void add_pattern(const SampledMaterials& all, const Kind& pattern, const Vec3& p, const Footprint& footprint, float weight,
                 SurfaceMix& mix) {
  std::array<float, k_few_stops> few;
  std::vector<float> many;
  if (pattern.stops.size() > few.size()) many.resize(pattern.stops.size());
  const std::span<float> shares = many.empty() ? std::span(few).first(pattern.stops.size()) : std::span<float>(many);
  pattern.shares(p, footprint, shares);
  for (size_t i = 0; i < shares.size(); ++i)
    if (shares[i] > 0) add_material(all, pattern.stops[i].material, p, footprint, weight * shares[i], mix);
}

} // namespace

void add_material(const SampledMaterials& all, MaterialIndex index, const Vec3& p, const Footprint& footprint, float weight,
                  SurfaceMix& mix) {
  std::visit(
      [&](const auto& kind) {
        if constexpr (requires { kind.surface(); })
          mix.add(kind.surface(), weight);
        else
          add_pattern(all, kind, p, footprint, weight, mix);
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
        if constexpr (requires { kind.surface(); })
          return kind.surface().bump_height != 0;
        else
          return std::any_of(kind.stops.begin(), kind.stops.end(), [&](const auto& stop) { return has_height(all, stop.material); });
      },
      all[index.index]);
}

} // namespace kelpie
