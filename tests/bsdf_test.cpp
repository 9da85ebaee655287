// Every kind of surface is held to the contract of BsdfModel, without a line for the kind: what is sampled is what is evaluated,
// on both sides of the surface, seen from outside and from inside.
#include <cmath>

#include <gtest/gtest.h>

#include "materials/surfaces.h"
#include "tests/support/bsdf_tally.h"
#include "tests/support/random_kind.h"

namespace kelpie {
namespace {

/// Random parameters, one in four at an end of its range: a mirror, or as rough as can be.
template <template <class> class Kind>
Kind<SampledMode> random_surface(Random& r) {
  Kind<SampledMode> kind = random_kind<Kind>(r);
  const auto to_an_end = [&](const auto& row) {
    if constexpr (std::is_same_v<decltype(kind.*(row.member)), float&>) {
      const int which = r.below(8);
      if (which == 0 && row.range.contains(row.range.lower)) kind.*(row.member) = float(row.range.lower);
      if (which == 1 && std::isfinite(row.range.upper)) kind.*(row.member) = float(row.range.upper);
    }
  };
  std::apply([&](const auto&... row) { (to_an_end(row), ...); }, Kind<SampledMode>::parameters());
  return kind;
}

/// In air or in water, from outside or inside.
Boundary random_boundary(const SurfaceParameters& s, Random& r) {
  const float around = r.below(3) ? 1 : 1.33f;
  return r.below(3) ? Boundary{around, s.specular_ior, false} : Boundary{s.specular_ior, around, true};
}

/// Calls test(bsdf, out, surface) for surfaces of every kind, as they are by default and with random parameters, seen from random sides;
/// as they are, and widened as they are after a matte surface.
template <class Test>
void for_each_surface(int trials, Test&& test) {
  SurfaceKinds::for_each([&]<template <class> class Kind>() {
    for (int trial = 0; trial < trials; ++trial) {
      SCOPED_TRACE(testing::Message() << Kind<SampledMode>::k_name << ", trial " << trial);
      Random r(static_cast<unsigned>(trial));
      const SurfaceParameters surface = trial == 0 ? Kind<SampledMode>{}.surface() : random_surface<Kind>(r).surface();
      const SurfaceBsdf bsdf(surface, trial == 0 ? Boundary::in_air(surface) : random_boundary(surface, r));
      const Vec3 out = direction(r.uniform(0.1, 1), r.uniform(0, 2 * std::numbers::pi));
      test(trial % 4 == 3 ? bsdf.at_least_as_rough_as(0.3f) : bsdf, out, surface);
    }
  });
}

constexpr uint32_t k_samples = 8192;

TEST(Bsdf, SamplesAgreeWithEvaluation) {
  int compared = 0;
  for_each_surface(60, [&](const SurfaceBsdf& bsdf, const Vec3& out, const SurfaceParameters&) {
    // A direction in floats tells places in a lobe apart the worse, the narrower the lobe is: the higher its peak.
    float peak = 0;
    for (uint32_t i = 0; i < 300; ++i)
      if (const BsdfSample s = sample(bsdf, out, i); !s.is_delta && !s.goes_below) peak = std::max(peak, s.pdf);
    const float tolerance = 3e-3f + 2.5e-5f * peak;
    for (uint32_t i = 0; i < 300; ++i) {
      const BsdfSample s = sample(bsdf, out, i);
      if (s.pdf <= 0) continue;
      ASSERT_NEAR(glm::length(s.direction), 1, 1e-5);
      ASSERT_GT(s.eta, 0);
      if (s.is_delta) {
        EXPECT_LE(s.pdf, 1);
        EXPECT_TRUE(bsdf.is_glossy()); // or the path would not look for light there
        continue;
      }
      if (s.goes_below) {
        EXPECT_LE(s.pdf, 1);
        EXPECT_LT(s.direction.z, 0);
        continue;
      }
      compared += tolerance < 0.02f;
      EXPECT_FALSE(bsdf.is_delta());
      EXPECT_NEAR(s.pdf, bsdf.pdf(out, s.direction), tolerance * s.pdf);
      const Vec3 f = bsdf.evaluate(out, s.direction);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(f[c], s.weight[c] * s.pdf, tolerance * s.weight[c] * s.pdf + 1e-6f);
    }
  });
  EXPECT_GT(compared, 10000);
}

// A furnace on each side: the density's integral is the share of the samples, and that of what is evaluated is their weight.
TEST(Bsdf, DensityAndEnergyAreThoseOfTheSamples) {
  int compared = 0;
  constexpr double k_tolerance = 0.015; // 8192 stratified samples; a grid of 256 x 256
  for_each_surface(24, [&](const SurfaceBsdf& bsdf, const Vec3& out, const SurfaceParameters& surface) {
    const Tallies by_samples = sampled(bsdf, out, k_samples);
    double density = 0;
    for (const bool transmitted : {false, true}) {
      const Tally& side = by_samples.sides[transmitted];
      const Tally by_grid = integrated(bsdf, out, side, transmitted);
      // The grid does not see a lobe that is a line.
      if (surface.specular_roughness_anisotropy > 0.95f) continue;
      ++compared;
      EXPECT_NEAR(by_grid.probability, side.probability, k_tolerance) << transmitted;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(by_grid.scattered[c], side.scattered[c], k_tolerance) << transmitted;
      density += by_grid.probability;
    }
    EXPECT_LE(density, 1 + k_tolerance);
    // No light is made. Of brushed surfaces what is lost, and so repaid, is an estimate; below a film nearly so.
    const bool is_brushed = surface.specular_roughness_anisotropy > 0, has_film = surface.thin_film_weight > 0;
    const double most = is_brushed ? 1.25 : has_film ? 1.03 : 1 + k_tolerance;
    for (int c = 0; c < 3; ++c) EXPECT_LE(by_samples.energy[c], most);
  });
  EXPECT_GT(compared, 150); // of 4 kinds, 24 trials and 2 sides
}

// Behind the surface nobody looks at it.
TEST(Bsdf, NothingIsSeenFromBehindTheNormal) {
  for_each_surface(20, [&](const SurfaceBsdf& bsdf, const Vec3& out, const SurfaceParameters&) {
    const Vec3 behind(out.x, out.y, -out.z);
    for (uint32_t i = 0; i < 50; ++i) {
      EXPECT_EQ(sample(bsdf, behind, i).pdf, 0);
      const Vec3 in = sample(bsdf, out, i).direction;
      EXPECT_EQ(bsdf.pdf(behind, in), 0);
      EXPECT_EQ(bsdf.evaluate(behind, in), Vec3(0));
    }
  });
}

bool is_sane(const Vec3& v) { return v.x >= 0 && v.y >= 0 && v.z >= 0 && std::isfinite(v.x + v.y + v.z); }

// Where a formula divides by what can be 0: the horizon, straight on, and directions that no microfacet joins.
TEST(Bsdf, ExtremeDirectionsAreFinite) {
  for_each_surface(200, [&](const SurfaceBsdf& bsdf, const Vec3& some, const SurfaceParameters&) {
    for (const float cosine : {1e-20f, 1e-6f, 1e-3f, 1.f}) {
      const Vec3 out =
          cosine == 1 ? Vec3(0, 0, 1) : glm::normalize(Vec3(some.x, some.y, 0)) * std::sqrt(1 - cosine * cosine) + Vec3(0, 0, cosine);
      for (const Vec3& in :
           {Vec3(0, 0, 1), Vec3(0, 0, -1), -out, Vec3(-out.x, -out.y, out.z), Vec3(out.x, out.y, -out.z), Vec3(1, 0, 0), some, -some}) {
        EXPECT_TRUE(is_sane(bsdf.evaluate(out, in)));
        EXPECT_TRUE(is_sane(Vec3(bsdf.pdf(out, in))));
      }
      for (uint32_t i = 0; i < 16; ++i) {
        const BsdfSample s = sample(bsdf, out, i);
        EXPECT_TRUE(is_sane(s.weight) && s.pdf >= 0 && std::isfinite(s.pdf));
      }
    }
  });
}

} // namespace
} // namespace kelpie
