// Kinds: the vocabulary of scene files as tables.
//
// A kind is one struct, templated on a Mode: `Point<AnimatedMode>` is the node of a scene,
// `Point<SampledMode>` the same node at one moment. It has
//   static constexpr std::string_view k_name = "point";      the word in scene files
//   static constexpr std::string_view k_doc  = "…";          its manual page (Markdown)
//   static constexpr auto parameters();                      a std::tuple of Parameter rows
//   static constexpr auto assets();                          if it names files: the members, std::shared_ptr<const T>, that
//                                                            hold what was in them, filled when the scene is built
// The rows drive everything: parsing, validation, sampling, `kelpie kinds` and the JSON schema; what else is asked of all values
// of a table, those of records in it too, is in base/table.h. Defaults are the member initialisers. A KindList is the one line
// that adds a kind.
//
// Rejected: self-registration by static objects (order undefined, lost in static libraries).
#pragma once

#include <array>
#include <cstdint>
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
#include "base/error.h"

namespace kelpie {

struct FieldNode;    // where all lists of field kinds meet: morph/field_node.h
struct MaterialNode; // and those of materials: materials/material.h

/// A file that the scene names. `path` is as written; `resolved` is filled by the reader.
struct AssetPath {
  std::string path;
  std::string resolved;
  bool is_set() const { return !path.empty(); }
  friend bool operator==(const AssetPath&, const AssetPath&) = default;
};

/// One of the scene's parts, which many may name. `target` is null until all parts are known.
struct PartReference {
  std::string name;
  SourcePosition where{};
  std::shared_ptr<FieldNode> target{};
};

/// As written in a scene: numbers are curves, children are nodes, files have names.
struct AnimatedMode {
  template <class T>
  using Value = Animated<T>;
  using File = AssetPath;
  using Child = std::shared_ptr<FieldNode>;
  using Children = std::vector<Child>;
  using Reference = PartReference;
  using Material = std::shared_ptr<MaterialNode>;
};

/// One of the materials of a moment (materials/material.h), by its place in their list; or none.
struct MaterialIndex {
  static constexpr uint32_t k_none = ~uint32_t{0};
  uint32_t index = k_none;

  bool is_set() const { return index != k_none; }
  friend bool operator==(const MaterialIndex&, const MaterialIndex&) = default;
};

/// At one moment: numbers are numbers, children and references are indices into the sampled field's node array (no other parameter
/// is unsigned), materials are indices too, and of files there is what was in them only: nodes are many, and small.
struct SampledMode {
  template <class T>
  using Value = T;
  struct File {
    friend bool operator==(const File&, const File&) = default;
  };
  using Child = unsigned;
  using Children = std::vector<Child>;
  using Reference = unsigned;
  using Material = MaterialIndex;
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
  bool without_zero = false; ///< nor may a curve change its sign, but in a step

  constexpr bool contains(double v) const {
    return (lower_open ? v > lower : v >= lower) && (upper_open ? v < upper : v <= upper) && !(without_zero && v == 0);
  }
};

/// What a field is to the operator that has it as an operand.
enum class Role {
  child,  ///< one of the things that it joins
  region, ///< says where it does what
  weight, ///< says how much of others it takes
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
  Role role = Role::child;        ///< of a field
};

/// One row of a kind's table. `T` is the member's type: Value<Mode, float|Vec3|Colour>, int, double, bool,
/// std::string, Mode::File, Vec2i, an enumeration with EnumNames, Mode::Child, Mode::Children, Mode::Reference, Mode::Material, the
/// variant of a KindList, another struct with a table, or a std::vector or std::optional of such, or a std::map by name.
template <class Owner, class T>
struct Parameter : ParameterRules {
  T Owner::*member;

  constexpr Parameter(std::string_view name_, T Owner::*member_, std::string_view doc_) : ParameterRules{name_, doc_}, member(member_) {}

  constexpr Parameter in(Unit u) const {
    return with([&](ParameterRules& p) { p.unit = u; });
  }
  constexpr Parameter at_least(double v) const {
    return with([&](ParameterRules& p) { p.range.lower = v; });
  }
  constexpr Parameter above(double v) const {
    return with([&](ParameterRules& p) { p.range.lower = v, p.range.lower_open = true; });
  }
  constexpr Parameter at_most(double v) const {
    return with([&](ParameterRules& p) { p.range.upper = v; });
  }
  constexpr Parameter below(double v) const {
    return with([&](ParameterRules& p) { p.range.upper = v, p.range.upper_open = true; });
  }
  constexpr Parameter other_than_zero() const {
    return with([&](ParameterRules& p) { p.range.without_zero = true; });
  }
  constexpr Parameter required() const {
    return with([](ParameterRules& p) { p.is_required = true; });
  }
  constexpr Parameter nonzero() const {
    return with([](ParameterRules& p) { p.is_nonzero = true; });
  }
  constexpr Parameter or_number_for_all() const {
    return with([](ParameterRules& p) { p.is_number_for_all = true; });
  }
  constexpr Parameter of_at_least(size_t count) const {
    return with([&](ParameterRules& p) { p.least_count = count; });
  }
  constexpr Parameter such_as(std::string_view what) const {
    return with([&](ParameterRules& p) { p.example = what; });
  }
  /// May be given as a name that the scene's object `where` explains.
  constexpr Parameter or_named_in(std::string_view where) const {
    return with([&](ParameterRules& p) { p.library = where; });
  }
  /// Excludes `other`, whose row says the same of this one.
  constexpr Parameter alternative_to(std::string_view other) const {
    return with([&](ParameterRules& p) { p.alternative = other; });
  }
  /// Of a field that is no child.
  constexpr Parameter as(Role r) const {
    return with([&](ParameterRules& p) { p.role = r; });
  }

private:
  template <class Change>
  constexpr Parameter with(Change change) const {
    Parameter p = *this;
    change(p);
    return p;
  }
};

template <class Owner, class T>
constexpr Parameter<Owner, T> parameter(std::string_view name, T Owner::*member, std::string_view doc) {
  return {name, member, doc};
}

/// What is wrong with parameters that are each fine by themselves. A kind that may have such a problem says so:
/// `std::optional<ParameterProblem> problem() const`.
struct ParameterProblem {
  std::string_view parameter; ///< where the problem lies
  std::string message;
};

/// Specialise for every enumeration that scene files may name:
///   static constexpr std::array<std::pair<std::string_view, E>, n> values{…};
template <class E>
struct EnumNames;

template <>
struct EnumNames<Interpolation> {
  static constexpr std::array<std::pair<std::string_view, Interpolation>, 5> values{{{"linear", Interpolation::linear},
                                                                                     {"step", Interpolation::step},
                                                                                     {"hermite", Interpolation::hermite},
                                                                                     {"smooth", Interpolation::smooth},
                                                                                     {"spline", Interpolation::spline}}};
};

template <>
struct EnumNames<Outside> {
  static constexpr std::array<std::pair<std::string_view, Outside>, 5> values{{{"hold", Outside::hold},
                                                                               {"cycle", Outside::cycle},
                                                                               {"cycle_offset", Outside::cycle_offset},
                                                                               {"ping_pong", Outside::ping_pong},
                                                                               {"continue", Outside::proceed}}};
};

template <class List, class Mode>
struct OneOf;

/// A compile-time list of kinds.
template <template <class> class... Kinds>
struct KindList {
  static constexpr size_t k_size = sizeof...(Kinds);

  template <class Mode>
  using Variant = OneOf<KindList, Mode>;

  /// Calls `visit.template operator()<Kinds>()` for each kind in turn.
  template <class Visitor>
  static constexpr void for_each(Visitor&& visit) {
    (visit.template operator()<Kinds>(), ...);
  }
};

/// A record of one of a list's kinds. It is a variant whose copying, moving and destroying are compiled once (base/one_of.h) and not in
/// each file that has a scene in its hands: of sixty kinds, they took a third of the time that a build takes.
template <template <class> class... Kinds, class Mode>
struct OneOf<KindList<Kinds...>, Mode> : std::variant<Kinds<Mode>...> {
  using Alternatives = std::variant<Kinds<Mode>...>;
  using Alternatives::Alternatives;

  OneOf();
  OneOf(const OneOf&);
  OneOf(OneOf&&) noexcept;
  OneOf& operator=(const OneOf&);
  OneOf& operator=(OneOf&&) noexcept;
  ~OneOf();
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
