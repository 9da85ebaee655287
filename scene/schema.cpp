// The JSON schema of scene files, draft 2020-12. nlohmann's library only writes here.
#include <cmath>

#include <nlohmann/json.hpp>

#include "scene/manual.h"
#include "scene/parameter_text.h"
#include "scene/reserved.h"

namespace kelpie {

namespace {

using Json = nlohmann::ordered_json;

Json reference(std::string_view name) { return {{"$ref", fmt::format("#/$defs/{}", name)}}; }

Json number_schema(const char* type, const Range& range) {
  Json s{{"type", type}};
  if (!std::isinf(range.lower)) s[range.lower_open ? "exclusiveMinimum" : "minimum"] = range.lower;
  if (!std::isinf(range.upper)) s[range.upper_open ? "exclusiveMaximum" : "maximum"] = range.upper;
  if (range.without_zero) s["not"] = {{"const", 0}};
  return s;
}

Json tuple_schema(const Json& element, size_t size) {
  return {{"type", "array"}, {"items", element}, {"minItems", size}, {"maxItems", size}};
}

Json colour_schema(const Range& range) {
  const Json in_space{{"type", "object"},
                      {"properties", {{"space", {{"type", "string"}}}, {"rgb", tuple_schema(number_schema("number", {}), 3)}}},
                      {"required", {"space", "rgb"}},
                      {"additionalProperties", false}};
  return {{"anyOf", {tuple_schema(number_schema("number", range), 3), {{"type", "string"}, {"pattern", "^#[0-9a-fA-F]{6}$"}}, in_space}}};
}

Json vector_schema(const ParameterRules& rules) {
  Json vector = tuple_schema(number_schema("number", rules.range), 3);
  if (rules.is_nonzero) vector["not"] = {{"const", {0, 0, 0}}};
  if (!rules.is_number_for_all) return vector;
  return {{"anyOf", {vector, number_schema("number", rules.range)}}};
}

/// A curve, or (of numbers) an expression.
Json curve_schema(const Json& value) {
  const Json key{{"type", "array"}, {"prefixItems", {{{"type", "number"}}, value}}, {"minItems", 2}, {"maxItems", 6}};
  const Json ends{{"enum", enum_names<Outside>()}, {"default", "hold"}};
  return {{"type", "object"},
          {"properties",
           {{"keys", {{"type", "array"}, {"items", key}, {"minItems", 1}}},
            {"interpolation", {{"enum", enum_names<Interpolation>()}, {"default", "linear"}}},
            {"before", ends},
            {"after", ends}}},
          {"required", Json::array({"keys"})},
          {"additionalProperties", false}};
}
Json expression_schema() {
  return {{"type", "object"},
          {"properties", {{"expression", {{"type", "string"}, {"minLength", 1}}}}},
          {"required", Json::array({"expression"})},
          {"additionalProperties", false}};
}

template <class T>
Json animated_schema(const Json& value, const ParameterRules& rules) {
  Json any = Json::array({value, curve_schema(value)});
  if (std::is_same_v<T, float> || rules.is_number_for_all) any.push_back(expression_schema());
  if (!std::is_same_v<T, float>) {
    const Json number = number_schema("number", rules.range);
    any.push_back(tuple_schema({{"anyOf", {number, curve_schema(number), expression_schema()}}}, 3));
  }
  return {{"anyOf", any}};
}

template <class T>
Json type_schema(const ParameterRules& rules) {
  if constexpr (IsAnimated<T>)
    return animated_schema<typename AnimatedTrait<T>::Value>(type_schema<typename AnimatedTrait<T>::Value>(rules), rules);
  else if constexpr (IsOptional<T>)
    return type_schema<typename OptionalTrait<T>::Value>(rules);
  else if constexpr (IsList<T>) {
    using Element = typename ListTrait<T>::Element;
    Json list{{"type", "array"}, {"items", type_schema<Element>(rules)}};
    if (rules.is_required) list["minItems"] = rules.least_count;
    if (NamedEnum<Element>) list["uniqueItems"] = true;
    if (rules.is_number_for_all) return {{"anyOf", {list, list["items"]}}};
    return list;
  } else if constexpr (IsMap<T>)
    return {{"type", "object"},
            {"propertyNames", {{"minLength", 1}}},
            {"additionalProperties", type_schema<typename MapTrait<T>::Value>(rules)}};
  else if constexpr (NamedEnum<T>)
    return {{"enum", enum_names<T>()}};
  else if constexpr (std::is_same_v<T, bool>)
    return {{"type", "boolean"}};
  else if constexpr (std::is_same_v<T, int>)
    return number_schema("integer", rules.range);
  else if constexpr (std::is_arithmetic_v<T>)
    return number_schema("number", rules.range);
  else if constexpr (std::is_same_v<T, Vec2i>)
    return tuple_schema(number_schema("integer", rules.range), 2);
  else if constexpr (std::is_same_v<T, Vec3>)
    return vector_schema(rules);
  else if constexpr (std::is_same_v<T, Colour>)
    return colour_schema(rules.range);
  else if constexpr (std::is_same_v<T, FreeObject>)
    return {{"type", "object"}};
  else if constexpr (std::is_same_v<T, Background>)
    return {{"anyOf", {{{"enum", {"environment", "transparent"}}}, colour_schema(rules.range)}}};
  else if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, AssetPath> || std::is_same_v<T, PartReference>)
    return {{"type", "string"}, {"minLength", 1}};
  else
    return reference(type_text<T>()); // records, materials and kinds have a definition of their own
}

template <Record T>
Json record_schema(bool is_kind) {
  Json properties = Json::object(), required = Json::array(), rules = Json::array();
  if (is_kind) properties["kind"] = {{"const", T::k_name}}, required.push_back("kind");
  if (is_field_node<T>()) {
    const Json name{{"type", "string"}, {"minLength", 1}};
    properties["material"] = {{"anyOf", {reference("material"), name}}}, properties["name"] = name;
  }
  const T defaults{};
  for_each_parameter<T>([&](const auto& row) {
    Json p = type_schema<MemberOf<decltype(row)>>(row);
    if (!row.library.empty()) p = {{"anyOf", {p, {{"type", "string"}, {"minLength", 1}}}}};
    p["description"] = row.unit == Unit::none ? std::string(row.doc) : fmt::format("{} ({})", row.doc, unit_text(row.unit));
    if (const std::string value = json_text(defaults.*(row.member)); !value.empty() && !row.is_required) p["default"] = Json::parse(value);
    properties[std::string(row.name)] = std::move(p);
    if (row.alternative.empty()) {
      if (row.is_required) required.push_back(row.name);
    } else if (row.name < row.alternative) { // once for the two
      if (row.is_required)
        rules.push_back({{"oneOf", {{{"required", Json::array({row.name})}}, {{"required", Json::array({row.alternative})}}}}});
      else
        rules.push_back({{"not", {{"required", {row.name, row.alternative}}}}});
    }
  });
  Json s{{"description", T::k_doc}, {"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
  if (!required.empty()) s["required"] = required;
  if (!rules.empty()) s["allOf"] = rules;
  return s;
}

/// Defines each record by its name, but for the scene itself.
template <class Group>
void define_records(Json& definitions, const Group& group) {
  group.for_each([&]<class T>() {
    if constexpr (!std::is_same_v<T, Scene>) definitions[std::string(T::k_name)] = record_schema<T>(false);
  });
}

/// Defines a group ("field": one of…) and its kinds ("field.point").
template <class Group>
void define_kinds(Json& definitions, const Group& group) {
  Json one_of = Json::array();
  group.for_each([&]<class T>() {
    const std::string name = fmt::format("{}.{}", group.name, T::k_name);
    definitions[name] = record_schema<T>(true);
    one_of.push_back(reference(name));
  });
  definitions[std::string(group.name)] = {{"oneOf", one_of}};
}

} // namespace

std::string json_schema() {
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "kelpie scene"}};
  schema.update(record_schema<Scene>(false));
  Json definitions;
  for_each_group([&]<class Group>(const Group& group) {
    if constexpr (!Group::k_is_kinds) define_records(definitions, group);
  });
  for_each_group([&]<class Group>(const Group& group) {
    if constexpr (Group::k_is_kinds) define_kinds(definitions, group);
  });
  schema["$defs"] = definitions;
  return schema.dump(2) + "\n";
}

} // namespace kelpie
