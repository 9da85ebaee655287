// Kinds: the vocabulary of scene files as tables.
//
// A kind is one struct, templated on a Mode: `Point<AnimatedMode>` is the node of a scene,
// `Point<SampledMode>` the same node at one moment. It has
//   static constexpr std::string_view k_name = "point";      the word in scene files
//   static constexpr std::string_view k_doc  = "…";          its manual page (Markdown)
//   static constexpr auto parameters();                      a std::tuple of Parameter rows
// The rows drive everything: parsing, validation, sampling, `kelpie kinds` and the JSON schema.
// Defaults are the member initialisers. A KindList is the one line that adds a kind.
//
// Rejected: self-registration by static objects (order undefined, lost in static libraries).
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "base/animated.h"

namespace kelpie {

struct FieldNode; // defined where all lists of field kinds meet: scene/field_node.h

using FieldPtr = std::shared_ptr<FieldNode>;

/// A file that the scene names. `path` is as written; `resolved` is filled by the reader.
struct AssetPath {
  std::string path;
  std::string resolved;
  bool is_set() const { return !path.empty(); }
  friend bool operator==(const AssetPath&, const AssetPath&) = default;
};

/// As written in a scene: numbers are curves, children are nodes, files have names.
struct AnimatedMode {
  template <class T>
  using Value = Animated<T>;
  using File = AssetPath;
  using Child = FieldPtr;
  using Children = std::vector<FieldPtr>;
};

/// At one moment: numbers are numbers, children are indices into the sampled field's node array, and of files there is what was in
/// them only: nodes are many, and small.
struct SampledMode {
  template <class T>
  using Value = T;
  struct File {};
  using Child = unsigned;
  using Children = std::vector<unsigned>;
};

/// A parameter that may be animated.
template <class Mode, class T>
using Value = typename Mode::template Value<T>;

enum class Unit { none, length, degrees, frames, pixels };

/// The values a number may take; `open` ends are excluded.
struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lower_open = false, upper_open = false;

  constexpr bool contains(double v) const { return (lower_open ? v > lower : v >= lower) && (upper_open ? v < upper : v <= upper); }
};

/// What a row of a table says about its parameter, whatever its type.
struct ParameterRules {
  std::string_view name;
  std::string_view doc;
  Unit unit = Unit::none;
  Range range{};                  ///< of a number, or of each component of a vector or colour
  bool is_required = false;       ///< with an alternative: one of the two is required
  bool is_nonzero = false;        ///< a direction: the zero vector has none
  bool is_number_for_all = false; ///< a vector that may be given as one number for all components, or a list as one element for all
  size_t least_count = 1;         ///< of the elements of a required list
  std::string_view alternative{}; ///< the parameter that excludes this one
  std::string_view example{};     ///< of a required file or part: a name in examples; of a required list: one, as JSON
  std::string_view library{};     ///< where the scene keeps values that this one may be by name: "surfaces"
};

/// One row of a kind's table. `T` is the member's type: Value<Mode, float|Vec3|Colour>, int, double, bool,
/// std::string, Mode::File, PartName, Vec2i, an enumeration with EnumNames, Mode::Child, Mode::Children, the variant of
/// a KindList, another struct with a table, or a std::vector or std::optional of such, or a std::map by name.
template <class Owner, class T>
struct Parameter : ParameterRules {
  T Owner::*member;

  constexpr Parameter(std::string_view name_, T Owner::*member_, std::string_view doc_) : ParameterRules{name_, doc_}, member(member_) {}

  constexpr Parameter in(Unit u) const {
    auto p = *this;
    p.unit = u;
    return p;
  }
  constexpr Parameter at_least(double v) const {
    auto p = *this;
    p.range.lower = v;
    return p;
  }
  constexpr Parameter above(double v) const {
    auto p = *this;
    p.range.lower = v;
    p.range.lower_open = true;
    return p;
  }
  constexpr Parameter at_most(double v) const {
    auto p = *this;
    p.range.upper = v;
    return p;
  }
  constexpr Parameter below(double v) const {
    auto p = *this;
    p.range.upper = v;
    p.range.upper_open = true;
    return p;
  }
  constexpr Parameter required() const {
    auto p = *this;
    p.is_required = true;
    return p;
  }
  constexpr Parameter nonzero() const {
    auto p = *this;
    p.is_nonzero = true;
    return p;
  }
  constexpr Parameter or_number_for_all() const {
    auto p = *this;
    p.is_number_for_all = true;
    return p;
  }
  constexpr Parameter of_at_least(size_t count) const {
    auto p = *this;
    p.least_count = count;
    return p;
  }
  constexpr Parameter such_as(std::string_view what) const {
    auto p = *this;
    p.example = what;
    return p;
  }
  /// May be given as a name that the scene's object `where` explains.
  constexpr Parameter or_named_in(std::string_view where) const {
    auto p = *this;
    p.library = where;
    return p;
  }
  /// Excludes `other`, whose row says the same of this one.
  constexpr Parameter alternative_to(std::string_view other) const {
    auto p = *this;
    p.alternative = other;
    return p;
  }
};

template <class Owner, class T>
constexpr Parameter<Owner, T> parameter(std::string_view name, T Owner::*member, std::string_view doc) {
  return {name, member, doc};
}

/// Whether two kinds at one moment have the same parameters, and the same of what was loaded from files.
template <class Kind>
bool is_equal(const Kind& a, const Kind& b) {
  bool equal = true;
  const auto one = [&](const auto& row) {
    if constexpr (requires { a.*(row.member) == b.*(row.member); }) equal = equal && a.*(row.member) == b.*(row.member);
  };
  std::apply([&](const auto&... rows) { (one(rows), ...); }, Kind::parameters());
  if constexpr (requires { a.cloud; }) equal = equal && a.cloud == b.cloud;
  if constexpr (requires { a.morph; }) equal = equal && a.morph == b.morph;
  if constexpr (requires { a.mesh; }) equal = equal && a.mesh == b.mesh;
  if constexpr (requires { a.child; }) equal = equal && a.child == b.child;
  if constexpr (requires { a.divisions(); }) equal = equal && a.divisions() == b.divisions(); // as finely divided
  if constexpr (requires { a.grid; }) equal = equal && a.grid == b.grid;
  return equal;
}

/// What is wrong with parameters that are each fine by themselves. A kind that may have such a problem says so:
/// `std::optional<ParameterProblem> problem() const`.
struct ParameterProblem {
  std::string_view parameter; ///< where the problem lies
  std::string message;
};

/// The name of one of the scene's parts.
struct PartName {
  std::string name;
  friend bool operator==(const PartName&, const PartName&) = default;
};

/// Specialise for every enumeration that scene files may name:
///   static constexpr std::array<std::pair<std::string_view, E>, n> values{…};
template <class E>
struct EnumNames;

template <>
struct EnumNames<Interpolation> {
  static constexpr std::array<std::pair<std::string_view, Interpolation>, 3> values{
      {{"linear", Interpolation::linear}, {"step", Interpolation::step}, {"hermite", Interpolation::hermite}}};
};

/// A compile-time list of kinds.
template <template <class> class... Kinds>
struct KindList {
  static constexpr size_t k_size = sizeof...(Kinds);

  template <class Mode>
  using Variant = std::variant<Kinds<Mode>...>;

  /// Calls `visit.template operator()<Kinds>()` for each kind in turn.
  template <class Visitor>
  static constexpr void for_each(Visitor&& visit) {
    (visit.template operator()<Kinds>(), ...);
  }
};

template <class A, class B>
struct ConcatKinds;
template <template <class> class... A, template <class> class... B>
struct ConcatKinds<KindList<A...>, KindList<B...>> {
  using type = KindList<A..., B...>;
};

/// Two lists as one.
template <class A, class B>
using Concat = typename ConcatKinds<A, B>::type;

} // namespace kelpie
