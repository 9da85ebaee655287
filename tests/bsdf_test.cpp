// Every kind of surface is held to the contract of BsdfModel, without a line for the kind: what is sampled is what is evaluated,
// on both sides of the surface.
#include <cmath>

#include <gtest/gtest.h>

#include "renderer/integrate/bsdf.h"
#include "renderer/integrate/orthonormal_basis.h"
#include "renderer/integrate/sampler.h"
#include "tests/support/random_kind.h"

namespace kelpie {
namespace {

constexpr double k_pi = 3.14159265358979;

Vec3 direction(double cosine, double phi) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return Vec3(sine * std::cos(phi), sine * std::sin(phi), cosine);
}

/// Random parameters, one in four at an end of its range: a mirror, or as rough as can be.
template <template <class> class Kind>
Kind<SampledMode> random_surface(Random& r) {
  Kind<SampledMode> kind = random_kind<Kind>(r);
  const auto to_an_end = [&](const auto& row) {
    if constexpr (std::is_same_v<decltype(kind.*(row.member)), float&>) {
      const int which = r.below(8);
      if (which == 0 && row.range.contains(row.range.lower)) kind.*(row.member) = float(row.range.lower);
      if (which == 1 && row.range.contains(row.range.upper)) kind.*(row.member) = float(row.range.upper);
    }
  };
  std::apply([&](const auto&... row) { (to_an_end(row), ...); }, Kind<SampledMode>::parameters());
  return kind;
}

/// Calls test(bsdf, out) for surfaces of every kind, as they are by default and with random parameters, seen from random sides;
/// as they are, and widened as they are after a matte surface.
template <class Test>
void for_each_surface(int trials, Test&& test) {
  SurfaceKinds::for_each([&]<template <class> class Kind>() {
    for (int trial = 0; trial < trials; ++trial) {
      SCOPED_TRACE(testing::Message() << Kind<SampledMode>::k_name << ", trial " << trial);
      Random r(static_cast<unsigned>(trial));
      const Bsdf bsdf(trial == 0 ? Kind<SampledMode>{} : random_surface<Kind>(r));
      const Vec3 out = direction(r.uniform(0.1, 1), r.uniform(0, 2 * k_pi));
      test(trial % 4 == 3 ? bsdf.at_least_as_rough_as(0.3f) : bsdf, out);
    }
  });
}

constexpr uint32_t k_samples = 8192;

BsdfSample sample(const Bsdf& bsdf, const Vec3& out, uint32_t i) {
  const Vec3 u = Sampler(1, 2, 3, i).next_triple();
  return bsdf.sample(out, u.z, Vec2(u.x, u.y));
}

TEST(Bsdf, SamplesAgreeWithEvaluation) {
  int compared = 0;
  for_each_surface(60, [&](const Bsdf& bsdf, const Vec3& out) {
    // A direction in floats tells places in a lobe apart the worse, the narrower the lobe is: the higher its peak.
    float peak = 0;
    for (uint32_t i = 0; i < 300; ++i)
      if (const BsdfSample s = sample(bsdf, out, i); !s.is_delta) peak = std::max(peak, s.pdf);
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
      compared += tolerance < 0.02f;
      EXPECT_FALSE(bsdf.is_delta());
      EXPECT_NEAR(s.pdf, bsdf.pdf(out, s.direction), tolerance * s.pdf);
      const Vec3 f = bsdf.evaluate(out, s.direction);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(f[c], s.weight[c] * s.pdf, tolerance * s.weight[c] * s.pdf + 1e-6f);
    }
  });
  EXPECT_GT(compared, 10000);
}

/// What a surface does on one side.
struct Tally {
  double probability = 0; ///< that a sample goes there
  Vec3d scattered{0};     ///< of light that is the same from everywhere, without deltas
  Vec3d mean{0};          ///< direction
};

/// Of many samples: the upper side, the lower one.
std::array<Tally, 2> sampled(const Bsdf& bsdf, const Vec3& out, Vec3d& of_deltas) {
  std::array<Tally, 2> sides;
  for (uint32_t i = 0; i < k_samples; ++i) {
    const BsdfSample s = sample(bsdf, out, i);
    if (s.pdf <= 0) continue;
    const Vec3d weight = Vec3d(s.weight) / double(k_samples);
    if (s.is_delta) {
      of_deltas += weight;
      continue;
    }
    Tally& side = sides[s.is_transmitted()];
    side.probability += 1.0 / k_samples, side.scattered += weight, side.mean += Vec3d(s.direction);
  }
  return sides;
}

/// By quadrature, finest around `pole`.
Tally integrated(const Bsdf& bsdf, const Vec3& out, const Vec3& pole, bool transmitted) {
  constexpr int n = 256;
  const OrthonormalBasis around(pole);
  Tally tally;
  for (int i = 0; i < n; ++i) {
    const double t = (i + 0.5) / n, theta = k_pi * t * t * t * t;
    const double solid_angle = std::sin(theta) * 4 * k_pi * t * t * t / n * 2 * k_pi / n;
    for (int j = 0; j < n; ++j) {
      const Vec3 in = around.world_from_local(direction(std::cos(theta), 2 * k_pi * (j + 0.5) / n));
      if ((in.z < 0) != transmitted) continue;
      tally.probability += bsdf.pdf(out, in) * solid_angle;
      tally.scattered += Vec3d(bsdf.evaluate(out, in)) * solid_angle;
    }
  }
  return tally;
}

// A furnace on each side: the density's integral is the share of the samples, and that of what is evaluated is their weight.
TEST(Bsdf, DensityAndEnergyAreThoseOfTheSamples) {
  constexpr double k_tolerance = 0.015; // 8192 stratified samples; a grid of 256 x 256
  for_each_surface(24, [&](const Bsdf& bsdf, const Vec3& out) {
    Vec3d total(0);
    const std::array<Tally, 2> sides = sampled(bsdf, out, total);
    double density = 0;
    for (const bool transmitted : {false, true}) {
      const Tally& by_samples = sides[transmitted];
      const Vec3 pole = by_samples.probability > 0 ? Vec3(glm::normalize(by_samples.mean)) : Vec3(0, 0, transmitted ? -1 : 1);
      const Tally by_grid = integrated(bsdf, out, pole, transmitted);
      EXPECT_NEAR(by_grid.probability, by_samples.probability, k_tolerance) << transmitted;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(by_grid.scattered[c], by_samples.scattered[c], k_tolerance) << transmitted;
      density += by_grid.probability, total += by_samples.scattered;
    }
    EXPECT_LE(density, 1 + k_tolerance);
    for (int c = 0; c < 3; ++c) EXPECT_LE(total[c], 1 + k_tolerance); // no light is made
  });
}

// Behind the surface nobody looks at it.
TEST(Bsdf, NothingIsSeenFromBehindTheNormal) {
  for_each_surface(20, [&](const Bsdf& bsdf, const Vec3& out) {
    const Vec3 behind(out.x, out.y, -out.z);
    for (uint32_t i = 0; i < 50; ++i) {
      EXPECT_EQ(sample(bsdf, behind, i).pdf, 0);
      const Vec3 in = sample(bsdf, out, i).direction;
      EXPECT_EQ(bsdf.pdf(behind, in), 0);
      EXPECT_EQ(bsdf.evaluate(behind, in), Vec3(0));
    }
  });
}

// White metal loses what meets a second microfacet: all light is back where it is smooth, a third where it is as rough as can be.
TEST(Bsdf, WhiteMetalLosesLightWithRoughness) {
  for (const auto& [roughness, least, most] : {std::array{0.0f, 1.f, 1.f}, std::array{0.2f, 0.99f, 1.f}, std::array{1.f, 0.25f, 0.6f}}) {
    Metal<SampledMode> metal;
    metal.colour.rgb = Vec3(1), metal.roughness = roughness;
    Vec3d deltas(0);
    const std::array<Tally, 2> sides = sampled(Bsdf(metal), direction(0.7, 0), deltas);
    const double light = deltas.x + sides[0].scattered.x;
    EXPECT_GE(light, least - 1e-4);
    EXPECT_LE(light, most + 1e-4);
    EXPECT_EQ(sides[1].probability, 0);
  }
}

} // namespace
} // namespace kelpie
