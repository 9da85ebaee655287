// What a reflectance model does with light, by its samples and by quadrature.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "materials/surface_bsdf.h"
#include "base/orthonormal_basis.h"
#include "renderer/integrate/sampler.h"

namespace kelpie {

inline Vec3 direction(double cosine, double phi) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return Vec3(sine * std::cos(phi), sine * std::sin(phi), cosine);
}

inline BsdfSample sample(const SurfaceBsdf& bsdf, const Vec3& out, uint32_t i) {
  const Vec3 u = Sampler(1, 2, 3, i).next_triple();
  return bsdf.sample(out, u.z, Vec2(u.x, u.y));
}

/// What a surface does on one side.
struct Tally {
  double probability = 0; ///< that a sample goes there
  Vec3d scattered{0};     ///< energy of light that is the same from everywhere, without deltas
  Vec3 peak{0, 0, 1};     ///< the direction that is sampled most
  float peak_pdf = 0;
  double eta = 1; ///< index of refraction there
};

/// Both sides of it: above, below. Energy is radiance times the square of the index of refraction, which no surface changes.
struct Tallies {
  std::array<Tally, 2> sides;
  Vec3d energy{0}; ///< of all samples
};

inline Tallies sampled(const SurfaceBsdf& bsdf, const Vec3& out, uint32_t samples) {
  Tallies t;
  for (uint32_t i = 0; i < samples; ++i) {
    const BsdfSample s = sample(bsdf, out, i);
    if (s.pdf <= 0) continue;
    const Vec3d energy = Vec3d(s.weight) * (double(s.eta) * s.eta / samples);
    t.energy += energy;
    if (s.is_delta || s.goes_below) continue;
    Tally& side = t.sides[s.is_transmitted()];
    side.probability += 1.0 / samples, side.scattered += energy, side.eta = s.eta;
    if (s.pdf > side.peak_pdf) side.peak_pdf = s.pdf, side.peak = s.direction;
  }
  return t;
}

/// The same side by quadrature, finest where samples are densest.
inline Tally integrated(const SurfaceBsdf& bsdf, const Vec3& out, const Tally& side, bool transmitted) {
  constexpr int n = 256;
  const OrthonormalBasis around(transmitted == (side.peak.z < 0) ? side.peak : -side.peak);
  Tally tally;
  for (int i = 0; i < n; ++i) {
    const double t = (i + 0.5) / n, theta = std::numbers::pi * t * t * t * t;
    const double solid_angle = std::sin(theta) * 4 * std::numbers::pi * t * t * t / n * 2 * std::numbers::pi / n;
    for (int j = 0; j < n; ++j) {
      const Vec3 in = around.world_from_local(direction(std::cos(theta), 2 * std::numbers::pi * (j + 0.5) / n));
      if ((in.z < 0) != transmitted) continue;
      tally.probability += bsdf.pdf(out, in) * solid_angle;
      tally.scattered += Vec3d(bsdf.evaluate(out, in)) * (side.eta * side.eta * solid_angle);
    }
  }
  return tally;
}

} // namespace kelpie
