// Parameters in words: what manual pages say about types and defaults.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/parameter_types.h"

namespace kelpie {

/// A default as it would stand in a scene file; empty where there is none to show.
inline std::string json_text(double v) { return fmt::format("{}", v); }
inline std::string json_text(float v) { return fmt::format("{}", v); }
inline std::string json_text(int v) { return fmt::format("{}", v); }
inline std::string json_text(bool v) { return v ? "true" : "false"; }
inline std::string json_text(const std::string& v) { return v.empty() ? "" : fmt::format("\"{}\"", v); }
inline std::string json_text(const AssetPath& v) { return json_text(v.path); }
inline std::string json_text(const PartReference& v) { return json_text(v.name); }
inline std::string json_text(const Vec2i& v) { return fmt::format("[{}, {}]", v.x, v.y); }
inline std::string json_text(const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); }
inline std::string json_text(const Colour& v) { return json_text(v.rgb); }
inline std::string json_text(const FieldPtr&) { return {}; }
inline std::string json_text(const MaterialPtr& v) {
  return v ? std::visit([](const auto& kind) { return fmt::format("{{ \"kind\": \"{}\" }}", kind.k_name); }, v->kind) : "";
}
inline std::string json_text(const FreeObject&) { return {}; }
inline std::string json_text(const Background& v) {
  if (v.kind == Background::Kind::colour) return json_text(v.colour);
  return v.kind == Background::Kind::environment ? "\"environment\"" : "\"transparent\"";
}
template <NamedEnum E>
std::string json_text(E v) {
  for (const auto& [name, value] : EnumNames<E>::values)
    if (value == v) return fmt::format("\"{}\"", name);
  return {};
}
template <class T>
std::string json_text(const Animated<T>& v) {
  return json_text(v.at(0));
}
/// A list of names; other lists have no default worth showing.
template <class T>
std::string json_text(const std::vector<T>& v) {
  std::vector<std::string> parts;
  if constexpr (NamedEnum<T>)
    for (const T& e : v) parts.push_back(json_text(e));
  return parts.empty() ? "" : fmt::format("[{}]", fmt::join(parts, ", "));
}
template <class T>
std::string json_text(const std::optional<T>&) {
  return {};
}
template <IsMap T>
std::string json_text(const T&) {
  return {};
}
template <Record T>
std::string json_text(const T&) {
  return {};
}
template <IsKindVariant V>
std::string json_text(const V& v) {
  return std::visit([](const auto& kind) { return fmt::format("{{ \"kind\": \"{}\" }}", kind.k_name); }, v);
}

/// What a value of type `T` looks like: "a number", "[x, y, z]"…
template <class T>
std::string type_text() {
  if constexpr (IsAnimated<T>)
    return type_text<typename AnimatedTrait<T>::Value>();
  else if constexpr (IsOptional<T>)
    return type_text<typename OptionalTrait<T>::Value>();
  else if constexpr (IsList<T>) {
    using Element = typename ListTrait<T>::Element;
    if constexpr (NamedEnum<Element>) return fmt::format("list of any of {}", fmt::join(enum_names<Element>(), ", "));
    return fmt::format("list of {}s", type_text<Element>());
  } else if constexpr (IsMap<T>)
    return fmt::format("object: a {} for each name", type_text<typename MapTrait<T>::Value>());
  else if constexpr (NamedEnum<T>)
    return fmt::format("one of {}", fmt::join(enum_names<T>(), ", "));
  else if constexpr (IsKindVariant<T>)
    return std::string(k_group_name<typename KindsTrait<T>::List>);
  else if constexpr (Record<T>)
    return std::string(T::k_name);
  else if constexpr (std::is_same_v<T, FieldPtr>)
    return std::string(k_group_name<SceneFieldKinds>);
  else if constexpr (std::is_same_v<T, MaterialPtr>)
    return std::string(k_group_name<MaterialKinds>);
  else if constexpr (std::is_same_v<T, FreeObject>)
    return "object of any form";
  else if constexpr (std::is_same_v<T, bool>)
    return "true or false";
  else if constexpr (std::is_same_v<T, int>)
    return "whole number";
  else if constexpr (std::is_arithmetic_v<T>)
    return "number";
  else if constexpr (std::is_same_v<T, std::string>)
    return "string";
  else if constexpr (std::is_same_v<T, AssetPath>)
    return "path of a file";
  else if constexpr (std::is_same_v<T, PartReference>)
    return "name of a part";
  else if constexpr (std::is_same_v<T, Vec2i>)
    return "[width, height]";
  else if constexpr (std::is_same_v<T, Vec3>)
    return "[x, y, z]";
  else if constexpr (std::is_same_v<T, Colour>)
    return "colour";
  else {
    static_assert(std::is_same_v<T, Background>, "say here what the new type looks like");
    return "\"environment\", \"transparent\" or a colour";
  }
}

/// "scene units", "degrees"…; empty for plain numbers.
std::string_view unit_text(Unit);

/// An object with what must be said: every required parameter at its default or, where it has none, at
/// something plausible.
template <Record T>
std::string minimal_json(bool is_kind);

namespace detail {
template <class T>
std::string plausible_json(const ParameterRules& rules, const T& value) {
  if constexpr (std::is_same_v<T, FieldPtr>)
    return rules.example.empty()
               ? minimal_json<typename std::variant_alternative_t<0, FieldKinds::Variant<AnimatedMode>::Alternatives>>(true)
               : std::string(rules.example);
  else if constexpr (std::is_same_v<T, MaterialPtr>)
    return minimal_json<typename std::variant_alternative_t<0, MaterialKinds::Variant<AnimatedMode>::Alternatives>>(true);
  else if constexpr (std::is_same_v<T, AssetPath> || std::is_same_v<T, PartReference>)
    return json_text(std::string(rules.example));
  else if constexpr (std::is_same_v<T, std::string>)
    return fmt::format("\"my {}\"", rules.name);
  else if constexpr (IsList<T>) {
    if (!rules.example.empty()) return std::string(rules.example);
    using Element = typename ListTrait<T>::Element;
    return fmt::format("[{}]", fmt::join(std::vector(rules.least_count, plausible_json<Element>(rules, Element{})), ", "));
  } else if constexpr (Record<T>)
    return minimal_json<T>(false);
  else
    return json_text(value);
}
} // namespace detail

template <Record T>
std::string minimal_json(bool is_kind) {
  std::vector<std::string> members;
  if (is_kind) members.push_back(fmt::format("\"kind\": \"{}\"", T::k_name));
  const T defaults{};
  for_each_parameter<T>([&](const auto& row) {
    // Of two alternatives the one that comes first in the alphabet.
    if (!row.is_required || (!row.alternative.empty() && row.alternative < row.name)) return;
    members.push_back(fmt::format("\"{}\": {}", row.name, detail::plausible_json(row, defaults.*(row.member))));
  });
  return members.empty() ? "{}" : fmt::format("{{ {} }}", fmt::join(members, ", "));
}

} // namespace kelpie
