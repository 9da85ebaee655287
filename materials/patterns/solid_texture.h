// What all patterns have in common: their parameters, and how phases become shares of stops.
//
// A pattern describes what there is over a footprint as a mixture of phases, each spread normally: the mean, the variance, the weight.
// Its `profile` takes a phase to a value in [0, 1], and stops lie at values. The shares of stops over a footprint, not the stop at
// the mean value, come from a table of the profile (materials/patterns/share_table.h), made once a moment.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "materials/patterns/pattern.h"
#include "materials/patterns/place.h"
#include "materials/patterns/share_table.h"

namespace kelpie {

/// A phase over a footprint: normally distributed, in a part of the footprint.
struct SpreadPhase {
  float mean = 0, variance = 0;
  float weight = 1;
};

/// What there is over a footprint: some phases whose weights sum to 1.
struct PhaseMixture {
  std::array<SpreadPhase, 4> phases{};
  size_t count = 0;

  PhaseMixture(const SpreadPhase& phase) : count(1) { phases[0] = phase; }

  /// Puts a phase over all so far: it covers a part of them.
  void cover(const SpreadPhase& phase, float part) {
    for (size_t i = 0; i < count; ++i) phases[i].weight *= 1 - part;
    phases[count++] = {phase.mean, phase.variance, part};
  }

  /// Only what covers the first one.
  PhaseMixture without_first() const {
    PhaseMixture rest = *this;
    rest.phases[0].weight = 0;
    return rest;
  }
  /// Calls use(phase) for each that has weight.
  template <class Use>
  void for_each(const Use& use) const {
    for (size_t i = 0; i < count; ++i)
      if (phases[i].weight > 0) use(phases[i]);
  }
};

/// All phases of a domain alike.
inline constexpr SpreadPhase k_all_phases{0.5f, 1e6f};

/// What differs from pattern to pattern of the parameters that all have.
struct PatternDefaults {
  float size = 1;
  float turbulence = 0, turbulence_size = 1, turbulence_octaves = 4;
};

template <class Mode>
struct PatternParameters {
  Value<Mode, float> size;
  int seed = 0;
  Value<Mode, float> turbulence, turbulence_size, turbulence_octaves;
  Value<Mode, float> warp{0.f}, warp_size{4.f};
  Value<Mode, float> contrast{1.f}, bias{0.f};
  std::vector<Stop<Mode>> stops;

  explicit PatternParameters(const PatternDefaults& defaults = {})
      : size{defaults.size}, turbulence{defaults.turbulence}, turbulence_size{defaults.turbulence_size}, turbulence_octaves{
                                                                                                             defaults.turbulence_octaves} {}

protected:
  /// The rows of these.
  static constexpr auto common_parameters() {
    using P = PatternParameters;
    return std::tuple{
        parameter("size", &P::size, "of one period, or of its features: of one cell, one square").in(Unit::length).above(0),
        parameter("seed", &P::seed, "which of all patterns alike it is"),
        parameter("turbulence", &P::turbulence, "how far fractal noise shifts it, in sizes: the standard deviation").at_least(0),
        parameter("turbulence_size", &P::turbulence_size, "of the coarsest features of that noise, in sizes").above(0),
        parameter("turbulence_octaves", &P::turbulence_octaves,
                  "each has half the size and half the height of the one before; the last may be in part")
            .at_least(1)
            .at_most(12),
        parameter("warp", &P::warp, "how far smooth noise bends the space of the pattern, in sizes: the standard deviation").at_least(0),
        parameter("warp_size", &P::warp_size, "of the features of that noise, in sizes").above(0),
        parameter("contrast", &P::contrast, "stretches the values about 1/2; what leaves 0 to 1 is clamped").at_least(0),
        parameter("bias", &P::bias, "added to the values, after `contrast`").at_least(-1).at_most(1),
        parameter("stops", &P::stops,
                  "the materials that it ranges over, by ascending `at`; below the first and above the last it is these"),
    };
  }
};

/// A kind of pattern. `Kind<Mode>` derives from it and says
///   static constexpr PhaseDomain k_domain;            its phases
///   float profile(float phase) const;                 the value of a phase, in [0, 1], before contrast and bias
///   PhaseMixture mixture(const Place&) const;         what phases there are over a footprint
template <template <class> class Kind, class Mode>
struct SolidTexture : PatternParameters<Mode> {
  using PatternParameters<Mode>::PatternParameters;

  // Sampled:

  /// What phases there are over the footprint.
  PhaseMixture phases(const Vec3& p, const Footprint& footprint) const {
    const Place straight = Place{p, footprint}.scaled(1 / this->size);
    return kind().mixture(straight.displaced(this->warp, this->warp_size, 1, stream(1)));
  }

  /// The mean value over the footprint.
  float value(const Vec3& p, const Footprint& footprint) const {
    float sum = 0;
    phases(p, footprint).for_each([&](const SpreadPhase& phase) { sum += phase.weight * table_->value(phase.mean, phase.variance); });
    return sum;
  }

  /// The mean share of each stop where there are these phases, or over the footprint.
  void shares(const PhaseMixture& mixture, std::span<float> out) const {
    std::fill(out.begin(), out.end(), 0.f);
    mixture.for_each([&](const SpreadPhase& phase) { table_->add_shares(phase.mean, phase.variance, phase.weight, out); });
  }
  void shares(const Vec3& p, const Footprint& footprint, std::span<float> out) const { shares(phases(p, footprint), out); }
  /// The share of each stop where the value is this one.
  void shares(float value, std::span<float> out) const {
    for (size_t i = 0; i < out.size(); ++i) out[i] = static_cast<float>(i == 0);
    for (size_t i = 0; i + 1 < out.size() && value > this->stops[i].at; ++i) {
      const float width = this->stops[i + 1].at - this->stops[i].at;
      out[i + 1] = width > 0 ? std::min(1.f, (value - this->stops[i].at) / width) : 1.f;
      out[i] = 1 - out[i + 1];
    }
  }

  /// Makes the table; to be called again when a parameter has changed.
  void prepare() {
    std::vector<float> at;
    for (const auto& stop : this->stops) at.push_back(stop.at);
    if (at.empty())
      for (const PlainStop& stop : Kind<Mode>::k_default_stops) at.push_back(stop.at);
    table_ = std::make_shared<const ShareTable>(Kind<Mode>::k_domain, at, [this](float phase) { return value_of_phase(phase); });
  }

  /// Of a phase in the domain.
  float value_of_phase(float phase) const {
    return std::clamp(0.5f + this->contrast * (kind().profile(phase) - 0.5f) + this->bias, 0.f, 1.f);
  }

protected:
  /// A seed for each of the random functions of the pattern.
  uint32_t stream(uint32_t number) const { return scrambled(static_cast<uint32_t>(this->seed) + 0x9e3779b9u * (number + 1)); }

  /// `phase`, which has this gradient, shifted by turbulence.
  SpreadPhase turbulent(const Place& place, float phase, const Vec3& gradient) const {
    if (this->turbulence == 0) return {phase, place.variance(gradient)};
    const Place noise_place = place.scaled(1 / this->turbulence_size);
    const NoiseSample noise = noise_place.noise({.octaves = this->turbulence_octaves, .seed = stream(0)});
    const Vec3 slope = noise.gradient * (this->turbulence / this->turbulence_size);
    return {phase + this->turbulence * noise.value,
            place.variance(gradient + slope) + this->turbulence * this->turbulence * noise.variance};
  }
  /// The place shifted by turbulence in all directions.
  Place turbulent(const Place& place) const {
    return place.displaced(this->turbulence, this->turbulence_size, this->turbulence_octaves, stream(0));
  }

private:
  const Kind<Mode>& kind() const { return static_cast<const Kind<Mode>&>(*this); }

  std::shared_ptr<const ShareTable> table_;
};

} // namespace kelpie
