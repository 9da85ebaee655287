#include <set>

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
      else if constexpr (requires { source.front().parameters(); }) // records
        for (const auto& element : source) target.push_back(sample_kind(element, frame));
    };
    (one(animated.*(std::get<I>(from).member), sampled.*(std::get<I>(to).member)), ...);
  };
  copy(std::make_index_sequence<std::tuple_size_v<decltype(Kind<AnimatedMode>::parameters())>>{});
  // What was loaded from files is shared, not copied.
  if constexpr (requires { sampled.cloud; }) sampled.cloud = animated.cloud;
  if constexpr (requires { sampled.morph; }) sampled.morph = animated.morph;
  if constexpr (requires { sampled.mesh; }) sampled.mesh = animated.mesh;
  if constexpr (requires { sampled.prepare(); }) sampled.prepare();
  return sampled;
}

class FieldSampler {
public:
  FieldSampler(double frame, SampledField& out) : frame_(frame), out_(out) {}

  /// Appends the subtree in post-order, as it is `time_offset` frames earlier; returns the index of its root.
  unsigned add(const FieldNode& node, double time_offset = 0) {
    return std::visit(
        [&]<template <class> class Kind>(const Kind<AnimatedMode>& animated) {
          Kind<SampledMode> sampled = sample_kind(animated, frame_ - time_offset);
          if constexpr (requires { animated.children; })
            for (const FieldPtr& child : animated.children) sampled.children.push_back(add(*child, time_offset));
          if constexpr (std::is_same_v<Kind<AnimatedMode>, Instance<AnimatedMode>>)
            sampled.child = add_part(*animated.child, time_offset + animated.time_offset);
          else if constexpr (requires { animated.child; })
            sampled.child = add(*animated.child, time_offset);
          if constexpr (requires { animated.region; }) sampled.region = add(*animated.region, time_offset);
          out_.nodes.emplace_back(std::move(sampled));
          return static_cast<unsigned>(out_.nodes.size() - 1);
        },
        node.kind);
  }

private:
  /// Once for all instances of this offset: what is shared does not depend on the frame, so all moments have one structure.
  unsigned add_part(const FieldNode& part, double time_offset) {
    const auto found = parts_.find({&part, time_offset});
    if (found != parts_.end()) return found->second;
    const unsigned root = add(part, time_offset);
    parts_.emplace(std::pair{&part, time_offset}, root);
    return root;
  }

  double frame_;
  SampledField& out_;
  std::map<std::pair<const FieldNode*, double>, unsigned> parts_; ///< roots
};

/// The variant of a list, at one moment.
template <class List>
typename List::template Variant<SampledMode> sample_variant(const typename List::template Variant<AnimatedMode>& v, double frame) {
  return std::visit([&]<template <class> class Kind>(const Kind<AnimatedMode>& k) ->
                    typename List::template Variant<SampledMode> { return sample_kind(k, frame); },
                    v);
}

/// Adds the frames of all keys of a kind.
template <class Kind>
void collect_keys(const Kind& kind, std::set<double>& out) {
  const auto curve = [&](const auto& value) {
    if (!value.is_constant())
      for (const auto& key : value.keys()) out.insert(key.frame);
  };
  const auto one = [&](const auto& value) {
    if constexpr (requires { value.is_constant(); })
      curve(value);
    else if constexpr (requires { value.front().is_constant(); })
      for (const auto& element : value) curve(element);
    else if constexpr (requires { value.front().parameters(); }) // records
      for (const auto& element : value) collect_keys(element, out);
  };
  std::apply([&](const auto&... row) { (one(kind.*(row.member)), ...); }, Kind::parameters());
}

/// The frames of all keys of fields.
class KeyCollector {
public:
  void add(const FieldNode& node, std::set<double>& out) {
    std::visit([&](const auto& kind) { collect_keys(kind, out); }, node.kind);
    for_each_child(node, [&](const FieldPtr& child) { add(*child, out); });
    if (const auto* instance = std::get_if<Instance<AnimatedMode>>(&node.kind))
      for (const double frame : keys_of(*instance->child)) out.insert(frame + instance->time_offset);
  }

private:
  const std::set<double>& keys_of(const FieldNode& part) {
    const auto found = parts_.find(&part);
    if (found != parts_.end()) return found->second;
    std::set<double> keys;
    add(part, keys);
    return parts_.emplace(&part, std::move(keys)).first->second;
  }

  std::map<const FieldNode*, std::set<double>> parts_; ///< in their own time
};

FrameScene sample_moment(const Scene& scene, double frame) {
  FrameScene out;
  out.frame = frame;
  out.camera = sample_kind(scene.camera, frame);
  out.film = sample_kind(scene.film, frame);
  for (const auto& light : scene.lights) out.lights.push_back(sample_variant<LightKinds>(light, frame));
  for (const Shape& shape : scene.shapes) {
    SampledShape s{shape.name, shape.threshold.at(frame), {}, {}, sample_variant<SurfaceKinds>(shape.surface, frame)};
    if (shape.field) FieldSampler(frame, s.field).add(*shape.field);
    if (shape.geometry) s.geometry = sample_variant<GeometryKinds>(*shape.geometry, frame);
    out.shapes.push_back(std::move(s));
  }
  return out;
}

} // namespace

bool is_equal(const SampledField& a, const SampledField& b) {
  return std::equal(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(), [](const auto& x, const auto& y) {
    return x.index() == y.index() && std::visit([&]<class Kind>(const Kind& kind) { return is_equal(kind, std::get<Kind>(y)); }, x);
  });
}

FrameScene sample(const Scene& scene, double frame) {
  FrameScene out = sample_moment(scene, frame);
  std::set<double> keys, camera_keys;
  KeyCollector fields;
  for (const Shape& shape : scene.shapes) {
    if (!shape.threshold.is_constant())
      for (const auto& key : shape.threshold.keys()) keys.insert(key.frame);
    if (shape.field) fields.add(*shape.field, keys);
    if (shape.geometry) std::visit([&](const auto& kind) { collect_keys(kind, keys); }, *shape.geometry);
  }
  collect_keys(scene.camera, camera_keys);
  out.breaks.assign(keys.begin(), keys.end());
  if (!keys.empty() || !camera_keys.empty()) out.moment = [&scene](double at) { return sample_moment(scene, at); };
  return out;
}

Exposure FrameScene::exposure() const {
  if (!moment) return {frame, 0};
  if (camera.shutter > 0) return {frame - 0.5 * camera.shutter, camera.shutter};
  // Long enough that float numbers tell its ends apart, short enough to stand for the frame.
  constexpr double k_moment = 1.0 / 256;
  const bool wants_motion = std::find(film.aovs.begin(), film.aovs.end(), Aov::motion) != film.aovs.end();
  return {frame, wants_motion ? k_moment : 0};
}

} // namespace kelpie
