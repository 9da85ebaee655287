// Every operator over every warp over every skeleton, with random parameters: no missed and no false hit.
//
// The seed of a tree is its trial's number. KELPIE_SWEEP_TRIALS is the number of trees (scripts/nightly_sweep
// runs many), KELPIE_SWEEP_FIRST the first trial, to repeat one.
#include <cstdlib>
#include <functional>

#include "tests/support/judge_rays.h"

namespace kelpie {
namespace {

constexpr int k_default_trials = 400, k_rays_a_tree = 40;

int number_from_environment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : otherwise;
}

using Nodes = std::vector<unsigned>;
using MakeLeaf = std::function<unsigned(Random&, SampledField&)>;
using MakeWarp = std::function<unsigned(Random&, SampledField&, unsigned child)>;
using MakeOperator = std::function<unsigned(Random&, SampledField&, const Nodes&)>;

/// A radius that a scene of a few units may have, at times a thousandth of it.
float random_radius(Random& r) { return float(r.below(6) ? r.uniform(0.1, 0.8) : r.log_uniform(0.004, 0.1)); }

template <template <class> class Kind>
Kind<SampledMode> random_leaf(Random& r) {
  Kind<SampledMode> k = random_kind<Kind>(r);
  k.radius = random_radius(r);
  k.weight = float(r.below(6) ? 1 + r.log_uniform(0.01, 2) : -r.uniform(0.2, 2));
  make_special(k, r);
  if constexpr (ComplexPrimitive<Kind<SampledMode>>) k.detail = float(r.log_uniform(0.1, 1)); // a few dozen pieces
  return k;
}

struct Makers {
  std::vector<MakeLeaf> leaves;
  std::vector<MakeWarp> warps;
  std::vector<MakeOperator> operators;

  Makers() {
    FieldKinds::for_each([&]<template <class> class Kind>() {
      using K = Kind<SampledMode>;
      if constexpr (requires(K k) { k.radius = 1.f, k.weight = 1.f; })
        leaves.push_back([](Random& r, SampledField& field) { return add(field, random_leaf<Kind>(r)); });
      else if constexpr (requires(K k) { k.child; })
        warps.push_back([](Random& r, SampledField& field, unsigned child) {
          K k = random_kind<Kind>(r);
          k.child = child;
          if constexpr (requires { k.rate; }) k.rate *= 60; // degrees
          make_special(k, r);
          return add(field, k);
        });
      else if constexpr (Operator<K>)
        operators.push_back([](Random& r, SampledField& field, const Nodes& children) {
          K k = random_kind<Kind>(r);
          k.children = children;
          if constexpr (requires { k.region; }) k.region = add(field, random_leaf<Disc>(r));
          if constexpr (requires { k.n; }) k.n = float(r.log_uniform(0.4, 30));
          return add(field, k);
        });
    });
  }
};

/// operator(warp(operator(leaf, leaf)), leaf, leaf): of the kinds that the trial's number says, else any.
SampledField random_field(const Makers& makers, unsigned trial, Random& r) {
  const auto any = [&](const auto& list) { return list[size_t(r.below(int(list.size())))]; };
  const size_t warp_count = makers.warps.size(), operator_count = makers.operators.size();
  const MakeOperator& join = makers.operators[trial % operator_count];
  const MakeWarp& warp = makers.warps[trial / operator_count % warp_count];
  const MakeLeaf& leaf = makers.leaves[trial / operator_count / warp_count % makers.leaves.size()];
  SampledField field;
  const unsigned first = leaf(r, field);
  const unsigned second = r.below(4) ? any(makers.leaves)(r, field) : add(field, field.nodes[first]); // coincident
  const unsigned inner = any(makers.operators)(r, field, {first, second});
  Nodes operands{warp(r, field, inner), leaf(r, field)};
  if (r.below(2)) operands.push_back(any(makers.leaves)(r, field));
  if (r.below(2)) std::swap(operands[0], operands[1]);
  const unsigned root = join(r, field, operands);
  if (r.below(3) == 0) any(makers.operators)(r, field, {root, any(makers.leaves)(r, field)}); // asks for values, at times
  return field;
}

TEST(Sweep, NoRayIsWrong) {
  const Makers makers;
  const int first = number_from_environment("KELPIE_SWEEP_FIRST", 0),
            trials = number_from_environment("KELPIE_SWEEP_TRIALS", k_default_trials);
  Tally total;
  for (int trial = first; trial < first + trials; ++trial) {
    SCOPED_TRACE(trial);
    Random r{unsigned(trial)};
    const SampledField field = random_field(makers, unsigned(trial), r);
    const Tally tally = judge_rays(field, trial % 2 ? 1.f : 0.6f, k_rays_a_tree, trial % 4 < 2 ? CellLimits{} : k_small_cells, 1e4);
    EXPECT_EQ(tally.missed, 0);
    EXPECT_EQ(tally.false_hits, 0);
    EXPECT_EQ(tally.disagreeing_shadows, 0);
    EXPECT_EQ(tally.wrong_normals, 0);
    total.hits += tally.hits;
  }
  RecordProperty("hits", total.hits);
  EXPECT_GT(total.hits, trials * k_rays_a_tree / 20);
}

} // namespace
} // namespace kelpie
