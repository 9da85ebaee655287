// Reads everything that has a table: records, kinds of a list, lists of them, trees of fields.
#pragma once

#include <algorithm>
#include <map>
#include <set>

#include "scene/value_reader.h"

namespace kelpie {

/// A node of a field tree, and the object that it was read from.
struct ReadNode {
  FieldPtr node;
  const JsonValue* source;
};

/// A node that a tree is to be made for.
struct ReadTreeMaker {
  FieldPtr node;
  Animorphosis<AnimatedMode> kind;
};

/// Says that the scene has no such part or material, and which it has.
std::string unknown_name(std::string_view what, std::string_view name, std::span<const std::string_view> known);

class RecordReader : public ValueReader {
public:
  using ValueReader::read;
  using ValueReader::ValueReader;

  template <NamedEnum E>
  bool read(E& out, const JsonValue& v, const ParameterRules& rules) {
    return read_enum(out, v, rules);
  }

  /// Reads an object by the table of `T`.
  template <Record T>
  bool read(T& out, const JsonValue& v, const ParameterRules& rules) {
    if (!v.object()) return fail_type(v, rules.name, "an object");
    return read_record(out, v, T::k_name, false);
  }

  /// Reads an object with a "kind" from a list of kinds.
  template <IsKindVariant V>
  bool read(V& out, const JsonValue& v, const ParameterRules& rules) {
    using List = typename KindsTrait<V>::List;
    const std::vector<std::string_view> known = kind_names<List>();
    const std::string* name = read_kind_name(v, rules.name, k_group_name<List>, known);
    if (!name) return false;
    bool is_good = false;
    List::for_each([&]<template <class> class Kind>() {
      if (Kind<AnimatedMode>::k_name != *name) return;
      Kind<AnimatedMode> kind;
      is_good = read_record(kind, v, Kind<AnimatedMode>::k_name, true);
      out = std::move(kind);
    });
    return is_good;
  }

  bool read(FieldPtr& out, const JsonValue&, const ParameterRules&);
  /// An object, or the name of one of the scene's materials or of a preset.
  bool read(MaterialPtr& out, const JsonValue&, const ParameterRules&);
  bool read(FreeObject& out, const JsonValue&, const ParameterRules&);

  template <IsOptional T>
  bool read(T& out, const JsonValue& v, const ParameterRules& rules) {
    return read(out.emplace(), v, rules);
  }

  template <IsList T>
  bool read(T& out, const JsonValue& v, const ParameterRules& rules) {
    if (!v.array() && rules.is_number_for_all) {
      out.resize(1);
      return read(out.front(), v, rules);
    }
    if (!v.array()) return fail_type(v, rules.name, "a list");
    if (v.array()->empty() && rules.is_required) return fail(v, fmt::format("{} may not be empty", rules.name));
    if (v.array()->size() < rules.least_count && rules.is_required)
      return fail(v, fmt::format("{}: expected at least {}, found {}", rules.name, count_of_values(rules.least_count),
                                 count_of_values(v.array()->size())));
    out.clear();
    bool is_good = true;
    for (const JsonValue& e : *v.array()) {
      typename ListTrait<T>::Element element{};
      is_good &= read(element, e, rules);
      if constexpr (NamedEnum<typename ListTrait<T>::Element>)
        if (is_good && std::find(out.begin(), out.end(), element) != out.end())
          is_good = fail(e, fmt::format("{}: {} is listed twice", rules.name, in_quotes(*e.string())));
      out.push_back(std::move(element));
    }
    return is_good;
  }

  template <IsMap T>
  bool read(T& out, const JsonValue& v, const ParameterRules& rules) {
    if (!v.object()) return fail_type(v, rules.name, "an object");
    out.clear();
    bool is_good = true;
    for (const JsonMember& m : *v.object()) {
      if (m.key.empty()) is_good = fail(document().where(m.key_at), fmt::format("{}: a name may not be empty", rules.name));
      if constexpr (std::is_same_v<typename MapTrait<T>::Value, MaterialPtr>)
        is_good &= bool(out[m.key] = named_material(m.key, m.value));
      else if constexpr (std::is_same_v<typename MapTrait<T>::Value, Animated<float>>)
        is_good &= read_variable(out[m.key], m);
      else
        is_good &= read(out[m.key], m.value, rules);
    }
    return is_good;
  }

  /// Every node of every field, children first.
  const std::vector<ReadNode>& nodes() const { return nodes_; }
  /// Those of the nodes, inner ones first.
  const std::vector<ReadTreeMaker>& tree_makers() const { return tree_makers_; }

private:
  /// In the order of the table, whatever that of the text.
  template <Record T>
  bool read_record(T& out, const JsonValue& v, std::string_view owner, bool is_kind) {
    bool is_good = true;
    size_t known = is_kind && v.find("kind");
    if (is_field_node<T>()) known += bool(v.find("material")) + bool(v.find("name")); // read with the node
    for_each_parameter<T>([&](const auto& row) {
      for (const JsonMember& m : *v.object()) {
        if (m.key != row.name) continue;
        ++known;
        is_good &= read(out.*(row.member), m.value, row);
        is_good &= check_row(v, m, row);
      }
    });
    if (known < v.object()->size()) is_good &= check_keys<T>(v, owner, is_kind);
    for_each_parameter<T>([&](const auto& row) { is_good &= check_presence(v, owner, row); });
    if constexpr (requires { out.where = where(v); }) out.where = where(v);
    if constexpr (requires { out.problem(); })
      if (is_good)
        if (const std::optional<ParameterProblem> problem = out.problem()) {
          const JsonValue* at = v.find(problem->parameter);
          is_good = fail(at ? *at : v, problem->message);
        }
    return is_good;
  }

  template <Record T>
  bool check_keys(const JsonValue& v, std::string_view owner, bool is_kind) {
    std::vector<std::string_view> known;
    if (is_kind) known.push_back("kind");
    if (is_field_node<T>()) known.insert(known.end(), {"material", "name"});
    for_each_parameter<T>([&](const auto& row) { known.push_back(row.name); });
    return check_keys(v, owner, known);
  }

  bool check_keys(const JsonValue&, std::string_view owner, std::span<const std::string_view> known);
  bool read_variable(Animated<float>& out, const JsonMember& m) {
    const Animated<float>* value = variable(m.key, m.value);
    if (value) out = *value;
    return value;
  }
  /// The material of that name, read when it is first asked for; null where it cannot be used, which has been reported.
  MaterialPtr named_material(const std::string& name, const JsonValue&);
  bool read_material_name(MaterialPtr& out, const JsonValue&);
  bool read_new_material(MaterialPtr& out, const JsonValue&, const ParameterRules&);
  template <class Kind>
  bool complete(Kind&, const JsonValue&);
  bool check_row(const JsonValue& parent, const JsonMember&, const ParameterRules&);
  bool check_presence(const JsonValue&, std::string_view owner, const ParameterRules&);
  const std::string* read_kind_name(const JsonValue&, std::string_view parameter, std::string_view group,
                                    std::span<const std::string_view> known);

  template <class Kind>
  void set_kind(const FieldPtr& node, Kind&& kind);

  std::vector<ReadNode> nodes_;
  std::vector<ReadTreeMaker> tree_makers_;
  std::map<const JsonValue*, MaterialPtr> named_; ///< materials that have been asked for by name; null: it cannot be used
  std::set<const JsonValue*> being_read_;         ///< of these
};

} // namespace kelpie
