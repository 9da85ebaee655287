#include "scene/field_json.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <fmt/format.h>

#include "morph/tree/merged_keys.h"
#include "scene/formula.h"

namespace kelpie {

namespace {

using Json = FieldWriter::Json;

Json short_number(double v) {
  if (v == std::floor(v) && std::abs(v) < 1e15) return static_cast<std::int64_t>(v);
  return v;
}
/// The shortest number that is read as this one.
Json shortest(float v) { return short_number(std::strtod(fmt::format("{}", v).c_str(), nullptr)); }

double largest_of(float v) { return std::abs(double(v)); }
double largest_of(const Vec3& v) { return std::max({largest_of(v.x), largest_of(v.y), largest_of(v.z)}); }
double largest_of(const Colour& c) { return largest_of(c.rgb); }

template <NamedEnum E>
std::string_view name_of_value(E v) {
  for (const auto& [name, value] : EnumNames<E>::values)
    if (value == v) return name;
  return {};
}

/// What a value is behind what checks it.
template <class T>
const TimeFunction<T>* behind_checks(const TimeFunction<T>* function) {
  const auto* checked = dynamic_cast<const Checked<T>*>(function);
  return checked ? behind_checks(&checked->function()) : function;
}

} // namespace

template <class T>
Json FieldWriter::key(const Key<T>& k) {
  Json out = Json::array({short_number(k.frame), value(k.value)});
  const auto list = [&](const std::vector<T>& derivatives) {
    Json all = Json::array();
    for (const T& d : derivatives) all.push_back(value(d));
    return all;
  };
  if (k.derivatives_before)
    out.push_back({{"before", list(*k.derivatives_before)}, {"after", list(k.derivatives)}});
  else
    for (const T& d : k.derivatives) out.push_back(value(d));
  return out;
}

template <class T>
Json FieldWriter::curve(const Curve<T>& c) {
  Json keys = Json::array();
  const bool has_own = c.interpolation() == Interpolation::hermite; // derivatives; else they were chosen
  for (const Key<T>& k : c.keys()) keys.push_back(has_own ? key(k) : Json::array({short_number(k.frame), value(k.value)}));
  Json out{{"keys", keys}};
  if (c.interpolation() != Interpolation::linear) out["interpolation"] = name_of_value(c.interpolation());
  if (c.ends().before != Outside::hold) out["before"] = name_of_value(c.ends().before);
  if (c.ends().after != Outside::hold) out["after"] = name_of_value(c.ends().after);
  return out;
}

template <class T>
Json FieldWriter::moving(const Animated<T>& v, const Range& range) {
  if (v.is_constant()) return value(v.at(0));
  const TimeFunction<T>* const function = behind_checks(v.function());
  if (const auto* written = dynamic_cast<const Curve<T>*>(function)) return curve(*written);
  if constexpr (std::is_same_v<T, float>) {
    if (const auto* formula = dynamic_cast<const Formula*>(function)) return {{"expression", formula->text()}};
  } else {
    if (const auto* components = dynamic_cast<const Components<T>*>(function)) {
      Json parts = Json::array();
      for (const Animated<float>& part : components->parts()) parts.push_back(moving(part, range));
      return parts;
    }
  }
  const MergedKeys<T> merged = merged_keys(v, first_, last_, range);
  double largest = 0;
  for (const Key<T>& k : merged.keys) largest = std::max(largest, largest_of(k.value));
  if (largest > 0) error_ = std::max(error_, merged.error / largest);
  const bool stands = std::all_of(merged.keys.begin(), merged.keys.end(), [&](const Key<T>& k) {
    const auto is_zero = [](const std::vector<T>& list) {
      return std::all_of(list.begin(), list.end(), [](const T& d) { return d == T{}; });
    };
    return k.value == merged.keys.front().value && is_zero(k.derivatives) && is_zero(k.before());
  });
  if (stands) return value(merged.keys.front().value);
  ++curves_, keys_ += merged.keys.size();
  return curve(Curve<T>(merged.keys, Interpolation::hermite));
}

template <class T>
Json FieldWriter::value(const T& v, const Range& range) {
  if constexpr (IsAnimated<T>) {
    return moving(v, range);
  } else if constexpr (std::is_same_v<T, float>) {
    return shortest(v);
  } else if constexpr (std::is_same_v<T, Vec3>) {
    return {shortest(v.x), shortest(v.y), shortest(v.z)};
  } else if constexpr (std::is_same_v<T, Colour>) {
    return value(v.rgb);
  } else if constexpr (NamedEnum<T>) {
    return name_of_value(v);
  } else if constexpr (std::is_same_v<T, AssetPath>) {
    return v.resolved.empty() ? v.path : std::filesystem::path(v.resolved).lexically_proximate(folder_).string();
  } else if constexpr (std::is_same_v<T, PartReference>) {
    return v.name;
  } else if constexpr (std::is_same_v<T, FieldPtr>) {
    return v ? tree(*v) : Json();
  } else if constexpr (std::is_same_v<T, MaterialPtr>) {
    return v ? Json(name_of(v)) : Json();
  } else if constexpr (IsOptional<T>) {
    return v ? value(*v, range) : Json();
  } else if constexpr (IsList<T>) {
    Json all = Json::array();
    for (const auto& element : v) all.push_back(value(element, range));
    return all;
  } else if constexpr (Record<T>) {
    Json out = Json::object();
    add_values(v, out);
    return out;
  } else {
    static_assert(std::is_arithmetic_v<T> || std::is_same_v<T, std::string>, "say here how the new type is written");
    return v;
  }
}

/// Those that are not as they are by default.
template <class Kind>
void FieldWriter::add_values(const Kind& kind, Json& to) {
  const Kind defaults{};
  const auto add = [&](const auto& row) {
    Json written = value(kind.*(row.member), row.range);
    if (written.is_null() || (!row.is_required && written == value(defaults.*(row.member)))) return;
    to[std::string(row.name)] = std::move(written);
  };
  std::apply([&](const auto&... row) { (add(row), ...); }, k_table<Kind>);
}

Json FieldWriter::tree(const FieldNode& node) {
  return std::visit(
      [&]<class Kind>(const Kind& kind) {
        Json out{{"kind", Kind::k_name}};
        if (!node.name.empty()) out["name"] = node.name;
        if (node.material) out["material"] = name_of(node.material);
        add_values(kind, out);
        return out;
      },
      node.kind);
}

std::string FieldWriter::name_of(const MaterialPtr& material) {
  if (const auto known = names_.find(material.get()); known != names_.end()) return known->second;
  return std::visit(
      [&]<class Kind>(const Kind& kind) {
        Json out{{"kind", Kind::k_name}};
        add_values(kind, out); // those that it ranges over come first
        std::string name;
        for (int i = 1; name.empty() || taken_.count(name); ++i) name = fmt::format("{} {}", Kind::k_name, i);
        taken_.insert(name), names_.emplace(material.get(), name);
        materials_[name] = std::move(out);
        return name;
      },
      material->kind);
}

} // namespace kelpie
