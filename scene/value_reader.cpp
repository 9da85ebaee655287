#include "scene/value_reader.h"

#include <cmath>
#include <limits>

namespace kelpie {

std::string describe(const Range& range) {
  if (range.without_zero) return "other than 0";
  if (range.lower == range.upper) return fmt::format("{}", range.lower);
  const std::string lower = std::isinf(range.lower) ? "" : fmt::format("{} {}", range.lower_open ? ">" : ">=", range.lower);
  const std::string upper = std::isinf(range.upper) ? "" : fmt::format("{} {}", range.upper_open ? "<" : "<=", range.upper);
  return lower + (lower.empty() || upper.empty() ? "" : " and ") + upper;
}

std::string count_of_values(size_t n) { return n == 1 ? "one value" : fmt::format("{} values", n); }

bool ValueReader::check_range(double found, const JsonValue& v, const ParameterRules& rules) {
  return rules.range.contains(found) || fail(v, fmt::format("{} must be {}, found {}", rules.name, describe(rules.range), *v.number()));
}

bool ValueReader::to_float(float& out, double number, const JsonValue& v, std::string_view name) {
  if (std::abs(number) > std::numeric_limits<float>::max()) return fail(v, fmt::format("{}: {} is too large", name, number));
  out = static_cast<float>(number);
  return true;
}

bool ValueReader::read(double& out, const JsonValue& v, const ParameterRules& rules) {
  if (!v.number()) return fail_type(v, rules.name, "a number");
  out = *v.number();
  return check_range(out, v, rules);
}

bool ValueReader::read(float& out, const JsonValue& v, const ParameterRules& rules) {
  if (!v.number()) return fail_type(v, rules.name, "a number");
  // The range is that of the float: the smallest doubles above 0 are 0 as floats.
  return to_float(out, *v.number(), v, rules.name) && check_range(double(out), v, rules);
}

bool ValueReader::read(int& out, const JsonValue& v, const ParameterRules& rules) {
  if (!v.number()) return fail_type(v, rules.name, "a whole number");
  const double found = *v.number();
  if (found != std::floor(found)) return fail(v, fmt::format("{}: expected a whole number, found {}", rules.name, found));
  if (!check_range(found, v, rules)) return false;
  if (std::abs(found) > std::numeric_limits<int>::max()) return fail(v, fmt::format("{}: {} is too large", rules.name, found));
  out = static_cast<int>(found);
  return true;
}

bool ValueReader::read(bool& out, const JsonValue& v, const ParameterRules& rules) {
  if (!v.boolean()) return fail_type(v, rules.name, "true or false");
  out = *v.boolean();
  return true;
}

bool ValueReader::read(std::string& out, const JsonValue& v, const ParameterRules& rules) {
  if (!v.string()) return fail_type(v, rules.name, "a string");
  if (v.string()->empty()) return fail(v, fmt::format("{} may not be empty", rules.name));
  out = *v.string();
  return true;
}

bool ValueReader::read(AssetPath& out, const JsonValue& v, const ParameterRules& rules) {
  if (!v.string()) return fail_type(v, rules.name, "a path");
  const DocumentSource& source = document_.sources.at(v.at.source);
  try {
    out = {*v.string(), folder_.resolve(source.folder, *v.string(), source.is_command_line)};
  } catch (const Error& e) {
    problems_.add(where(v), fmt::format("{}: {}", rules.name, e.problems[0].message), e.status);
    return false;
  }
  asset_files_[(source.folder / out.path).string()] = out.resolved;
  named_at_.try_emplace(out.resolved, where(v));
  return true;
}

bool ValueReader::read(PartReference& out, const JsonValue& v, const ParameterRules& rules) {
  if (!v.string()) return fail_type(v, rules.name, "the name of a part");
  out.name = *v.string(), out.where = where(v);
  return true;
}

bool ValueReader::read(Vec2i& out, const JsonValue& v, const ParameterRules& rules) {
  const JsonValue::Array* pair = v.array();
  if (!pair) return fail_type(v, rules.name, "[width, height]");
  if (pair->size() != 2) return fail(v, fmt::format("{}: expected [width, height], found {}", rules.name, count_of_values(pair->size())));
  const bool x = read(out.x, (*pair)[0], rules), y = read(out.y, (*pair)[1], rules);
  return x && y;
}

bool ValueReader::read_triple(Vec3& out, const JsonValue& v, std::string_view name, std::string_view expected) {
  const JsonValue::Array* triple = v.array();
  if (!triple) return fail_type(v, name, expected);
  if (triple->size() != 3) return fail(v, fmt::format("{}: expected {}, found {}", name, expected, count_of_values(triple->size())));
  bool is_good = true;
  for (size_t i = 0; i < 3; ++i) is_good &= read(out[i], (*triple)[i], ParameterRules{name, {}});
  return is_good;
}

bool ValueReader::read(Vec3& out, const JsonValue& v, const ParameterRules& rules) {
  if (rules.is_number_for_all && v.number()) {
    float one = 0;
    if (!read(one, v, rules)) return false;
    out = Vec3(one);
    return true;
  }
  if (!read_triple(out, v, rules.name, rules.is_number_for_all ? "[x, y, z] or a number for all three" : "[x, y, z]")) return false;
  bool is_good = true;
  for (size_t i = 0; i < 3; ++i) is_good &= check_range(double(out[i]), (*v.array())[i], rules);
  if (!is_good || !rules.is_nonzero) return is_good;
  // Not only zero itself: the square of the length must be a normal number for the direction to be one.
  const float length2 = glm::dot(out, out);
  if (!(length2 >= std::numeric_limits<float>::min())) return fail(v, fmt::format("{} may not be the zero vector", rules.name));
  return std::isfinite(length2) || fail(v, fmt::format("{} is too long a vector", rules.name));
}

bool ValueReader::check_only(const JsonValue& object, std::span<const std::string_view> known) {
  bool is_good = true;
  for (const JsonMember& m : *object.object())
    if (std::find(known.begin(), known.end(), m.key) == known.end())
      is_good = fail(document_.where(m.key_at), fmt::format("unknown key {}{}", in_quotes(m.key), suggestion(m.key, known)));
  return is_good;
}

int ValueReader::read_name(const JsonValue& v, const ParameterRules& rules, std::span<const std::string_view> names) {
  if (!v.string()) {
    fail_type(v, rules.name, fmt::format("one of {}", fmt::join(names, ", ")));
    return -1;
  }
  for (size_t i = 0; i < names.size(); ++i)
    if (names[i] == *v.string()) return static_cast<int>(i);
  if (is_reserved(ReservedAs::value, rules.name, *v.string()))
    fail(v, fmt::format("{}: {} is known but not built yet", rules.name, in_quotes(*v.string())));
  else
    fail(v, fmt::format("{}: unknown value {}{}", rules.name, in_quotes(*v.string()), suggestion(*v.string(), names)));
  return -1;
}

} // namespace kelpie
