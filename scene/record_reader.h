// Reads everything that has a table: records, kinds of a list, lists of them, trees of fields.
#pragma once

#include <algorithm>

#include "scene/value_reader.h"

namespace kelpie {

/// A node of a field tree, and the object that it was read from.
struct ReadNode {
  FieldPtr node;
  const JsonValue* source;
};

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

  template <IsOptional T>
  bool read(T& out, const JsonValue& v, const ParameterRules& rules) {
    return read(out.emplace(), v, rules);
  }

  template <IsList T>
  bool read(T& out, const JsonValue& v, const ParameterRules& rules) {
    if (!v.array()) return fail_type(v, rules.name, "a list");
    if (v.array()->empty() && rules.is_required) return fail(v, fmt::format("{} may not be empty", rules.name));
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

  /// Every node of every field, children first.
  const std::vector<ReadNode>& nodes() const { return nodes_; }

private:
  template <Record T>
  bool read_record(T& out, const JsonValue& v, std::string_view owner, bool is_kind) {
    bool is_good = true;
    for (const JsonMember& m : *v.object()) {
      if (is_kind && m.key == "kind") continue;
      bool is_known = false;
      for_each_parameter<T>([&](const auto& row) {
        if (row.name != m.key) return;
        is_known = true;
        is_good &= read(out.*(row.member), m.value, row);
        is_good &= check_row(v, m, row);
      });
      if (!is_known) is_good = fail_unknown_key<T>(m, owner, is_kind);
    }
    for_each_parameter<T>([&](const auto& row) { is_good &= check_presence(v, owner, row); });
    if constexpr (requires { out.where = where(v); }) out.where = where(v);
    return is_good;
  }

  template <Record T>
  bool fail_unknown_key(const JsonMember& m, std::string_view owner, bool is_kind) {
    std::vector<std::string_view> known;
    if (is_kind) known.push_back("kind");
    for_each_parameter<T>([&](const auto& row) { known.push_back(row.name); });
    return fail_unknown_key(m, owner, known);
  }

  bool fail_unknown_key(const JsonMember&, std::string_view owner, std::span<const std::string_view> known);
  bool check_row(const JsonValue& parent, const JsonMember&, const ParameterRules&);
  bool check_presence(const JsonValue&, std::string_view owner, const ParameterRules&);
  const std::string* read_kind_name(const JsonValue&, std::string_view parameter, std::string_view group,
                                    std::span<const std::string_view> known);

  std::vector<ReadNode> nodes_;
};

} // namespace kelpie
