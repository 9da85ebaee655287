// How a pattern becomes a mix of the materials that it ranges over.
#pragma once

#include <array>
#include <span>

#include "materials/material.h"

namespace kelpie {

/// Adds as much of each stop's material as `shares_of(std::span<float>)` says.
template <class Pattern, class SharesOf, class Mix>
void add_stops(const SampledMaterials& all, const Pattern& pattern, const SharesOf& shares_of, const Vec3& p, const Footprint& footprint,
               float weight, Mix& mix) {
  std::array<float, 16> few; // need no memory of their own
  std::vector<float> many;
  if (pattern.stops.size() > few.size()) many.resize(pattern.stops.size());
  const std::span<float> shares = many.empty() ? std::span(few).first(pattern.stops.size()) : std::span<float>(many);
  shares_of(shares);
  for (size_t i = 0; i < shares.size(); ++i)
    if (shares[i] > 0) add_material(all, pattern.stops[i].material, p, footprint, weight * shares[i], mix);
}

/// Adds a transition, as add_material() does.
template <class Mix>
void add_transition(const SampledMaterials&, const Transition<SampledMode>&, const Vec3& p, const Footprint&, float weight, Mix&);

} // namespace kelpie
