// What patterns of cells have in common.
#pragma once

#include <array>

#include "materials/patterns/solid_texture.h"
#include "materials/patterns/worley.h"

namespace kelpie {

/// How much a pattern of unit cells is its mean over a footprint.
inline float cells_unseen(const Place& place) { return unseen(1.3f * place.blind_width()); }
/// And how much one of distances to their points, or to their borders, is: of these, gradients say little beyond half a cell.
inline float distances_unseen(const Place& place) { return unseen(2.2f * place.blind_width()); }
inline float borders_unseen(const Place& place) { return unseen(3.2f * place.blind_width()); }

/// How distances in Worley's cells are distributed: what makes all phases of a pattern alike, so that a phase is the part of space
/// where the distance is less. Measured at 25 equal steps from 0.
struct DistanceRanks {
  float step;
  std::array<float, 25> below;  ///< the phase
  std::array<float, 25> spread; ///< the mean square of its gradient

  /// The phase of a distance with this gradient. Below 0 it is mirrored: distances are.
  SpreadPhase phase(float distance, const Vec3& gradient, const Place& place) const {
    const float at = std::min(distance / step, 23.999f);
    const auto i = static_cast<size_t>(at);
    const float rise = below[i + 1] - below[i], slope = rise / step;
    // Phases drift where the spread changes, or they would no longer be alike (Fick's law): as if mixed by half the mean variance.
    const float mixed = 0.5f * place.mean_variance() * (spread[i + 1] - spread[i]) / std::max(rise, 1e-4f);
    return {std::abs(below[i] + rise * (at - static_cast<float>(i)) + mixed), slope * slope * place.variance(gradient)};
  }
};

/// Of the distance to the nearest point.
inline constexpr DistanceRanks k_nearest_ranks{
    0.05f,
    {0.0000f, 0.0005f, 0.0042f, 0.0142f, 0.0335f, 0.0652f, 0.1121f, 0.1759f, 0.2575f, 0.3553f, 0.4659f, 0.5819f, 0.6949f,
     0.7956f, 0.8763f, 0.9341f, 0.9700f, 0.9887f, 0.9966f, 0.9992f, 0.9999f, 1,       1,       1,       1},
    {0.000f, 0.001f, 0.017f, 0.081f, 0.253f, 0.609f, 1.222f, 2.109f, 3.250f, 4.392f, 5.221f, 5.353f, 4.675f,
     3.332f, 1.928f, 0.861f, 0.282f, 0.063f, 0.009f, 0.001f, 0,      0,      0,      0,      0}};
/// Of F2 - F1.
inline constexpr DistanceRanks k_border_ranks{
    0.04f,
    {0.0000f, 0.1415f, 0.2680f, 0.3808f, 0.4811f, 0.5693f, 0.6468f, 0.7144f, 0.7726f, 0.8221f, 0.8635f, 0.8975f, 0.9251f,
     0.9468f, 0.9633f, 0.9756f, 0.9845f, 0.9906f, 0.9946f, 0.9970f, 0.9985f, 0.9993f, 0.9997f, 0.9999f, 1},
    {32.617f, 27.619f, 22.145f, 17.512f, 13.702f, 10.507f, 8.006f, 5.981f, 4.332f, 3.044f, 2.073f, 1.368f, 0.858f,
     0.508f,  0.286f,  0.152f,  0.074f,  0.033f,  0.013f,  0.005f, 0.002f, 0,      0,      0,      0}};

/// The phase of the distance to the border of a cell, or that of the distance to its point.
inline SpreadPhase border_phase(const WorleyCell& cell, const Place& place) {
  return k_border_ranks.phase(cell.border(), cell.border_gradient(), place);
}
inline SpreadPhase nearest_phase(const WorleyCell& cell, const Place& place) {
  return k_nearest_ranks.phase(cell.first.distance, WorleyCell::direction(cell.first), place);
}

/// The phases of the distance to the borders of cells, at a place that `turbulent` has moved.
template <class Turbulent>
PhaseMixture border_mixture(const Place& straight, const Turbulent& turbulent, uint32_t seed) {
  const float lost = borders_unseen(straight);
  if (lost == 1) return k_all_phases;
  const Place place = turbulent(straight).turned();
  PhaseMixture mixture(border_phase(worley(place.p, seed), place));
  mixture.cover(k_all_phases, lost);
  return mixture;
}

/// The two cells that a footprint is in, and which part of it is in the first.
struct TwoCells {
  WorleyCell cell;
  float part = 1;

  TwoCells(const Place& place, uint32_t seed) : cell(worley(place.p, seed)) {
    const float width = std::sqrt(12 * place.variance(cell.plane_normal())); // of a box with that variance
    if (width > 0) part = std::min(0.5f + cell.plane_distance() / width, 1.f);
  }

  /// The mean over both of what `of` says of each.
  template <class Of>
  float mean(const Of& of) const {
    return part < 1 ? part * of(cell.first) + (1 - part) * of(cell.second) : of(cell.first);
  }
};

/// The mean volume of the balls of `ball_part` where every cube has one: radii are evenly from half the largest to it.
constexpr float ball_volume(float radius) { return 4.18879020f * radius * radius * radius * 0.46875f; }

/// The part of a footprint in balls of random radius, up to `radius`: one in each cube of the unit lattice that has one, which is the
/// part `filled` of all. Balls lie in their cubes.
inline float ball_part(const Place& place, float radius, float filled, uint32_t seed) {
  const float lost = unseen(place.blind_width() / radius), mean = filled * ball_volume(radius);
  if (lost == 1) return mean;
  const WorleyPoint ball = worley(place.p, seed, 1 - 2 * radius).first;
  if (unit_of(ball.id) >= filled) return lost * mean;
  const float own = radius * (0.5f + 0.5f * unit_of(scrambled(ball.id)));
  const float variance = place.variance(WorleyCell::direction(ball)), width = std::sqrt(12 * variance);
  // There is more room outside a ball's border than inside: a soft ball of the same volume is smaller, to first order by this.
  const float to_border = own - std::min(variance / own, 0.5f * own) - ball.distance;
  const float seen = width > 0 ? std::clamp(0.5f + to_border / width, 0.f, 1.f) : static_cast<float>(to_border > 0);
  return lost * mean + (1 - lost) * seen;
}

} // namespace kelpie
