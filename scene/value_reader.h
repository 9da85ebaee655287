// Reads single values: numbers, vectors, colours, names, paths, and what of them moves.
#pragma once

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "base/suggest.h"
#include "scene/assets.h"
#include "scene/document.h"
#include "scene/parameter_types.h"
#include "scene/reserved.h"

namespace kelpie {

/// Every read() checks the value against the rules of its parameter, reports what is wrong with it, and
/// returns whether all is well; otherwise `out` is not to be used.
class ValueReader {
public:
  ValueReader(const Document& document, const AssetFolder& folder, ProblemList& problems)
      : document_(document), folder_(folder), problems_(problems) {}

  bool read(double& out, const JsonValue&, const ParameterRules&);
  bool read(float& out, const JsonValue&, const ParameterRules&);
  bool read(int& out, const JsonValue&, const ParameterRules&);
  bool read(bool& out, const JsonValue&, const ParameterRules&);
  bool read(std::string& out, const JsonValue&, const ParameterRules&);
  bool read(AssetPath& out, const JsonValue&, const ParameterRules&);
  bool read(PartReference& out, const JsonValue&, const ParameterRules&);
  bool read(Vec2i& out, const JsonValue&, const ParameterRules&);
  bool read(Vec3& out, const JsonValue&, const ParameterRules&);
  bool read(Colour& out, const JsonValue&, const ParameterRules&);
  bool read(Background& out, const JsonValue&, const ParameterRules&);

  template <NamedEnum E>
  bool read_enum(E& out, const JsonValue& v, const ParameterRules& rules) {
    const std::vector<std::string_view> names = enum_names<E>();
    const int i = read_name(v, rules, names);
    if (i >= 0) out = EnumNames<E>::values[static_cast<size_t>(i)].second;
    return i >= 0;
  }

  /// A constant, a curve `{"keys": [[frame, value, derivative…], …], "interpolation": …}`, a formula `{"expression": …}`, or a list of
  /// components of which each is one of these.
  template <class T>
  bool read(Animated<T>& out, const JsonValue& v, const ParameterRules& rules) {
    if (v.find("expression")) return read_expression(out, v, rules);
    if constexpr (!std::is_same_v<T, float>)
      if (has_object(v)) return read_components(out, v, rules);
    if (is_curve<T>(v)) return read_curve(out, v, rules);
    T constant{};
    if (!read(constant, v, rules)) return false;
    out = Animated<T>(constant);
    return true;
  }

  SourcePosition where(const JsonValue& v) const { return document_.where(v.at); }

  /// Reports a problem; returns false.
  bool fail(SourcePosition at, std::string message) {
    problems_.add(std::move(at), std::move(message));
    return false;
  }
  bool fail(const JsonValue& v, std::string message) { return fail(where(v), std::move(message)); }
  bool fail_type(const JsonValue& v, std::string_view name, std::string_view expected) {
    return fail(v, fmt::format("{}: expected {}, found {}", name, expected, describe(v)));
  }

  /// Warns of variables that the command line says and no expression asks for.
  void warn_of_unused_variables(Diagnostics&) const;

  /// Files that were named so far.
  const AssetFiles& asset_files() const { return asset_files_; }
  /// Where a file that was resolved is named first.
  const SourcePosition& where_named(const AssetPath& file) const { return named_at_.at(file.resolved); }

protected:
  const Document& document() const { return document_; }

  /// A variable of the scene, read when it is first asked for; null where it cannot be used, which has been reported.
  const Animated<float>* variable(const std::string& name, const JsonValue&);
  /// The moments for which a formula is checked before anything is made of it.
  std::vector<double> frames_to_check() const;

private:
  template <class T>
  static bool is_curve(const JsonValue& v) {
    // A colour may be an object as well: {"space": …, "rgb": …}.
    return v.object() && (!std::is_same_v<T, Colour> || v.find("keys") || v.find("interpolation"));
  }
  /// Whether it is a list with an object in it.
  static bool has_object(const JsonValue& v) {
    return v.array() && std::any_of(v.array()->begin(), v.array()->end(), [](const JsonValue& e) { return e.object(); });
  }
  template <class T>
  bool read_expression(Animated<T>& out, const JsonValue&, const ParameterRules&);
  template <class T>
  bool read_components(Animated<T>& out, const JsonValue&, const ParameterRules&);
  /// `function` if all its values may be used at the frames that it is checked for; it goes on checking.
  template <class T>
  bool use_checked(Animated<T>& out, std::shared_ptr<const TimeFunction<T>> function, std::string_view what, const JsonValue&,
                   const ParameterRules&);
  template <class T>
  bool read_curve(Animated<T>& out, const JsonValue&, const ParameterRules&);
  template <class T>
  bool read_key(Key<T>& out, const JsonValue&, Interpolation, const ParameterRules&);
  template <class T>
  bool check_between_keys(const Curve<T>&, const JsonValue&, const ParameterRules&);
  /// Reports every key of an object but the known ones.
  bool check_only(const JsonValue& object, std::span<const std::string_view> known);

  struct Variable;
  bool read_formula(Animated<float>& out, const JsonValue&, const ParameterRules&);
  const Variable* named_variable(const std::string& name, const JsonValue& expression);
  std::string chain_of_variables(const std::string& name) const;

  int read_name(const JsonValue&, const ParameterRules&, std::span<const std::string_view> names);
  bool read_triple(Vec3& out, const JsonValue&, std::string_view name, std::string_view expected);
  bool read_colour_in_space(Vec3& out, const JsonValue&, std::string_view name);
  bool read_hex_colour(Vec3& out, const JsonValue&, std::string_view name);
  bool to_float(float& out, double, const JsonValue&, std::string_view name);
  bool check_range(double found, const JsonValue&, const ParameterRules&);

  const Document& document_;
  const AssetFolder& folder_;
  ProblemList& problems_;
  AssetFiles asset_files_;
  std::map<std::string, SourcePosition> named_at_; ///< by resolved path

  struct Variable {
    bool is_being_read = true, is_good = false, is_used = false;
    double cost = 1; ///< values that are asked for when it is
    Animated<float> value{};
  };
  std::map<const JsonValue*, Variable> variables_; ///< those that were asked for
  std::vector<std::string> variables_being_read_;  ///< each for the one before it
  double cost_ = 1;                                ///< of the formula that was read last
};

extern template bool ValueReader::read_curve(Animated<float>&, const JsonValue&, const ParameterRules&);
extern template bool ValueReader::read_curve(Animated<Vec3>&, const JsonValue&, const ParameterRules&);
extern template bool ValueReader::read_curve(Animated<Colour>&, const JsonValue&, const ParameterRules&);
extern template bool ValueReader::read_expression(Animated<float>&, const JsonValue&, const ParameterRules&);
extern template bool ValueReader::read_expression(Animated<Vec3>&, const JsonValue&, const ParameterRules&);
extern template bool ValueReader::read_expression(Animated<Colour>&, const JsonValue&, const ParameterRules&);
extern template bool ValueReader::read_components(Animated<Vec3>&, const JsonValue&, const ParameterRules&);
extern template bool ValueReader::read_components(Animated<Colour>&, const JsonValue&, const ParameterRules&);

/// "one value", "2 values".
std::string count_of_values(size_t n);

/// "> 0", ">= 0 and <= 1": the range of a number in words of mathematics; empty where all are allowed.
std::string describe(const Range&);

} // namespace kelpie
