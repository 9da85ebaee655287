#include "scene/scene.h"

namespace kelpie {

namespace {

/// Copies every parameter of a kind, animated values at `frame`. Children are for the caller to link.
template <template <class> class Kind>
Kind<SampledMode> sample_kind(const Kind<AnimatedMode>& animated, double frame) {
  Kind<SampledMode> sampled;
  const auto copy = [&]<size_t... I>(std::index_sequence<I...>) {
    const auto from = Kind<AnimatedMode>::parameters();
    const auto to = Kind<SampledMode>::parameters();
    const auto one = [&](const auto& source, auto& target) {
      if constexpr (requires { target = source.at(frame); })
        target = source.at(frame);
      else if constexpr (requires { target = source; })
        target = source;
      else if constexpr (requires { target.push_back(source.front().at(frame)); })
        for (const auto& element : source) target.push_back(element.at(frame));
    };
    (one(animated.*(std::get<I>(from).member), sampled.*(std::get<I>(to).member)), ...);
  };
  copy(std::make_index_sequence<std::tuple_size_v<decltype(Kind<AnimatedMode>::parameters())>>{});
  // What was loaded from files is shared, not copied.
  if constexpr (requires { sampled.cloud; }) sampled.cloud = animated.cloud;
  if constexpr (requires { sampled.morph; }) sampled.morph = animated.morph;
  if constexpr (requires { sampled.mesh; }) sampled.mesh = animated.mesh;
  return sampled;
}

/// Appends the subtree in post-order; returns the index of its root.
unsigned sample_tree(const FieldNode& node, double frame, SampledField& out) {
  return std::visit(
      [&]<template <class> class Kind>(const Kind<AnimatedMode>& animated) {
        Kind<SampledMode> sampled = sample_kind(animated, frame);
        if constexpr (requires { animated.children; })
          for (const FieldPtr& child : animated.children) sampled.children.push_back(sample_tree(*child, frame, out));
        if constexpr (requires { animated.child; }) sampled.child = sample_tree(*animated.child, frame, out);
        if constexpr (requires { animated.region; }) sampled.region = sample_tree(*animated.region, frame, out);
        out.nodes.emplace_back(std::move(sampled));
        return static_cast<unsigned>(out.nodes.size() - 1);
      },
      node.kind);
}

/// The variant of a list, at one moment.
template <class List>
typename List::template Variant<SampledMode> sample_variant(const typename List::template Variant<AnimatedMode>& v, double frame) {
  return std::visit([&]<template <class> class Kind>(const Kind<AnimatedMode>& k) ->
                    typename List::template Variant<SampledMode> { return sample_kind(k, frame); },
                    v);
}

} // namespace

bool is_equal(const SampledField& a, const SampledField& b) {
  return std::equal(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(), [](const auto& x, const auto& y) {
    return x.index() == y.index() && std::visit([&]<class Kind>(const Kind& kind) { return is_equal(kind, std::get<Kind>(y)); }, x);
  });
}

FrameScene sample(const Scene& scene, double frame) {
  FrameScene out;
  out.frame = frame;
  out.camera = sample_kind(scene.camera, frame);
  out.film = sample_kind(scene.film, frame);
  for (const auto& light : scene.lights) out.lights.push_back(sample_variant<LightKinds>(light, frame));
  for (const Shape& shape : scene.shapes) {
    SampledShape s{shape.name, shape.threshold.at(frame), {}, {}, sample_variant<SurfaceKinds>(shape.surface, frame)};
    if (shape.field) sample_tree(*shape.field, frame, s.field);
    if (shape.geometry) s.geometry = sample_variant<GeometryKinds>(*shape.geometry, frame);
    out.shapes.push_back(std::move(s));
  }
  return out;
}

} // namespace kelpie
