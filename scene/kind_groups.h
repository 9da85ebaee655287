// What scene files are made of, in the order of the manual. Parser, manual, schema and tests know what stands here, and nothing
// else: a group is one line.
#pragma once

#include <string_view>
#include <tuple>
#include <type_traits>

#include "morph/tree/animorphosis.h"
#include "scene/library.h"

namespace kelpie {

/// The kinds of field that only scene files have: what they describe is a tree of other kinds (scene/grow_trees.h).
using TreeMakerKinds = KindList<Animorphosis>;
using SceneFieldKinds = Concat<FieldKinds, TreeMakerKinds>;

/// Objects of which the key "kind" says which one of a list it is.
template <class List>
struct KindGroup {
  static constexpr bool k_is_kinds = true;
  std::string_view name;    ///< of what a list's kinds are: "expected a field"
  std::string_view heading; ///< of their pages in the manual

  /// Calls `visit.template operator()<T>()` for each kind.
  template <class Visitor>
  static constexpr void for_each(Visitor&& visit) {
    List::for_each([&]<template <class> class Kind>() { visit.template operator()<Kind<AnimatedMode>>(); });
  }
};

/// Objects of one form each, which have a name of their own.
template <class... Records>
struct RecordGroup {
  static constexpr bool k_is_kinds = false;
  std::string_view heading;

  template <class Visitor>
  static constexpr void for_each(Visitor&& visit) {
    (visit.template operator()<Records>(), ...);
  }
};

inline constexpr std::tuple k_groups{
    RecordGroup<Scene, Frames, Camera<AnimatedMode>, Film<AnimatedMode>, Shape, Library>{"the scene"},
    KindGroup<SceneFieldKinds>{"field", "fields"},
    RecordGroup<AxialAxis<AnimatedMode>, AxialFrame<AnimatedMode>, MorphObject<AnimatedMode>, FeatureElement<AnimatedMode>,
                MorphFeature<AnimatedMode>, NodePair<AnimatedMode>>{"parts of fields"},
    RecordGroup<Stop<AnimatedMode>>{"parts of materials"},
    KindGroup<MaterialKinds>{"material", "materials"},
    KindGroup<GeometryKinds>{"geometry", "geometry"},
    KindGroup<LightKinds>{"light", "lights"},
};

/// Calls visit(group) for each group.
template <class Visitor>
constexpr void for_each_group(Visitor&& visit) {
  std::apply([&](const auto&... group) { (visit(group), ...); }, k_groups);
}

/// What a list of kinds is called; it must stand in k_groups.
template <class List>
inline constexpr std::string_view k_group_name = std::get<KindGroup<List>>(k_groups).name;

} // namespace kelpie
