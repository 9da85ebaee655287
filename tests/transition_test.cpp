// What is between two materials: they themselves at the ends; of two patterns one of full contrast on the way.
#include <random>

#include <gtest/gtest.h>

#include "base/sample_record.h"
#include "materials/material.h"

namespace kelpie {
namespace {

/// Two patterns, each from black to white, and one between them.
template <template <class> class From, template <class> class To>
struct Pair {
  SampledMaterials all;
  MaterialIndex from, to, between;

  Pair() {
    const MaterialIndex black = add(matte(0)), white = add(matte(1));
    from = add(pattern<From>(black, white)), to = add(pattern<To>(black, white));
    Transition<AnimatedMode> transition{animated<From>(), animated<To>()};
    complete_transition(transition, 0);
    const std::array ends{from, to};
    between = add(sample_record(transition, 0, nullptr, ends.data()));
  }

  float lightness(MaterialIndex material, const Vec3& p, const Footprint& footprint = {}) const {
    SurfaceMix mix;
    add_material(all, material, p, footprint, 1, mix);
    return mix.sum().base_color.rgb.x;
  }
  float lightness_at(float progress, const Vec3& p, const Footprint& footprint = {}) {
    std::get<Transition<SampledMode>>(all[between.index]).progress = progress;
    return lightness(between, p, footprint);
  }

private:
  MaterialIndex add(MaterialKinds::Variant<SampledMode> material) {
    all.push_back(std::move(material));
    return {uint32_t(all.size() - 1)};
  }
  static Matte<SampledMode> matte(float value) {
    Matte<SampledMode> m;
    m.colour = Colour{Vec3(value)};
    return m;
  }
  template <template <class> class Kind>
  static MaterialPtr animated() {
    Kind<AnimatedMode> p;
    p.size = 1.f;
    for (const float value : {0.f, 1.f}) {
      Matte<AnimatedMode> m;
      m.colour = Colour{Vec3(value)};
      p.stops.push_back({value, make_material<Matte>(m)});
    }
    return make_material<Kind>(std::move(p));
  }
  template <template <class> class Kind>
  static Kind<SampledMode> pattern(MaterialIndex black, MaterialIndex white) {
    Kind<SampledMode> p;
    p.size = 1, p.stops.resize(2);
    p.stops[0] = {0, black}, p.stops[1] = {1, white};
    p.prepare();
    return p;
  }
};

/// Places in planes that are square to one another.
std::vector<Vec3> places(size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> coordinate(-20, 20);
  std::vector<Vec3> all;
  for (size_t i = 0; i < count; ++i) {
    Vec3 p(coordinate(random), coordinate(random), coordinate(random));
    p[i % 3] = 0.3f;
    all.push_back(p);
  }
  return all;
}

double deviation(const std::vector<float>& values) {
  double mean = 0, squares = 0;
  for (const float v : values) mean += double(v) / double(values.size());
  for (const float v : values) squares += (double(v) - mean) * (double(v) - mean);
  return std::sqrt(squares / double(values.size()));
}

template <class Test>
void for_each_pair(const Test& test) {
  test(Pair<Marble, Wood>());
  test(Pair<Wood, Strata>());
  test(Pair<Stripes, Marble>());
  test(Pair<Strata, Stripes>());
  test(Pair<Marble, Granite>());
  test(Pair<Giraffe, Leather>());
  test(Pair<Stone, Wood>());
}

TEST(Transition, IsEitherPatternAtItsEnds) {
  for_each_pair([](auto pair) {
    for (const Vec3& p : places(2000)) {
      EXPECT_EQ(pair.lightness_at(0, p), pair.lightness(pair.from, p));
      EXPECT_EQ(pair.lightness_at(1, p), pair.lightness(pair.to, p));
    }
  });
}

/// The contrast of the whole is between that of both ends, where that of a mixture is far less.
TEST(Transition, KeepsContrast) {
  for_each_pair([](auto pair) {
    std::vector<float> from, to, mixture, between;
    for (const Vec3& p : places(20'000)) {
      from.push_back(pair.lightness(pair.from, p)), to.push_back(pair.lightness(pair.to, p));
      mixture.push_back((from.back() + to.back()) / 2), between.push_back(pair.lightness_at(0.5f, p));
    }
    const double whole = (deviation(from) + deviation(to)) / 2;
    EXPECT_LT(deviation(mixture), 0.9 * whole);
    EXPECT_GT(deviation(between), 1.01 * deviation(mixture));
    EXPECT_NEAR(deviation(between) / whole, 1, 0.15);
  });
}

/// What is finer than a pixel is its mean there, on the way as well.
TEST(Transition, IsCalmWhereAPixelIsWide) {
  for_each_pair([](auto pair) {
    std::vector<float> fine, coarse;
    for (const Vec3& p : places(4000)) {
      fine.push_back(pair.lightness_at(0.5f, p));
      coarse.push_back(pair.lightness_at(0.5f, p, Footprint{Vec3(40, 0, 8), Vec3(0, 40, 4)}));
    }
    EXPECT_LT(deviation(coarse), 0.15 * deviation(fine));
  });
}

/// The shift is where light and dark agree: of one pattern and its negative, half a period.
TEST(Transition, ShiftsPhasesToWhereTheyAgree) {
  const auto striped = [](std::array<float, 2> lightness) {
    Stripes<AnimatedMode> stripes;
    for (size_t i = 0; i < 2; ++i) {
      Matte<AnimatedMode> matte;
      matte.colour = Colour{Vec3(lightness[i])};
      stripes.stops.push_back({float(i), make_material<Matte>(matte)});
    }
    return make_material<Stripes>(stripes);
  };
  const auto shift = [&](std::array<float, 2> from, std::array<float, 2> to) {
    Transition<AnimatedMode> transition{striped(from), striped(to)};
    complete_transition(transition, 0);
    EXPECT_EQ(transition.way, TransitionWay::phase);
    return transition.shift->at(0);
  };
  EXPECT_EQ(shift({0.1f, 0.8f}, {0.2f, 0.6f}), 0);
  EXPECT_NEAR(shift({0.1f, 0.8f}, {0.6f, 0.2f}), 0.5f, 0.01f);
}

} // namespace
} // namespace kelpie
