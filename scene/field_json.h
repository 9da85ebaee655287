// Field trees as scene files have them.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include <nlohmann/json.hpp>

#include "materials/material.h"
#include "morph/field_node.h"

namespace kelpie {

/// Writes trees as JSON. Numbers that are computed from others become keys over the frames of a scene (morph/tree/merged_keys.h), formulas
/// and curves that were written stay as they are, materials get names, and files are named relative to a folder.
class FieldWriter {
public:
  using Json = nlohmann::ordered_json;

  /// `named`: materials that have a name.
  FieldWriter(double first, double last, std::filesystem::path folder, const std::map<std::string, MaterialPtr>& named)
      : first_(first), last_(last), folder_(std::move(folder)) {
    for (const auto& [name, material] : named) taken_.insert(name), names_.emplace(material.get(), name);
  }

  Json tree(const FieldNode&);

  /// Those without a name that the trees so far are made of, by the names that they have now.
  const Json& materials() const { return materials_; }
  /// How many values became keys, how many keys these have, and how far any of them is from its value at most, as a part of the largest
  /// number of the value.
  size_t curves() const { return curves_; }
  size_t keys() const { return keys_; }
  double error() const { return error_; }

private:
  /// `range`: of its numbers.
  template <class T>
  Json value(const T&, const Range& range = {});
  template <class T>
  Json moving(const Animated<T>&, const Range& range);
  template <class T>
  Json curve(const Curve<T>&);
  template <class T>
  Json key(const Key<T>&);
  template <class Kind>
  void add_values(const Kind&, Json& to);
  std::string name_of(const MaterialPtr&);

  double first_, last_;
  std::filesystem::path folder_;
  std::set<std::string> taken_;
  std::map<const MaterialNode*, std::string> names_;
  Json materials_ = Json::object();
  size_t curves_ = 0, keys_ = 0;
  double error_ = 0;
};

} // namespace kelpie
