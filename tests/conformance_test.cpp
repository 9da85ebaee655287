// Tables of kinds, and falloffs. The rest of the suite over every kind: conformance_*_test.cpp.
#include <set>

#include "scene/parameter_types.h"
#include "tests/support/conformance.h"

namespace kelpie {
namespace {

// --- tables ---

template <class T>
void expect_default_in_range(const T& value, const ParameterRules& rules) {
  const auto number = [&](double v) { EXPECT_TRUE(rules.range.contains(v)) << rules.name << " = " << v; };
  if constexpr (IsAnimated<T>)
    expect_default_in_range(value.at(0), rules);
  else if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, unsigned>)
    number(value);
  else if constexpr (requires {
                       value.length();
                       value[0];
                     } &&
                     !std::is_same_v<T, std::string>)
    for (size_t i = 0; i < static_cast<size_t>(value.length()); ++i) number(value[i]);
  else if constexpr (std::is_same_v<T, Colour>)
    for (int i = 0; i < 3; ++i) number(value.rgb[i]);
}

template <class Described>
void expect_sound_table() {
  EXPECT_FALSE(Described::k_name.empty());
  EXPECT_FALSE(Described::k_doc.empty());
  const Described defaults{};
  std::set<std::string_view> names;
  const auto row = [&](const auto& parameter) {
    EXPECT_TRUE(names.insert(parameter.name).second) << "twice: " << parameter.name;
    EXPECT_FALSE(parameter.name.empty());
    EXPECT_FALSE(parameter.doc.empty()) << parameter.name;
    EXPECT_LE(parameter.range.lower, parameter.range.upper) << parameter.name;
    expect_default_in_range(defaults.*(parameter.member), parameter);
  };
  std::apply([&](const auto&... parameters) { (row(parameters), ...); }, Described::parameters());
  const auto alternative = [&](const ParameterRules& rules) {
    EXPECT_TRUE(rules.alternative.empty() || names.count(rules.alternative)) << rules.name;
  };
  std::apply([&](const auto&... parameters) { (alternative(parameters), ...); }, Described::parameters());
}

TEST(Conformance, TablesAreSound) {
  for_each_group([]<class Group>(const Group& group) {
    std::set<std::string_view> names;
    group.for_each([&]<class T>() {
      SCOPED_TRACE(T::k_name);
      EXPECT_TRUE(names.insert(T::k_name).second);
      expect_sound_table<T>();
    });
  });
}

TEST(Conformance, EveryKindOfFieldIsOneTheEngineKnows) {
  for_each_field_kind([]<template <class> class Kind>() {
    using K = Kind<SampledMode>;
    EXPECT_EQ(int(BlobSource<K>) + int(Skeleton<K>) + int(Operator<K>) + int(AffineWarp<K>) + int(Warp<K>) + int(ComplexPrimitive<K>), 1);
  });
}

// --- falloffs ---

TEST(Conformance, FalloffsKeepTheirBoundsOfSlopeAndCurvature) {
  for (const auto& [name, kind] : EnumNames<Falloff>::values) {
    SCOPED_TRACE(name);
    const Falloff f = kind;
    const auto at = [&](double r2) { return falloff(f, r2); };
    EXPECT_EQ(at(0), 1);
    EXPECT_EQ(at(1), 0);
    EXPECT_EQ(at(1.5), 0);
    constexpr double k_step = 1e-4;
    double slope = 0, least = 0, most = 0;
    // Lines at every distance from the centre: a line's f is falloff(distance^2 + t^2).
    for (double distance = 0; distance < 1; distance += 1.0 / 128)
      for (double t = 0; t < 1; t += 1.0 / 1024) {
        const double d2 = square(distance), here = at(d2 + square(t)), ahead = at(d2 + square(t + k_step)),
                     behind = at(d2 + square(t - k_step));
        slope = std::max(slope, std::abs(ahead - behind) / (2 * k_step));
        const double curve = (ahead - 2 * here + behind) / square(k_step);
        least = std::min(least, curve), most = std::max(most, curve);
      }
    const FalloffCurvature bounds = curvature(f);
    // Bounds hold, and are not slack by more than half a per cent. (1e-3: the differences' own error.)
    EXPECT_LE(slope, steepest(f).most);
    EXPECT_GE(slope, 0.995 * steepest(f).most);
    const double at_steepest = std::sqrt(steepest(f).u);
    EXPECT_NEAR((at(square(at_steepest - k_step)) - at(square(at_steepest + k_step))) / (2 * k_step), steepest(f).most, 1e-4);
    EXPECT_GE(least, -bounds.c_plus * (1 + 1e-3));
    EXPECT_LE(least, -bounds.c_plus * 0.995);
    EXPECT_LE(most, bounds.c_minus * (1 + 1e-3));
    EXPECT_GE(most, bounds.c_minus * 0.995);
    const FalloffPolynomial p = polynomial(f);
    for (double u = 0; u < 1; u += 1.0 / 64) EXPECT_NEAR(at(u), square(1 - u) * (p.a + p.b * (1 - u)), 1e-14);
  }
}

} // namespace
} // namespace kelpie
