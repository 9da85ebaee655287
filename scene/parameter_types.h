// What the types of parameters are, for everything that is derived from the tables: the reader, the
// manual and the schema.
#pragma once

#include "base/table.h"
#include "scene/kind_groups.h"

namespace kelpie {

template <class T>
struct MapTrait : std::false_type {};
template <class T>
struct MapTrait<std::map<std::string, T>> : std::true_type {
  using Value = T;
};
/// An object whose keys are names.
template <class T>
concept IsMap = MapTrait<T>::value;

/// The KindList of a variant of kinds.
template <class V>
struct KindsTrait : std::false_type {};
template <template <class> class... Kinds>
struct KindsTrait<OneOf<KindList<Kinds...>, AnimatedMode>> : std::true_type {
  using List = KindList<Kinds...>;
};
template <class V>
concept IsKindVariant = KindsTrait<V>::value;

/// Whether what has this table is a node of a field, which may have a material and a name.
template <Record T>
constexpr bool is_field_node() {
  return std::is_constructible_v<SceneFieldKinds::Variant<AnimatedMode>, T>;
}

/// Calls `visit(row)` for each row of a table, in order.
template <Record T, class Visitor>
void for_each_parameter(Visitor&& visit) {
  std::apply([&](const auto&... row) { (visit(row), ...); }, k_table<T>);
}

/// The type of a row's member.
template <class Row>
struct MemberType;
template <class Owner, class T>
struct MemberType<Parameter<Owner, T>> {
  using type = T;
};
template <class Row>
using MemberOf = typename MemberType<std::remove_cvref_t<Row>>::type;

/// The names of a list's kinds.
template <class List>
std::vector<std::string_view> kind_names() {
  std::vector<std::string_view> names;
  List::for_each([&]<template <class> class Kind>() { names.push_back(Kind<AnimatedMode>::k_name); });
  return names;
}

template <NamedEnum E>
std::vector<std::string_view> enum_names() {
  std::vector<std::string_view> names;
  for (const auto& [name, value] : EnumNames<E>::values) names.push_back(name);
  return names;
}

} // namespace kelpie
