#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "scene/scene.h"

namespace kelpie {

namespace {

/// What stands for a frame where the shutter is closed: long enough that float numbers tell its ends apart.
constexpr double k_moment = 1.0 / 256;

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
  if constexpr (requires { sampled.grid; }) sampled.grid = animated.grid;
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

/// The keys of whatever is looked at: all that matters of them while the shutter is open.
class Keys {
public:
  Keys(double frame, double reach) : from_(frame - reach), to_(frame + reach) {}

  bool are_there() const { return are_there_; }
  /// The frames of those that the shutter may see, ascending.
  std::vector<double> breaks() const { return {breaks_.begin(), breaks_.end()}; }

  template <class T>
  void add(const Animated<T>& value, double time_offset = 0) {
    if (value.is_constant()) return;
    are_there_ = true;
    for (const Key<T>& key : value.keys())
      if (const double at = key.frame + time_offset; at >= from_ && at <= to_) breaks_.insert(at);
  }
  template <class Kind>
  void add_kind(const Kind& kind, double time_offset = 0) {
    const auto one = [&](const auto& value) {
      if constexpr (requires { add(value); })
        add(value, time_offset);
      else if constexpr (requires { add(value.front()); })
        for (const auto& element : value) add(element, time_offset);
      else if constexpr (requires { value.front().parameters(); }) // records
        for (const auto& element : value) add_kind(element, time_offset);
    };
    std::apply([&](const auto&... row) { (one(kind.*(row.member)), ...); }, Kind::parameters());
  }
  /// Of a node and of what is below it, moved in time.
  void add_tree(const FieldNode& node, double time_offset = 0) {
    std::visit([&](const auto& kind) { add_kind(kind, time_offset); }, node.kind);
    for_each_child(node, [&](const FieldPtr& child) { add_tree(*child, time_offset); });
    if (const auto* instance = std::get_if<Instance<AnimatedMode>>(&node.kind)) {
      const double offset = time_offset + instance->time_offset;
      if (parts_.insert({instance->child.get(), offset}).second) add_tree(*instance->child, offset);
    }
  }

private:
  double from_, to_;
  bool are_there_ = false;
  std::set<double> breaks_;
  std::set<std::pair<const FieldNode*, double>> parts_; ///< those that were looked at, by their offset
};

/// The least factor by which a map with perpendicular columns scales, as a part of the largest.
double evenness(const Mat3d& m) {
  const Vec3d lengths(glm::length(m[0]), glm::length(m[1]), glm::length(m[2]));
  return std::min({lengths.x, lengths.y, lengths.z}) / std::max({lengths.x, lengths.y, lengths.z});
}

bool is_complex(const FieldKinds::Variant<SampledMode>& node) {
  return std::visit([]<class Kind>(const Kind&) { return ComplexPrimitive<Kind>; }, node);
}

/// One that is shared by several instances is as fine as the finest of them.
template <ComplexPrimitive Kind>
void see(Kind& kind, const PixelScale& scale) {
  const PixelScale other = kind.expansion.pixels;
  const bool is_shared = other.per_distance > 0;
  const auto count = [&] {
    const Divisions divisions = kind.divisions();
    return std::accumulate(divisions.begin(), divisions.end(), uint64_t(0));
  };
  const uint64_t before = is_shared ? count() : 0;
  kind.expansion.pixels = scale;
  if (is_shared && count() < before) kind.expansion.pixels = other;
}

/// Tells the complex primitives of the subtree at `index` how the camera sees them. `scale` is seen from the node's space.
void see(SampledField& field, size_t index, const PixelScale& scale) {
  std::visit(
      [&]<class Kind>(Kind& kind) {
        if constexpr (ComplexPrimitive<Kind>) {
          see(kind, scale);
        } else if constexpr (AffineWarp<Kind>) {
          // Exact for similarities; else on the safe side: errors are stretched most where distances are least.
          const Affine child_from_here = inverse(kind.parent_from_child());
          see(field, kind.child, {Vec3(child_from_here(Vec3d(scale.eye))), scale.per_distance * float(evenness(child_from_here.linear))});
        } else if constexpr (Warp<Kind>) {
          const Point3<double> eye = kind.child_from_parent(Point3<double>{scale.eye.x, scale.eye.y, scale.eye.z});
          see(field, kind.child, {Vec3(eye.x, eye.y, eye.z), scale.per_distance});
        } else if constexpr (Operator<Kind>) {
          for (const unsigned operand : operands_of(kind)) see(field, operand, scale);
        }
      },
      field.nodes[index]);
}

PixelScale pixel_scale(const Camera<SampledMode>& camera, int height) {
  return {camera.position, float(2 * std::tan(glm::radians(0.5 * double(camera.fov))) / height)};
}

FrameScene sample_moment(const Scene& scene, double frame) {
  FrameScene out;
  out.frame = frame;
  out.camera = sample_kind(scene.camera, frame);
  out.film = sample_kind(scene.film, frame);
  for (const auto& light : scene.lights) out.lights.push_back(sample_variant<LightKinds>(light, frame));
  const PixelScale pixels = pixel_scale(out.camera, scene.detail_height > 0 ? scene.detail_height : out.film.resolution.y);
  for (const Shape& shape : scene.shapes) {
    SampledShape s{shape.name, shape.threshold.at(frame), {}, {}, sample_variant<SurfaceKinds>(shape.surface, frame)};
    if (shape.field) {
      FieldSampler(frame, s.field).add(*shape.field);
      if (std::any_of(s.field.nodes.begin(), s.field.nodes.end(), is_complex)) see(s.field, s.field.root(), pixels);
    }
    if (shape.geometry) s.geometry = sample_variant<GeometryKinds>(*shape.geometry, frame);
    out.shapes.push_back(std::move(s));
  }
  return out;
}

} // namespace

bool is_equal(const SampledField& a, const SampledField& b) {
  const auto end = [](const SampledField& field) { return field.nodes.end() - std::ptrdiff_t(field.piece_count); };
  return std::equal(a.nodes.begin(), end(a), b.nodes.begin(), end(b), [](const auto& x, const auto& y) {
    return x.index() == y.index() && std::visit([&]<class Kind>(const Kind& kind) { return is_equal(kind, std::get<Kind>(y)); }, x);
  });
}

FrameScene sample(const Scene& scene, double frame) {
  FrameScene out = sample_moment(scene, frame);
  Keys keys(frame, std::max(0.5 * double(out.camera.shutter), k_moment)), camera_keys = keys;
  for (const Shape& shape : scene.shapes) {
    keys.add(shape.threshold);
    if (shape.field) keys.add_tree(*shape.field);
    if (shape.geometry) std::visit([&](const auto& kind) { keys.add_kind(kind); }, *shape.geometry);
  }
  camera_keys.add_kind(scene.camera);
  out.breaks = keys.breaks(), out.camera_stands = !camera_keys.are_there();
  if (keys.are_there() || camera_keys.are_there()) out.moment = [&scene](double at) { return sample_moment(scene, at); };
  return out;
}

Exposure FrameScene::exposure() const {
  if (!moment) return {frame, 0};
  if (camera.shutter > 0) return {frame - 0.5 * camera.shutter, camera.shutter};
  const bool wants_motion = std::find(film.aovs.begin(), film.aovs.end(), Aov::motion) != film.aovs.end();
  return {frame, wants_motion ? k_moment : 0};
}

} // namespace kelpie
