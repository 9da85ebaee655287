// Fields of every kind there is.
#pragma once

#include <functional>

#include "field/warps/axis_tube.h"
#include "tests/support/random_scene.h"

namespace kelpie {

using Nodes = std::vector<unsigned>;
using MakeLeaf = std::function<unsigned(Random&, SampledField&)>;
using MakeWarp = std::function<unsigned(Random&, SampledField&, unsigned child)>;
using MakeOperator = std::function<unsigned(Random&, SampledField&, const Nodes&)>;

/// A radius that a scene of a few units may have, at times a thousandth of it.
inline float random_radius(Random& r) { return float(r.below(6) ? r.uniform(0.1, 0.8) : r.log_uniform(0.004, 0.1)); }

template <template <class> class Kind>
Kind<SampledMode> random_leaf(Random& r) {
  Kind<SampledMode> k = random_kind<Kind>(r);
  k.radius = random_radius(r);
  k.weight = float(r.below(6) ? 1 + r.log_uniform(0.01, 2) : -r.uniform(0.2, 2));
  make_special(k, r);
  // A few pieces, and not as thin as to take a million cells.
  if constexpr (ComplexPrimitive<Kind<SampledMode>>) k.detail = float(r.log_uniform(0.6, 3)), k.radius = std::max(k.radius, 0.2f);
  return k;
}

/// As an ellipsoid, which has no radius of its own.
inline Ellipsoid<SampledMode> stretched(const Point<SampledMode>& p) {
  Ellipsoid<SampledMode> e;
  e.centre = p.centre, e.weight = p.weight, e.falloff = p.falloff;
  e.radii = p.radius * Vec3(1, 0.6f, 0.35f), e.axis = Vec3(1, 2, -1) + p.centre;
  return e;
}

/// Tubes that need no cut: the reference cuts none.
inline void narrow(Axial<SampledMode>& k) {
  for (auto& axis : k.axes) axis.radius = std::max(0.01f, 0.99f * float(AxisTube(k.shape(axis)).cut_radius()));
  std::erase_if(k.axes, [&](const auto& axis) { return AxisTube(k.shape(axis)).cut_radius() < double(axis.radius); });
  k.prepare();
}

/// One feature of two objects, and the background: each sees both, and what is below may be as large again.
inline void make_small(Metamorphosis<SampledMode>& k) {
  k.objects.resize(2);
  for (auto& object : k.objects) std::erase_if(object.elements, [](const auto& e) { return e.name != "a"; });
  std::erase_if(k.features, [&](const auto& feature) {
    return feature.name != k_background && !k.objects[0].element(feature.name) && !k.objects[1].element(feature.name);
  });
  for (auto& feature : k.features) feature.weights.resize(2), feature.frame_weights.clear();
  k.prepare();
}

/// Whether metamorphoses are among the operators: several in one another see a leaf many times, which in motion takes minutes.
enum class Metamorphoses { left_out, among_others };

class EveryKind {
public:
  explicit EveryKind(Metamorphoses mixes = Metamorphoses::among_others) {
    FieldKinds::for_each([&]<template <class> class Kind>() {
      using K = Kind<SampledMode>;
      if (mixes == Metamorphoses::left_out && std::is_same_v<K, Metamorphosis<SampledMode>>) return;
      if constexpr (requires(K k) { k.radius = 1.f, k.weight = 1.f; })
        leaves_.push_back([](Random& r, SampledField& field) {
          K kind = random_leaf<Kind>(r);
          if constexpr (std::is_same_v<K, Point<SampledMode>>)
            if (field.nodes.size() % 2) return add(field, stretched(kind));
          const unsigned leaf = add(field, std::move(kind));
          if constexpr (requires { K::k_is_unbounded; }) { // it cuts something that has an end
            Intersection<SampledMode> cut;
            cut.children = {leaf, add(field, random_leaf<SdfBox>(r))};
            return add(field, cut);
          }
          return leaf;
        });
      else if constexpr (requires(K k) { k.child; })
        warps_.push_back([](Random& r, SampledField& field, unsigned child) {
          K k = random_kind<Kind>(r);
          k.child = child;
          if constexpr (requires { k.rate; }) k.rate *= 60; // degrees
          if constexpr (requires { k.axes; }) narrow(k);
          make_special(k, r);
          return add(field, k);
        });
      else if constexpr (Operator<K>)
        operators_.push_back([](Random& r, SampledField& field, const Nodes& children) {
          K k = random_kind<Kind>(r);
          if constexpr (requires { k.children; }) k.children = children;
          if constexpr (requires { k.objects; }) {
            make_small(k);
            for (size_t j = 0; j < k.objects.size(); ++j) k.objects[j].field = children[j % children.size()];
          }
          if constexpr (requires { k.region; }) k.region = add(field, random_leaf<Disc>(r));
          if constexpr (requires { k.n; }) k.n = float(r.log_uniform(0.4, 30));
          return add(field, k);
        });
    });
  }

  /// operator(warp(operator(leaf, leaf)), leaf, leaf): of the kinds that the trial's number says, else any.
  SampledField random_field(unsigned trial, Random& r) const {
    const auto any = [&](const auto& list) { return list[size_t(r.below(int(list.size())))]; };
    const size_t warp_count = warps_.size(), operator_count = operators_.size();
    const MakeOperator& join = operators_[trial % operator_count];
    const MakeWarp& warp = warps_[trial / operator_count % warp_count];
    const MakeLeaf& leaf = leaves_[trial / operator_count / warp_count % leaves_.size()];
    SampledField field;
    const unsigned first = leaf(r, field);
    const unsigned second = r.below(4) ? any(leaves_)(r, field) : add(field, field.nodes[first]); // coincident
    const unsigned inner = any(operators_)(r, field, {first, second});
    Nodes operands{warp(r, field, inner), leaf(r, field)};
    if (r.below(2)) operands.push_back(any(leaves_)(r, field));
    if (r.below(2)) std::swap(operands[0], operands[1]);
    const unsigned root = join(r, field, operands);
    if (r.below(3) == 0) any(operators_)(r, field, {root, any(leaves_)(r, field)}); // asks for values, at times
    return field;
  }

private:
  std::vector<MakeLeaf> leaves_;
  std::vector<MakeWarp> warps_;
  std::vector<MakeOperator> operators_;
};

} // namespace kelpie
