#include "morph/tree/plain_tree.h"

#include <array>
#include <map>

#include <fmt/format.h>

#include "base/sample_record.h"
#include "materials/material.h"
#include "morph/tree/computed.h"
#include "morph/tree/mix_kinds.h"

namespace kelpie {

namespace {

using A = AnimatedMode;

FieldPtr node_of(AnimatedKind kind, const SourcePosition& where) {
  return std::make_shared<FieldNode>(FieldNode{std::move(kind), where, {}, {}});
}

/// Whether a material is another one in another space.
bool has_place(const AnimatedMode::Material& material) {
  return material && std::visit(
                         []<template <class> class Kind>(const Kind<A>&) {
                           return !requires(const Kind<SampledMode> k) { k.surface(); };
                         },
                         material->kind);
}

/// Changes the space of what is below it.
template <class Kind>
constexpr bool k_moves_space = requires(const Kind& kind) {
  { kind.child } -> std::convertible_to<FieldPtr>;
};

class PlainCopy {
public:
  explicit PlainCopy(const Animated<float>& threshold) : threshold_(threshold) {}

  struct Way {
    TimeMap time;
    bool is_below_blend = false;
    AnimatedMode::Material material{}; ///< of what is above, in the same space
  };

  FieldPtr operator()(const FieldNode& node, Way way) {
    if (++count_ > k_most_plain_nodes)
      throw Error(ExitStatus::bad_data, fmt::format("animorphosis: more than {} nodes, with all instances", k_most_plain_nodes),
                  node.where);
    if (node.material) way.material = in_time(node.material, way.time);
    if (const auto* instance = std::get_if<Instance<A>>(&node.kind)) return placed(*instance, node, way);
    FieldPtr out = node_of(retimed_kind(node.kind, way.time), node.where);
    out->name = node.name;
    std::visit([&](auto& kind) { complete(kind, *out, way); }, out->kind);
    return out;
  }

private:
  template <class Kind>
  void complete(Kind& kind, FieldNode& node, const Way& way) {
    if constexpr (requires { kind.surface_radius; }) place_surface(kind);
    if constexpr (requires { kind.formula; })
      if (kind.formula == BooleanFormula::automatic) kind.formula = way.is_below_blend ? BooleanFormula::smooth : BooleanFormula::sharp;
    Way below = way;
    below.is_below_blend |= joins_by_value(node.kind);
    if (std::is_same_v<Kind, Metamorphosis<A>>) below.is_below_blend = false; // its objects are distances
    size_t count = 0;
    for_each_edge(kind, [&](const auto&, const ParameterRules&) { ++count; });
    const auto retime_material = [&]<class T>(const ParameterRules&, T& value) {
      if constexpr (IsMaterialEdge<T>) value = in_time(value, way.time);
    };
    for_each_value(retime_material, kind);
    if (count == 0 || (k_moves_space<Kind> && has_place(way.material))) node.material = way.material, below.material = nullptr;
    for_each_edge(kind, [&]<class Edge>(Edge& edge, const ParameterRules&) {
      if constexpr (std::is_same_v<Edge, FieldPtr>) edge = (*this)(*edge, below);
    });
  }

  /// The same material as long as nothing of it moves.
  AnimatedMode::Material in_time(const AnimatedMode::Material& material, const TimeMap& time) {
    if (!material || time == TimeMap{}) return material;
    AnimatedMode::Material& known = materials_[{material.get(), time}];
    if (known) return known;
    auto copy = std::make_shared<MaterialNode>(*material);
    bool moves = false;
    const auto retime = [&]<class T>(const ParameterRules&, T& value) {
      if constexpr (IsAnimated<T>) {
        moves |= !value.is_constant(), value = retimed(value, time);
      } else if constexpr (IsMaterialEdge<T>) {
        const T before = value;
        value = in_time(before, time), moves |= value != before;
      }
    };
    std::visit([&](auto& kind) { for_each_value(retime, kind); }, copy->kind);
    return known = moves ? AnimatedMode::Material(std::move(copy)) : material;
  }

  template <class Kind>
  void place_surface(Kind& kind) const {
    if (!kind.surface_radius) return;
    const auto radius = [falloff = kind.falloff](float surface_radius, float weight, float threshold) {
      return float(radius_of_influence(falloff, double(surface_radius), double(weight), double(threshold)));
    };
    kind.radius = computed<float>(radius, *kind.surface_radius, kind.weight, threshold_);
    kind.surface_radius.reset();
  }

  /// position + rotation(scale * p), without what does nothing.
  FieldPtr placed(const Instance<A>& instance, const FieldNode& node, const Way& way) {
    const auto is_still = [](const auto& value, const auto& neutral) { return value.is_constant() && value.at(0) == neutral; };
    const bool stays = has_place(way.material);
    const Way below{way.time.then(instance.time_below()), way.is_below_blend, stays ? nullptr : way.material};
    FieldPtr out = (*this)(*instance.child.target, below);
    if (!is_still(instance.scale, Vec3(1))) out = node_of(Scale<A>{retimed(instance.scale, way.time), {}, out}, node.where);
    if (!is_still(instance.angle, 0.f))
      out = node_of(Rotate<A>{retimed(instance.axis, way.time), retimed(instance.angle, way.time), {}, out}, node.where);
    out = node_of(Translate<A>{retimed(instance.position, way.time), out}, node.where);
    if (stays) out->material = way.material;
    out->name = node.name;
    return out;
  }

  Animated<float> threshold_;
  std::map<std::pair<const MaterialNode*, TimeMap>, AnimatedMode::Material> materials_; ///< of in_time()
  size_t count_ = 0;
};

/// Without anything that is clamped at a threshold, so that all of it is multiplied when all leaves are.
bool is_weighted(FieldNode& node, const Animated<float>& factor) {
  bool is_good = true;
  const auto multiply = [&]<class Kind>(Kind& kind) {
    bool is_leaf = true;
    for_each_edge(kind, [&]<class Edge>(Edge& edge, const ParameterRules& rules) {
      is_leaf = false;
      if constexpr (std::is_same_v<Edge, FieldPtr>) {
        if (rules.role != Role::child) return; // a region is no part of the sum
        edge = std::make_shared<FieldNode>(*edge);
        is_good &= is_weighted(*edge, factor);
      }
    });
    if (!is_leaf) return;
    if constexpr (requires { kind.weight = Animated<float>(); })
      kind.weight = computed<float>([](float w, float f) { return w * f; }, kind.weight, factor);
    else
      is_good = false;
  };
  std::visit(multiply, node.kind);
  return is_good;
}

Box3d finite(const Box3d& box) {
  constexpr double k_far = 1e6;
  return {glm::clamp(box.lower, Vec3d(-k_far), Vec3d(k_far)), glm::clamp(box.upper, Vec3d(-k_far), Vec3d(k_far))};
}

/// Around the pieces of a leaf, or around images of what is below.
template <template <class> class Kind>
std::vector<Box3d> own_boxes(const Kind<A>& kind, double frame, std::vector<Box3d> below) {
  const std::array<unsigned, 1> child{0};
  const std::array<MaterialIndex, 4> materials{};
  using K = Kind<SampledMode>;
  const auto sampled = [&] { return sample_record(kind, frame, child.data(), materials.data()); };
  std::vector<Box3d> boxes;
  const auto add = [&](const auto& piece) {
    const Box3 support = piece.support();
    boxes.push_back({Vec3d(support.lower), Vec3d(support.upper)});
  };
  if constexpr (BlobSource<K>) {
    BlobCloud cloud;
    sampled().append_blobs(cloud);
    for (const Blob& b : cloud) {
      const Box3 box = support(b);
      boxes.push_back({Vec3d(box.lower), Vec3d(box.upper)});
    }
  } else if constexpr (ComplexPrimitive<K>) {
    const K k = sampled();
    k.for_each_piece(k.divisions(), add);
    if constexpr (requires { k.parent_from_pieces(); })
      for (Box3d& box : boxes) box = image_of(k.parent_from_pieces(), box);
  } else if constexpr (Skeleton<K>) {
    add(sampled());
  } else if constexpr (requires(const K k) { k.parent_from_child(); }) {
    const Affine map = sampled().parent_from_child();
    for (const Box3d& box : below) boxes.push_back(image_of(map, box));
  } else if constexpr (Warp<K>) {
    const K warp = sampled();
    for (const Box3d& box : below) boxes.push_back(warp.image_of(box));
  } else {
    boxes = std::move(below);
  }
  for (Box3d& box : boxes) box = finite(box);
  return boxes;
}

} // namespace

bool joins_by_value(const FieldKinds::Variant<AnimatedMode>& kind) {
  return std::visit(
      []<class Kind>(const Kind& k) {
        if constexpr (std::is_same_v<Kind, Blend<A>> || std::is_same_v<Kind, HyperBlend<A>>) return k.children.size() > 1;
        return std::is_same_v<Kind, LocalBlend<A>>;
      },
      kind);
}

FieldPtr plain_tree(const FieldNode& root, const TreePlace& place) {
  return PlainCopy(place.threshold)(root, {{}, place.is_below_blend, {}});
}

FieldPtr weighted_tree(const FieldNode& root, const Animated<float>& factor) {
  auto copy = std::make_shared<FieldNode>(root);
  return is_weighted(*copy, factor) ? copy : nullptr;
}

std::vector<FieldPtr> children_of(const FieldNode& node) {
  std::vector<FieldPtr> children;
  const auto add = [&]<class Edge>(const Edge& edge, const ParameterRules&) {
    if constexpr (std::is_same_v<Edge, FieldPtr>) children.push_back(edge);
  };
  std::visit([&](const auto& kind) { for_each_edge(kind, add); }, node.kind);
  return children;
}

/// The children that are seen: a region only says where.
std::vector<FieldPtr> seen_children(const FieldNode& node) {
  std::vector<FieldPtr> children;
  const auto add = [&]<class Edge>(const Edge& edge, const ParameterRules& rules) {
    if constexpr (std::is_same_v<Edge, FieldPtr>)
      if (rules.role != Role::region) children.push_back(edge);
  };
  std::visit([&](const auto& kind) { for_each_edge(kind, add); }, node.kind);
  return children;
}

std::vector<Box3d> boxes_of_node(const FieldNode& node, double frame, const std::vector<Box3d>& below) {
  return std::visit([&](const auto& kind) { return own_boxes(kind, frame, below); }, node.kind);
}

Box3d box_of_tree(const FieldNode& root, double frame) {
  Box3d below, box;
  for (const FieldPtr& child : seen_children(root)) below.extend(box_of_tree(*child, frame));
  for (const Box3d& own : boxes_of_node(root, frame, {below})) box.extend(own);
  return finite(box);
}

std::vector<Box3d> boxes_of_tree(const FieldNode& root, double frame) {
  std::vector<Box3d> below;
  for (const FieldPtr& child : seen_children(root)) {
    const std::vector<Box3d> boxes = boxes_of_tree(*child, frame);
    below.insert(below.end(), boxes.begin(), boxes.end());
  }
  return boxes_of_node(root, frame, below);
}

size_t leaf_count(const FieldNode& root) {
  const std::vector<FieldPtr> children = children_of(root);
  size_t count = children.empty();
  for (const FieldPtr& child : children) count += leaf_count(*child);
  return count;
}

} // namespace kelpie
