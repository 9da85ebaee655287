// Noise, cells, and what is true of all patterns: what they show over a footprint is the mean of what they show at its points.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "materials/patterns.h"

namespace kelpie {
namespace {

/// Random places and footprints, the same with every compiler: braces keep the order of what is in them.
class Places {
public:
  explicit Places(unsigned seed, float extent = 60) : random_(seed), extent_(extent) {}

  float unit() { return static_cast<float>(random_() >> 8) * 0x1p-24f; }
  float between(float a, float b) { return a + (b - a) * unit(); }
  Vec3 point() { return extent_ * Vec3{unit() - 0.5f, unit() - 0.5f, unit() - 0.5f}; }
  Vec3 direction() {
    for (;;) {
      const Vec3 v{between(-1, 1), between(-1, 1), between(-1, 1)};
      const float length = glm::length(v);
      if (length > 0.1f && length < 1) return v / length;
    }
  }
  /// Anyhow turned.
  Footprint square(float width) { return rectangle(width, width); }
  Footprint rectangle(float width, float length) {
    const Vec3 u = direction();
    const Vec3 v = glm::normalize(glm::cross(u, direction()));
    return {width * u, length * v};
  }
  Vec3 point_in(const Vec3& p, const Footprint& footprint) {
    const Vec2 place{unit() - 0.5f, unit() - 0.5f};
    return p + place.x * footprint.u + place.y * footprint.v;
  }

private:
  std::mt19937 random_;
  float extent_;
};

struct Moments {
  double count = 0, sum = 0, squares = 0;

  void add(double v) { count += 1, sum += v, squares += v * v; }
  double mean() const { return sum / count; }
  double deviation() const { return std::sqrt(std::max(0., squares / count - mean() * mean())); }
};

/// A hash of values to 12 bits.
class Fingerprint {
public:
  void add(float value) { hash_ = (hash_ ^ static_cast<uint32_t>(static_cast<int>(std::lround(value * 4096)))) * 16777619u; }
  uint32_t value() const { return hash_; }

private:
  uint32_t hash_ = 2166136261u;
};

TEST(Noise, HasMean0AndVariance1EverywhereAndInAllDirections) {
  Places places(1);
  Moments all, on_plane;
  Vec3d slopes(0);
  constexpr int k_count = 200'000;
  for (int i = 0; i < k_count; ++i) {
    const Vec3 p = places.point();
    const NoiseSample noise = gradient_noise(p, 7);
    all.add(noise.value);
    slopes += Vec3d(noise.gradient * noise.gradient) / double(k_count);
    on_plane.add(fractal_noise(Vec3(p.x, p.y, 0), {}, {.octaves = 1, .seed = 7}).value);
  }
  EXPECT_NEAR(all.mean(), 0, 0.02);
  EXPECT_NEAR(all.deviation(), 1, 0.01);
  for (size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(slopes[axis], detail::k_noise_slope, 0.1);
  EXPECT_NEAR(on_plane.mean(), 0, 0.03) << "no plane through the lattice differs";
  EXPECT_NEAR(on_plane.deviation(), 1, 0.03);
}

TEST(Noise, LooksTheSameAlongAllDirections) {
  constexpr float k_distance = 0.7f;
  std::vector<double> correlations;
  for (const Vec3& along : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 1, 0), Vec3(1, -1, 1), Vec3(0.3f, 0.8f, -0.5f)}) {
    Places places(2);
    Moments products;
    for (int i = 0; i < 100'000; ++i) {
      const Vec3 p = places.point(), q = p + k_distance * glm::normalize(along);
      products.add(double(fractal_noise(p, {}, {}).value) * fractal_noise(q, {}, {}).value);
    }
    correlations.push_back(products.mean());
  }
  for (const double c : correlations) EXPECT_NEAR(c, correlations.front(), 0.06);
}

TEST(Noise, GradientsAreThoseOfTheValues) {
  Places places(3, 20);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = places.point();
    const NoiseSample noise = fractal_noise(p, {}, {.octaves = 2.5f, .seed = 5});
    for (size_t axis = 0; axis < 3; ++axis) {
      Vec3 step(0);
      step[axis] = 1e-2f;
      const float difference = (fractal_noise(p + step, {}, {.octaves = 2.5f, .seed = 5}).value -
                                fractal_noise(p - step, {}, {.octaves = 2.5f, .seed = 5}).value) /
                               2e-2f;
      EXPECT_NEAR(noise.gradient[axis], difference, 0.03);
    }
  }
}

TEST(Noise, OfOtherSeedsIsOther) {
  Places places(4);
  Moments products;
  for (int i = 0; i < 50'000; ++i) {
    const Vec3 p = places.point();
    products.add(double(gradient_noise(p, 1).value) * gradient_noise(p, 2).value);
  }
  EXPECT_NEAR(products.mean(), 0, 0.02);
}

TEST(Noise, OverAFootprintHasTheMeanOfItsPointsAndTheirVariance) {
  for (const float width : {0.1f, 0.3f, 1.f, 3.f}) {
    SCOPED_TRACE(width);
    Places places(5);
    Moments spread, predicted, error;
    for (int i = 0; i < 400; ++i) {
      const Vec3 p = places.point();
      const Footprint footprint = places.square(width);
      const NoiseSample noise = fractal_noise(p, footprint, {});
      const float u = glm::dot(noise.gradient, footprint.u), v = glm::dot(noise.gradient, footprint.v);
      predicted.add(noise.variance + (u * u + v * v) / 12);
      Moments points;
      for (int k = 0; k < 200; ++k) points.add(fractal_noise(places.point_in(p, footprint), {}, {}).value);
      spread.add(points.deviation() * points.deviation());
      error.add(noise.value - points.mean());
    }
    EXPECT_NEAR(error.mean(), 0, 0.08);
    EXPECT_NEAR(predicted.mean(), spread.mean(), 0.3 * spread.mean());
  }
}

TEST(Noise, BeyondTheReachOfIntegersIsStillANumber) {
  for (const float far : {1e9f, -1e12f, 1e30f}) EXPECT_TRUE(std::isfinite(worley(Vec3(far), 1).first.distance));
}

TEST(Worley, DistancesChangeNoFasterThanThePlace) {
  Places places(6);
  for (int i = 0; i < 100'000; ++i) { // a point that was overlooked would be a jump
    const Vec3 p = places.point(), q = p + 0.02f * places.direction();
    const WorleyCell a = worley(p, 1), b = worley(q, 1);
    ASSERT_LE(std::abs(a.first.distance - b.first.distance), 0.0201f);
    ASSERT_LE(std::abs(a.second.distance - b.second.distance), 0.0201f);
    ASSERT_GE(a.border(), 0);
  }
}

TEST(Noise, AndCellsAreTheSameOnEveryMachine) {
  Fingerprint noise, cells;
  Places places(8);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = places.point();
    noise.add(fractal_noise(p, {Vec3(0.3f, 0, 0), Vec3(0, 0.2f, 0)}, {}).value);
    cells.add(worley(p, 3).border());
    cells.add(unit_of(worley(p, 3).first.id));
  }
  EXPECT_EQ(noise.value(), 573019786u);
  EXPECT_EQ(cells.value(), 2494515714u);
}

/// One kind at its defaults, and its colours.
template <template <class> class Kind>
struct Sample {
  static_assert(Pattern<Kind<SampledMode>>);
  static constexpr const auto& k_stops = Kind<SampledMode>::k_default_stops;

  Kind<SampledMode> pattern;

  explicit Sample(int seed = 0) {
    pattern.seed = seed;
    pattern.prepare();
  }

  std::array<float, k_stops.size()> shares(const Vec3& p, const Footprint& footprint = {}) const {
    std::array<float, k_stops.size()> shares;
    pattern.shares(p, footprint, shares);
    return shares;
  }
  float luminance(const Vec3& p, const Footprint& footprint = {}) const {
    const auto s = shares(p, footprint);
    float sum = 0;
    for (size_t i = 0; i < s.size(); ++i) sum += s[i] * (0.27f * k_stops[i].red + 0.67f * k_stops[i].green + 0.06f * k_stops[i].blue);
    return sum;
  }
};

/// Whether a seed changes a pattern at its defaults.
template <template <class> class Kind>
constexpr bool is_random() {
  using K = Kind<SampledMode>;
  return !std::is_same_v<K, Checker<SampledMode>> && !std::is_same_v<K, Stripes<SampledMode>> && !std::is_same_v<K, Gradient<SampledMode>>;
}

/// Calls test(Sample<Kind>, random places in its size) for all kinds.
template <class Test>
void for_each_pattern(const Test& test) {
  PatternKinds::for_each([&]<template <class> class Kind>() {
    SCOPED_TRACE(std::string(Kind<SampledMode>::k_name));
    const Sample<Kind> sample;
    test(sample);
  });
}

TEST(Patterns, SharesAreThoseOfAWhole) {
  for_each_pattern([](const auto& sample) {
    Places places(10, 40 * sample.pattern.size);
    for (int i = 0; i < 3000; ++i) {
      const Vec3 p = places.point();
      const Footprint footprint = places.square(sample.pattern.size * std::exp2(places.between(-8, 5)));
      const auto shares = sample.shares(p, footprint);
      float sum = 0, value = 0; // stops that reach from 0 to 1 have the value as their mean
      for (size_t s = 0; s < shares.size(); ++s) {
        ASSERT_GE(shares[s], 0);
        sum += shares[s];
        value += shares[s] * sample.k_stops[s].at;
      }
      ASSERT_NEAR(sum, 1, 1e-5f);
      ASSERT_NEAR(sample.pattern.value(p, footprint), value, 1e-5f);
    }
  });
}

TEST(Patterns, OfOtherSeedsAreOther) {
  PatternKinds::for_each([]<template <class> class Kind>() {
    if constexpr (is_random<Kind>()) {
      SCOPED_TRACE(std::string(Kind<SampledMode>::k_name));
      const Sample<Kind> one(1), other(2);
      Places places(11, 40 * one.pattern.size);
      int same = 0;
      for (int i = 0; i < 200; ++i) {
        const Vec3 p = places.point();
        same += one.pattern.value(p, {}) == other.pattern.value(p, {});
      }
      EXPECT_LT(same, 180);
    }
  });
}

TEST(Patterns, OfEveryKindAreTheSameOnEveryMachine) {
  const std::map<std::string_view, uint32_t> expected{
      {"marble", 2974208076u},  {"wood", 3822327230u},     {"granite", 3229761400u}, {"stone", 644321722u},
      {"rust", 204965984u},     {"leather", 2669834582u},  {"leopard", 1723708143u}, {"giraffe", 415598812u},
      {"stripes", 3677534474u}, {"gradient", 1595305444u}, {"strata", 2738620867u},  {"brushed", 63762445u},
      {"cells", 4197545396u},   {"spots", 78090453u},      {"dents", 1890938118u},   {"checker", 3853618985u},
  };
  for_each_pattern([&](const auto& sample) {
    Places places(9, 30 * sample.pattern.size);
    Fingerprint fingerprint;
    for (int i = 0; i < 300; ++i) {
      const Vec3 p = places.point();
      fingerprint.add(sample.luminance(p, places.square(sample.pattern.size * places.unit())));
    }
    const auto found = expected.find(sample.pattern.k_name);
    ASSERT_NE(found, expected.end());
    EXPECT_EQ(fingerprint.value(), found->second);
  });
}

TEST(Patterns, OverAFootprintShowWhatTheirPointsShow) {
  for_each_pattern([](const auto& sample) {
    for (const float width : {0.01f, 0.1f, 0.5f, 2.f}) {
      SCOPED_TRACE(width);
      Places places(12, 60 * sample.pattern.size);
      Moments error, points;
      for (int i = 0; i < 600; ++i) {
        const Vec3 p = places.point();
        const Footprint footprint = places.square(width * sample.pattern.size);
        double mean = 0;
        for (int k = 0; k < 32; ++k) {
          const double luminance = sample.luminance(places.point_in(p, footprint));
          points.add(luminance);
          mean += luminance / 32;
        }
        error.add(sample.luminance(p, footprint) - mean);
      }
      EXPECT_NEAR(error.mean(), 0, 0.08 * points.deviation()) << "on the average nothing is lost";
      EXPECT_LE(error.deviation(), 0.5 * points.deviation()) << "nor is it elsewhere";
    }
  });
}

/// From a vein to the next, from a dark square to the next: in sizes.
template <class Kind>
constexpr float k_period = 1;
template <>
constexpr float k_period<Marble<SampledMode>> = 0.2f; // there are five veins
template <>
constexpr float k_period<Checker<SampledMode>> = 2;
template <>
constexpr float k_period<Strata<SampledMode>> = 4;

TEST(Patterns, KeepTheirMeanWhenBentAndUnderLongFootprints) {
  for_each_pattern([](auto sample) {
    auto& pattern = sample.pattern;
    pattern.warp = 0.3f, pattern.contrast = 1.5f, pattern.bias = 0.1f;
    pattern.prepare();
    for (const float width : {0.02f, 0.1f, 0.3f, 2.f}) {
      SCOPED_TRACE(width);
      Places places(13, 60 * pattern.size);
      Moments error, points;
      for (int i = 0; i < 1500; ++i) {
        const Vec3 p = places.point();
        const Footprint footprint = places.rectangle(width * pattern.size, 5 * width * pattern.size);
        double mean = 0;
        for (int k = 0; k < 8; ++k) {
          const double luminance = sample.luminance(places.point_in(p, footprint));
          points.add(luminance);
          mean += luminance / 8;
        }
        error.add(sample.luminance(p, footprint) - mean);
      }
      EXPECT_NEAR(error.mean(), 0, 0.04 * points.mean());
    }
  });
}

/// What a renderer shows of a pattern at one distance: pixels of 16 samples each, whose footprints are half a pixel wide.
struct Distance {
  double mean = 0, contrast = 0, noise = 0; ///< of luminance; the deviation over pixels; that between two pictures of one pixel
};
template <class Sampled>
Distance picture(const Sampled& sample, float pixel, bool is_filtered) {
  Places places(20, 100 * sample.pattern.size);
  Moments pixels, differences;
  for (int i = 0; i < 600; ++i) {
    const Vec3 p = places.point();
    const Footprint whole = places.square(pixel * sample.pattern.size);
    const Footprint footprint = is_filtered ? Footprint{0.5f * whole.u, 0.5f * whole.v} : Footprint{};
    double pair[2] = {0, 0};
    for (double& mean : pair)
      for (int k = 0; k < 16; ++k) mean += sample.luminance(places.point_in(p, whole), footprint) / 16;
    pixels.add(pair[0]);
    differences.add(pair[0] - pair[1]);
  }
  return {pixels.mean(), pixels.deviation(), differences.deviation() / std::sqrt(2)};
}

TEST(Patterns, NeitherShimmerNorBlurAtAnyDistance) {
  for_each_pattern([](const auto& sample) {
    using Kind = std::remove_cvref_t<decltype(sample.pattern)>;
    if (std::is_same_v<Kind, Gradient<SampledMode>>) return; // has no period, and no mean
    constexpr float period = k_period<Kind>;
    for (int step = 0; step < 24; ++step) {
      const float pixels = std::exp2(6 - 12 * static_cast<float>(step) / 23); // a period: 64 to 1/64
      SCOPED_TRACE(pixels);
      const Distance seen = picture(sample, period / pixels, true), exact = picture(sample, period / pixels, false); // of the same places
      EXPECT_NEAR(seen.mean, exact.mean, 0.02 * exact.mean);
      if (pixels < 0.5f) {
        EXPECT_LE(seen.noise, 0.06 * exact.mean); // beside a light whose own noise is 5.4 %, 1.5 times that
      }
      if (pixels > 8) {
        EXPECT_GE(seen.contrast, 0.95 * exact.contrast);
      }
    }
  });
}

} // namespace
} // namespace kelpie
