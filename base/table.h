// All that a table leads to: the types of parameters, and the values of a record, those of records in it too.
//
// Whoever asks something of every number, every file or every child of a kind asks here, and not by the names of members.
#pragma once

#include <algorithm>
#include <optional>
#include <type_traits>

#include "base/kind.h"

namespace kelpie {

/// A struct with a table.
template <class T>
concept Record = requires {
  T::parameters();
};

/// The table of a record, in one place of memory: a row is many words.
template <Record T>
inline constexpr auto k_table = T::parameters();

template <class E>
concept NamedEnum = std::is_enum_v<E> && requires {
  EnumNames<E>::values;
};

template <class T>
struct AnimatedTrait : std::false_type {};
template <class T>
struct AnimatedTrait<Animated<T>> : std::true_type {
  using Value = T;
};
template <class T>
concept IsAnimated = AnimatedTrait<T>::value;

template <class T>
struct ListTrait : std::false_type {};
template <class T>
struct ListTrait<std::vector<T>> : std::true_type {
  using Element = T;
};
template <class T>
concept IsList = ListTrait<T>::value;

template <class T>
struct OptionalTrait : std::false_type {};
template <class T>
struct OptionalTrait<std::optional<T>> : std::true_type {
  using Value = T;
};
template <class T>
concept IsOptional = OptionalTrait<T>::value;

/// Where a field tree goes on.
template <class T>
concept IsEdge =
    std::is_same_v<T, AnimatedMode::Child> || std::is_same_v<T, AnimatedMode::Reference> || std::is_same_v<T, SampledMode::Child>;

/// Where a tree of materials goes on.
template <class T>
concept IsMaterialEdge = std::is_same_v<T, AnimatedMode::Material> || std::is_same_v<T, SampledMode::Material>;

template <class Visit, class First, class... Others>
void for_each_value(Visit&& visit, First& first, Others&... others);

namespace detail {
template <class Visit, class T, class... Others>
void walk(Visit& visit, const ParameterRules& rules, T& value, Others&... others) {
  using Plain = std::remove_const_t<T>;
  if constexpr (Record<Plain>) {
    for_each_value(visit, value, others...);
  } else if constexpr (IsList<Plain>) {
    const size_t count = std::min({value.size(), others.size()...});
    for (size_t i = 0; i < count; ++i) walk(visit, rules, value[i], others[i]...);
  } else if constexpr (IsOptional<Plain>) {
    if (value && (... && others)) walk(visit, rules, *value, *others...);
  } else {
    visit(rules, value, others...);
  }
}
} // namespace detail

/// Calls visit(rules, values…) for every value of some records of one type, in step and in the order of their table: one value of
/// each, with what its row says. Lists count element by element, as many as all records have.
template <class Visit, class First, class... Others>
void for_each_value(Visit&& visit, First& first, Others&... others) {
  const auto one = [&](const auto& row) { detail::walk(visit, row, first.*(row.member), others.*(row.member)...); };
  std::apply([&](const auto&... row) { (one(row), ...); }, k_table<std::remove_const_t<First>>);
}

/// Calls visit(edge, rules) for every child of a kind and whatever it refers to, in the order of the tables. A child that could not be
/// read is null.
template <class Kind, class Visit>
void for_each_edge(Kind& kind, Visit&& visit) {
  const auto one = [&]<class T>(const ParameterRules& rules, T& value) {
    if constexpr (IsEdge<std::remove_const_t<T>>) visit(value, rules);
  };
  for_each_value(one, kind);
}

/// A kind that holds what was in files.
template <class Kind>
concept HasAssets = requires {
  Kind::assets();
};

/// Calls visit(asset) for each.
template <HasAssets Kind, class Visit>
void for_each_asset(const Kind& kind, Visit&& visit) {
  std::apply([&](const auto... member) { (visit(kind.*member), ...); }, Kind::assets());
}

/// Whether two kinds at one moment have the same parameters, and the same of what was loaded from files; of complex primitives, whether
/// they are as finely divided, too.
template <class Kind>
bool is_equal(const Kind& a, const Kind& b) {
  const auto are_equal = [&](const auto... member) { return (... && (a.*member == b.*member)); };
  bool equal = std::apply([&](const auto&... row) { return are_equal(row.member...); }, k_table<Kind>);
  if constexpr (HasAssets<Kind>) equal = equal && std::apply(are_equal, Kind::assets());
  if constexpr (requires { a.divisions(); }) equal = equal && a.divisions() == b.divisions();
  return equal;
}

} // namespace kelpie
