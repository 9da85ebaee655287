// The surface's reflectance model against what is known: furnaces, Fresnel's published values, symmetries.
#include <gtest/gtest.h>

#include "materials/energy_table.h"
#include "materials/presets.h"
#include "materials/surfaces.h"
#include "tests/support/bsdf_tally.h"

namespace kelpie {
namespace {

constexpr uint32_t k_surface_samples = 32768;
constexpr std::array k_roughnesses{0.0f, 0.1f, 0.2f, 0.35f, 0.5f, 0.8f, 1.0f};
constexpr std::array k_cosines{0.15, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0};

SurfaceParameters white(const SurfaceParameters& s) {
  SurfaceParameters w = s;
  w.base_color.rgb = Vec3(1);
  return w;
}
SurfaceParameters white_metal(float roughness, float anisotropy = 0) {
  SurfaceParameters s = white({});
  s.base_metalness = 1, s.specular_roughness = roughness, s.specular_roughness_anisotropy = anisotropy;
  return s;
}
SurfaceParameters plastic(float roughness, float ior, float weight = 1) {
  SurfaceParameters s = white({});
  s.specular_roughness = roughness, s.specular_ior = ior, s.specular_weight = weight;
  return s;
}
SurfaceParameters clear_glass(float roughness, float ior) {
  Glass<SampledMode> glass;
  glass.roughness = roughness, glass.ior = ior;
  return glass.surface();
}
Boundary inside(const SurfaceParameters& s) { return {s.specular_ior, 1, true}; }

/// All of the energy that comes in goes out, whatever the angle.
void expect_white(const SurfaceBsdf& bsdf, double tolerance = 0.01) {
  for (const double cosine : k_cosines) {
    const Vec3d energy = sampled(bsdf, direction(cosine, 0.4), k_surface_samples).energy;
    EXPECT_NEAR(energy.x, 1, tolerance) << "cosine " << cosine;
    EXPECT_EQ(energy.x, energy.y);
  }
}

TEST(WhiteFurnace, Metal) {
  for (const float roughness : k_roughnesses) {
    SCOPED_TRACE(roughness);
    expect_white(SurfaceBsdf(white_metal(roughness)));
  }
}

// What brushed metal loses is estimated from its mean width.
TEST(WhiteFurnace, BrushedMetalWithin5PerCent) {
  for (const float roughness : {0.1f, 0.3f, 0.5f, 0.7f}) {
    SCOPED_TRACE(roughness);
    expect_white(SurfaceBsdf(white_metal(roughness, 0.5f)), 0.05);
  }
}

TEST(WhiteFurnace, DielectricOverWhiteGround) {
  for (const float roughness : k_roughnesses)
    for (const float ior : {1.2f, 1.5f, 2.4f})
      for (const float weight : {0.5f, 1.f}) {
        SCOPED_TRACE(testing::Message() << roughness << " " << ior << " " << weight);
        expect_white(SurfaceBsdf(plastic(roughness, ior, weight)));
      }
}

TEST(WhiteFurnace, GlassFromOutsideAndInside) {
  for (const float roughness : k_roughnesses)
    for (const float ior : {1.2f, 1.5f, 2.42f}) {
      SCOPED_TRACE(testing::Message() << roughness << " " << ior);
      const SurfaceParameters s = clear_glass(roughness, ior);
      expect_white(SurfaceBsdf(s));
      expect_white(SurfaceBsdf(s, inside(s)));
    }
}

TEST(WhiteFurnace, CoatOverWhiteGroundAndMetal) {
  for (const float roughness : k_roughnesses)
    for (const float metalness : {0.f, 1.f}) {
      SCOPED_TRACE(testing::Message() << roughness << " " << metalness);
      SurfaceParameters s = plastic(0.4f, 1.5f);
      s.coat_weight = 0.8f, s.coat_roughness = roughness, s.base_metalness = metalness;
      expect_white(SurfaceBsdf(s));
    }
}

TEST(WhiteFurnace, RoughGround) {
  for (const float roughness : {0.f, 0.3f, 1.f}) {
    Matte<SampledMode> matte;
    matte.colour.rgb = Vec3(1), matte.roughness = roughness;
    expect_white(SurfaceBsdf(matte.surface()));
  }
}

// A coloured ground is a little darker where it is rough, never brighter than its colour.
TEST(SurfaceBsdf, RoughGroundKeepsAboutItsAlbedo) {
  Matte<SampledMode> matte;
  matte.colour.rgb = Vec3(0.8f, 0.5f, 0.1f), matte.roughness = 1;
  for (const double cosine : k_cosines) {
    const Vec3d energy = sampled(SurfaceBsdf(matte.surface()), direction(cosine, 0), k_surface_samples).energy;
    for (int c = 0; c < 3; ++c) {
      EXPECT_LT(energy[c], matte.colour.rgb[c] * 1.01);
      EXPECT_GT(energy[c], matte.colour.rgb[c] * 0.7);
    }
  }
}

TEST(Fresnel, HasPublishedValues) {
  EXPECT_NEAR(fresnel_dielectric(1, 1.5f), 0.04, 1e-5);
  EXPECT_NEAR(fresnel_dielectric(0.5f, 1.5f), 0.0892, 2e-4); // 60 degrees: Hecht, "Optics", fig. 4.49
  EXPECT_NEAR(fresnel_dielectric(float(std::cos(std::atan(1.5))), 1.5f), 0.5 * std::pow(std::cos(2 * std::atan(1.5)), 2), 1e-5); // Brewster
  EXPECT_NEAR(fresnel_dielectric(1, 1.333f), 0.0204, 1e-4);
  EXPECT_NEAR(fresnel_dielectric(1, 2.417f), 0.172, 1e-3); // diamond
  EXPECT_EQ(fresnel_dielectric(0.7f, 1 / 1.5f), 1);        // beyond the critical angle, 41.8 degrees
  EXPECT_LT(fresnel_dielectric(0.76f, 1 / 1.5f), 1);
  EXPECT_NEAR(fresnel_dielectric(1e-4f, 1.5f), 1, 1e-3);
}

TEST(Fresnel, OfAMetalIsItsColourStraightOnAndTintedAt82Degrees) {
  const Vec3 gold(1.0f, 0.77f, 0.34f), tint(0.9f, 0.8f, 0.7f);
  const F82Tint plain(gold, Vec3(1)), tinted(gold, tint);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(tinted(1)[c], gold[c], 1e-6);
    EXPECT_NEAR(tinted(1 / 7.f)[c], plain(1 / 7.f)[c] * tint[c], 1e-5);
    EXPECT_NEAR(tinted(0)[c], 1, 1e-6);
  }
}

TEST(Fresnel, WeightScalesTheReflectionStraightOn) {
  for (const float eta : {0.7f, 1.5f, 2.f}) {
    EXPECT_NEAR(fresnel_at_normal(modulated_eta(eta, 0.5f)), 0.5f * fresnel_at_normal(eta), 1e-6);
    EXPECT_EQ(modulated_eta(eta, 0), 1);
  }
}

// A film of no thickness is not there; one of a quarter of a wave and the right index takes the reflection away.
TEST(ThinFilm, HasKnownLimits) {
  const F82Tint metal(Vec3(0.9f, 0.7f, 0.5f), Vec3(1));
  for (const float cosine : {1.f, 0.6f, 0.2f}) {
    const Vec3 none = ThinFilm(0, 1.3f, 1).on_dielectric(cosine, 1.5f);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(none[c], fresnel_dielectric(cosine, 1.5f), 2e-3);
  }
  const Vec3 quarter = ThinFilm(0.55f / (4 * std::sqrt(1.5f)), std::sqrt(1.5f), 1).on_dielectric(1, 1.5f);
  EXPECT_LT(quarter.y, 0.003f);
  const Vec3 soap = ThinFilm(0.3f, 1.33f, 1).on_dielectric(1, 1.5f), thick = ThinFilm(0.45f, 1.33f, 1).on_dielectric(1, 1.5f);
  EXPECT_GT(glm::length(soap - thick), 0.01f);
  for (const float thickness : {0.f, 0.2f, 0.7f, 100.f}) {
    const Vec3 f = ThinFilm(thickness, 1.5f, 1).on_metal(0.5f, metal);
    for (int c = 0; c < 3; ++c) EXPECT_TRUE(f[c] >= 0 && f[c] <= 1);
  }
}

// What the ground and the transmission do is reciprocal: radiance over the square of the index of refraction, in both directions.
TEST(SurfaceBsdf, TransmissionIsReciprocalWithoutTheRepaidEnergy) {
  const SurfaceParameters s = clear_glass(0.2f, 1.5f); // so smooth that next to nothing is repaid
  const SurfaceBsdf outside(s), within(s, inside(s));
  int compared = 0;
  for (uint32_t i = 0; i < 200; ++i) {
    const Vec3 out = direction(0.6, 1.1);
    const BsdfSample sampled = sample(outside, out, i);
    if (sampled.pdf <= 0 || !sampled.is_transmitted()) continue;
    const Vec3 in = sampled.direction;
    const float there = outside.evaluate(out, in).x / std::abs(in.z);
    const float back = within.evaluate({in.x, in.y, -in.z}, {out.x, out.y, -out.z}).x / out.z;
    EXPECT_NEAR(there * 1.5 * 1.5 / back, 1, 0.02);
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

TEST(SurfaceBsdf, GroundIsReciprocal) {
  Matte<SampledMode> matte;
  matte.colour.rgb = Vec3(0.8f, 0.5f, 0.1f), matte.roughness = 0.7f;
  const SurfaceBsdf bsdf(matte.surface());
  for (const double cosine : k_cosines) {
    const Vec3 a = direction(cosine, 0.3), b = direction(0.4, 2);
    EXPECT_NEAR(bsdf.evaluate(a, b).x / b.z, bsdf.evaluate(b, a).x / a.z, 1e-6);
  }
}

TEST(SurfaceBsdf, SmoothGlassRefractsBySnellAndReflectsTotally) {
  const SurfaceParameters s = clear_glass(0, 1.5f);
  const SurfaceBsdf outside(s), within(s, inside(s));
  EXPECT_TRUE(outside.is_delta());
  const Vec3 out = direction(std::sqrt(0.5), 0);
  const BsdfSample refracted = outside.sample(out, 0.99f, Vec2(0.5f));
  EXPECT_NEAR(refracted.direction.x, -out.x / 1.5f, 1e-6);
  EXPECT_LT(refracted.direction.z, 0);
  EXPECT_FLOAT_EQ(refracted.eta, 1.5f);
  EXPECT_NEAR(refracted.weight.x * refracted.eta * refracted.eta, 1, 1e-5);
  EXPECT_NEAR(refracted.pdf, 1 - fresnel_dielectric(out.z, 1.5f), 1e-6);
  const BsdfSample total = within.sample(direction(0.7, 0), 0.999f, Vec2(0.5f));
  EXPECT_FALSE(total.is_transmitted());
  EXPECT_FLOAT_EQ(total.weight.x, 1);
}

// Between two media of one index of refraction there is nothing to see, however rough the surface.
TEST(SurfaceBsdf, SurfaceBetweenEqualMediaIsNotThere) {
  for (const float roughness : {0.f, 0.5f}) {
    const SurfaceBsdf bsdf(clear_glass(roughness, 1.33f), {1.33f, 1.33f, false});
    EXPECT_TRUE(bsdf.is_delta());
    const Vec3 out = direction(0.3, 1);
    const BsdfSample s = bsdf.sample(out, 0.5f, Vec2(0.2f, 0.7f));
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(s.direction[c], -out[c], 1e-6);
      EXPECT_NEAR(s.weight[c], 1, 1e-6);
    }
  }
}

TEST(SurfaceBsdf, TintColoursLightThatPasses) {
  SurfaceParameters s = clear_glass(0, 1.5f);
  s.transmission_color.rgb = Vec3(0.2f, 0.5f, 0.9f);
  const BsdfSample passed = SurfaceBsdf(s).sample({0, 0, 1}, 0.99f, Vec2(0.5f));
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(passed.weight[c] * passed.eta * passed.eta * passed.pdf, 0.96f * s.transmission_color.rgb[c], 1e-5);
  s.transmission_depth = 1; // then it is the medium that does
  EXPECT_EQ(SurfaceBsdf(s).sample({0, 0, 1}, 0.99f, Vec2(0.5f)).weight.x, SurfaceBsdf(s).sample({0, 0, 1}, 0.99f, Vec2(0.5f)).weight.z);
}

TEST(SurfaceBsdf, OpaqueSurfaceIsTheSameFromBothSides) {
  const SurfaceParameters s = plastic(0.3f, 1.6f);
  const Vec3 out = direction(0.5, 0), in = direction(0.6, 3);
  EXPECT_EQ(SurfaceBsdf(s).evaluate(out, in), SurfaceBsdf(s, inside(s)).evaluate(out, in));
}

TEST(SurfaceBsdf, CoatDarkensAndColoursADarkBase) {
  SurfaceParameters s = plastic(0.3f, 1.5f);
  s.base_color.rgb = Vec3(0.3f), s.coat_weight = 1;
  const Vec3 out(0, 0, 1), in = direction(0.5, 0);
  const float dark = SurfaceBsdf(s).evaluate(out, in).x;
  s.coat_darkening = 0;
  const float plain = SurfaceBsdf(s).evaluate(out, in).x;
  EXPECT_LT(dark, 0.9f * plain);
  s.coat_color.rgb = Vec3(1, 0.5f, 0.2f);
  const Vec3 coloured = SurfaceBsdf(s).evaluate(out, in);
  EXPECT_FLOAT_EQ(coloured.x, plain);
  EXPECT_LT(coloured.y, 0.5f * coloured.x);
}

// Presets are surfaces that could be written down: within the ranges of the table. None makes light.
TEST(Presets, AreWithinTheRangesOfTheTable) {
  for (const Preset& preset : k_presets) {
    SCOPED_TRACE(preset.name);
    EXPECT_EQ(find_preset(preset.name), &preset); // no name twice
    SurfaceParameters s = preset.surface();
    for_each_value(
        [&]<class T>(const ParameterRules& rules, T& value) {
          if constexpr (std::is_same_v<T, float>) {
            EXPECT_TRUE(rules.range.contains(value)) << rules.name;
          } else if constexpr (std::is_same_v<T, Colour>) {
            for (int c = 0; c < 3; ++c) EXPECT_TRUE(rules.range.contains(value.rgb[c])) << rules.name;
          }
        },
        s);
    for (int c = 0; c < 3; ++c) EXPECT_LE(sampled(SurfaceBsdf(s), direction(0.5, 0), 4096).energy[c], 1.01);
  }
  EXPECT_EQ(find_preset("unobtainium"), nullptr);
}

// The table of mirrors against the integral over directions, which no sampling of normals enters.
TEST(EnergyTable, IsTheIntegralOfGgx) {
  constexpr int n = 400;
  for (const float alpha : {0.25f, 0.6f, 1.f})
    for (const double cosine : {0.2, 0.6, 1.0}) {
      const Ggx facets(alpha);
      const Vec3 out = direction(cosine, 0);
      double sum = 0;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const Vec3 in = direction((i + 0.5) / n, 2 * std::numbers::pi * (j + 0.5) / n), m = glm::normalize(out + in);
          sum += facets.density(m) / (1 + facets.lambda(out) + facets.lambda(in)) / (4 * out.z) * 2 * std::numbers::pi / (n * n);
        }
      EXPECT_NEAR(mirror_albedo(float(cosine), alpha), sum, 0.005) << alpha << " " << cosine;
    }
}

// Of a smooth dielectric the tables are Fresnel's formula.
TEST(EnergyTable, OfASmoothDielectricIsFresnels) {
  EXPECT_NEAR(dielectric_albedo(1, 0, 1.5f).reflected, 0.04, 1e-3);
  EXPECT_NEAR(dielectric_albedo(0.5f, 0, 1.5f).reflected, fresnel_dielectric(0.5f, 1.5f), 3e-3);
  EXPECT_NEAR(dielectric_albedo(0.7f, 0, 1 / 1.5f).total, 1, 1e-6);
}

} // namespace
} // namespace kelpie
