#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "base/sample_record.h"
#include "morph/field_fold.h"
#include "morph/fit_blends.h"
#include "morph/open_distances.h"
#include "scene/pixel_scale.h"

namespace kelpie {

namespace {

/// What stands for a frame where the shutter is closed: long enough that float numbers tell its ends apart.
constexpr double k_moment = 1.0 / 256;

/// The materials of a moment, each once for each time in which it is referred to.
class MaterialSampler {
public:
  MaterialSampler(double frame, SampledMaterials& out) : frame_(frame), out_(out) {}

  /// None of none.
  MaterialIndex operator()(const MaterialPtr& material, const TimeMap& time = {}) {
    if (!material) return {};
    const std::pair key{material.get(), time};
    if (const auto known = sampled_.find(key); known != sampled_.end()) return known->second;
    std::visit([&](const auto& kind) { out_.emplace_back(sample_record(kind, time.at(frame_), nullptr, of_record(kind, time).data())); },
               material->kind);
    const MaterialIndex index{static_cast<uint32_t>(out_.size() - 1)};
    sampled_.emplace(key, index);
    return index;
  }

  /// Those that a record names, in the order of for_each_value.
  template <class Record>
  std::vector<MaterialIndex> of_record(const Record& record, const TimeMap& time) {
    std::vector<MaterialIndex> named;
    const auto visit = [&]<class T>(const ParameterRules&, const T& value) {
      if constexpr (IsMaterialEdge<T>) named.push_back((*this)(value, time));
    };
    for_each_value(visit, record);
    return named;
  }

private:
  double frame_;
  SampledMaterials& out_;
  std::map<std::pair<const MaterialNode*, TimeMap>, MaterialIndex> sampled_;
};

/// A skeleton whose surface is placed has the radius that places it there.
template <class Kind>
void place_surface(Kind& kind, float threshold, const SourcePosition& where) {
  if constexpr (requires { kind.surface_radius; })
    if (kind.surface_radius) {
      if (!(kind.weight > threshold)) // the keys are checked, but a curve may swing
        throw Error(ExitStatus::bad_data, fmt::format("surface_radius: weight is {}, not above the threshold {}", kind.weight, threshold),
                    where);
      kind.radius =
          static_cast<float>(radius_of_influence(kind.falloff, double(*kind.surface_radius), double(kind.weight), double(threshold)));
    }
}

/// The variant of a list, at one moment.
template <class List>
typename List::template Variant<SampledMode> sample_variant(const typename List::template Variant<AnimatedMode>& v, double frame) {
  return std::visit([&]<template <class> class Kind>(const Kind<AnimatedMode>& k) ->
                    typename List::template Variant<SampledMode> { return sample_record(k, frame); },
                    v);
}

SampledField sample_field(const FieldNode& root, double frame, float threshold, MaterialSampler& materials) {
  SampledField field;
  // What is shared does not depend on the frame, so all moments have one structure.
  FieldFold<unsigned> fold(PartsShared::in_one_time);
  fold(root, [&](const FieldNode& node, const auto& kind, const TimeMap& time, std::span<const unsigned> nodes) {
    const std::vector<MaterialIndex> named = materials.of_record(kind, time);
    auto sampled = sample_record(kind, time.at(frame), nodes.data(), named.data());
    place_surface(sampled, threshold, node.where);
    field.nodes.emplace_back(std::move(sampled));
    if constexpr (std::is_same_v<std::decay_t<decltype(kind)>, Metamorphosis<AnimatedMode>>)
      open_distances(field, field.nodes.size() - 1), fit_blends(field, field.nodes.size() - 1);
    const MaterialIndex own = materials(node.material, time);
    if (own.is_set() || std::any_of(named.begin(), named.end(), [](MaterialIndex m) { return m.is_set(); })) {
      field.materials.resize(field.nodes.size());
      field.materials.back() = own;
    }
    return static_cast<unsigned>(field.nodes.size() - 1);
  });
  if (!field.materials.empty()) field.materials.resize(field.nodes.size());
  return field;
}

/// What moves of whatever is looked at, and where it is not smooth while the shutter is open.
class Moving {
public:
  Moving(double frame, double reach) : from_(frame - reach), to_(frame + reach) {}

  bool is_any() const { return is_any_; }
  /// The frames of those places, ascending.
  std::vector<double> breaks() const { return {breaks_.begin(), breaks_.end()}; }

  /// Of all values of a record.
  template <class Record>
  void add(const Record& record, const TimeMap& time = {}) {
    const auto one = [&]<class T>(const ParameterRules&, const T& value) {
      if constexpr (IsAnimated<T>) add_curve(value, time);
    };
    for_each_value(one, record);
  }
  /// Of a node and of all that is below it.
  void add_tree(const FieldNode& root) {
    fold_(root, [&](const FieldNode&, const auto& kind, const TimeMap& time, auto&&) {
      add(kind, time);
      return std::monostate{};
    });
  }
  template <class T>
  void add_curve(const Animated<T>& curve, const TimeMap& time = {}) {
    if (curve.is_constant()) return;
    is_any_ = true;
    const double from = time.at(from_), to = time.at(to_); // scales are positive
    for (const double frame : curve.breaks(from, to)) breaks_.insert(std::clamp(time.frame_of(frame), from_, to_));
  }

private:
  double from_, to_;
  bool is_any_ = false;
  std::set<double> breaks_;
  FieldFold<std::monostate> fold_{PartsShared::in_one_time};
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

/// The same pixels, seen from the space of an operand. Exact for similarities; else on the safe side: errors grow most where distances
/// grow least.
PixelScale seen_from(const Operand& operand, const PixelScale& scale) {
  const Affine operand_from_here = inverse(operand.parent_from_operand);
  return {Vec3(operand_from_here(Vec3d(scale.eye))), scale.per_distance * float(evenness(operand_from_here.linear))};
}

/// Tells the complex primitives of the subtree at `index` how the camera sees them. `scale` is seen from the node's space.
void see(SampledField& field, size_t index, const PixelScale& scale) {
  std::visit(
      [&]<class Kind>(Kind& kind) {
        if constexpr (ComplexPrimitive<Kind>) {
          see(kind, scale);
        } else if constexpr (Warp<Kind>) {
          const Point3<double> eye = kind.child_from_parent(Point3<double>{scale.eye.x, scale.eye.y, scale.eye.z});
          see(field, kind.child, {Vec3(eye.x, eye.y, eye.z), scale.per_distance});
        } else {
          for_each_operand(kind, [&](const Operand& operand) {
            see(field, operand.node, k_sees_through_maps<Kind> ? seen_from(operand, scale) : scale);
          });
        }
      },
      field.nodes[index]);
}

FrameScene sample_moment(const Scene& scene, double frame) {
  FrameScene out;
  out.frame = frame;
  out.camera = sample_record(scene.camera, frame);
  out.film = sample_record(scene.film, frame);
  for (const auto& light : scene.lights) out.lights.push_back(sample_variant<LightKinds>(light, frame));
  const PixelScale pixels = pixel_scale(scene, out.camera, out.film.resolution.y);
  MaterialSampler materials(frame, out.materials);
  for (const Shape& shape : scene.shapes) {
    SampledShape s{shape.name, shape.threshold.at(frame), {}, {}, materials(shape.surface), {}, shape.priority};
    for (const auto& [tree, field] : {std::pair(&shape.field, &s.field), std::pair(&shape.texture, &s.texture)}) {
      if (!*tree) continue;
      *field = sample_field(**tree, frame, s.threshold, materials);
      if (std::any_of(field->nodes.begin(), field->nodes.end(), is_complex)) see(*field, field->root(), pixels);
    }
    if (shape.geometry) s.geometry = sample_variant<GeometryKinds>(*shape.geometry, frame);
    out.shapes.push_back(std::move(s));
  }
  return out;
}

} // namespace

FrameScene sample(const Scene& scene, double frame) {
  FrameScene out = sample_moment(scene, frame);
  Moving moving(frame, std::max(0.5 * double(out.camera.shutter), k_moment)), camera = moving;
  for (const Shape& shape : scene.shapes) {
    moving.add_curve(shape.threshold);
    if (shape.field) moving.add_tree(*shape.field);
    if (shape.geometry) std::visit([&](const auto& kind) { moving.add(kind); }, *shape.geometry);
  }
  camera.add(scene.camera);
  out.breaks = moving.breaks(), out.camera_stands = !camera.is_any();
  if (moving.is_any() || camera.is_any()) out.moment = [&scene](double at) { return sample_moment(scene, at); };
  return out;
}

Exposure FrameScene::exposure() const {
  if (!moment) return {frame, 0};
  if (camera.shutter > 0) return {frame - 0.5 * camera.shutter, camera.shutter};
  const bool wants_motion = std::find(film.aovs.begin(), film.aovs.end(), Aov::motion) != film.aovs.end();
  return {frame, wants_motion ? k_moment : 0};
}

} // namespace kelpie
