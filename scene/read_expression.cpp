// Values that follow a formula: {"expression": …}, and vectors and colours with such components.
#include <algorithm>
#include <cmath>

#include "scene/formula.h"
#include "scene/value_reader.h"

namespace kelpie {

namespace {
constexpr std::array<std::string_view, 1> k_keys{"expression"};
constexpr ParameterRules k_variable{"variables", {}};
/// Variables that are made of variables that are …
constexpr size_t k_most_deep = 64;
/// What one value may ask for, of all its variables and theirs.
constexpr double k_most_values = 2000;
constexpr size_t k_most_variables = 10'000;
} // namespace

std::vector<double> ValueReader::frames_to_check() const {
  constexpr int k_most = 100;
  const auto frame_of = [&](std::string_view key) {
    const JsonValue* frames = document_.root.find("frames");
    const JsonValue* v = frames ? frames->find(key) : nullptr;
    return v && v->number() ? std::clamp(*v->number(), -1e9, 1e9) : 1.0;
  };
  const double first = frame_of("first"), length = std::max(frame_of("last") - first, 0.0);
  const int steps = std::clamp(static_cast<int>(2 * std::min(length, double(k_most))), 1, k_most);
  std::vector<double> frames(size_t(steps) + 1);
  for (int i = 0; i <= steps; ++i) frames[size_t(i)] = first + length * i / steps;
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

template <class T>
bool ValueReader::use_checked(Animated<T>& out, std::shared_ptr<const TimeFunction<T>> function, std::string_view what, const JsonValue& v,
                              const ParameterRules& rules) {
  const auto checked = std::make_shared<Checked<T>>(std::move(function), rules, where(v), what);
  std::vector<double> frames = checked->frames();
  if (frames.empty()) frames.push_back(0); // it is the same at all of them
  try {
    for (const double frame : frames) checked->at(frame);
  } catch (const Error& e) {
    problems_.add(e, where(v));
    return false;
  }
  out = Animated<T>(std::shared_ptr<const TimeFunction<T>>(checked));
  return true;
}
template bool ValueReader::use_checked(Animated<float>&, std::shared_ptr<const TimeFunction<float>>, std::string_view, const JsonValue&,
                                       const ParameterRules&);
template bool ValueReader::use_checked(Animated<Vec3>&, std::shared_ptr<const TimeFunction<Vec3>>, std::string_view, const JsonValue&,
                                       const ParameterRules&);
template bool ValueReader::use_checked(Animated<Colour>&, std::shared_ptr<const TimeFunction<Colour>>, std::string_view, const JsonValue&,
                                       const ParameterRules&);

/// "a -> b -> a": from the variable of that name, which is being read, to the one that asks for it again.
std::string ValueReader::chain_of_variables(const std::string& name) const {
  std::string chain;
  for (auto i = std::find(variables_being_read_.begin(), variables_being_read_.end(), name); i != variables_being_read_.end(); ++i)
    chain += *i + " -> ";
  return chain + name;
}

const Animated<float>* ValueReader::variable(const std::string& name, const JsonValue& v) {
  const auto [at, is_new] = variables_.try_emplace(&v);
  Variable& variable = at->second; // stays where it is, whatever else is read meanwhile
  if (!is_new) {
    if (variable.is_being_read) fail(v, fmt::format("variable {} depends on itself: {}", in_quotes(name), chain_of_variables(name)));
    return variable.is_good ? &variable.value : nullptr;
  }
  variables_being_read_.push_back(name);
  cost_ = 1;
  if (const std::string problem = problem_of_variable_name(name); !problem.empty())
    fail(v, fmt::format("{} {}", in_quotes(name), problem));
  else if (variables_being_read_.size() > k_most_deep)
    fail(v, fmt::format("more than {} variables that depend on one another", k_most_deep));
  else
    variable.is_good = read(variable.value, v, k_variable);
  variable.is_being_read = false, variable.cost = cost_;
  variables_being_read_.pop_back();
  return variable.is_good ? &variable.value : nullptr;
}

/// The one that an expression names; null where it cannot be used, which has been reported.
const ValueReader::Variable* ValueReader::named_variable(const std::string& name, const JsonValue& expression) {
  std::vector<std::string_view> known{"frame", "pi"};
  const JsonValue* variables = document_.root.find("variables");
  if (variables && variables->object() && variables->object()->size() > k_most_variables) {
    fail(expression, fmt::format("expression: more than {} variables", k_most_variables));
    return nullptr;
  }
  if (variables && variables->object())
    for (const JsonMember& m : *variables->object()) {
      if (m.key == name) {
        const bool is_good = variable(name, m.value);
        Variable& found = variables_.at(&m.value);
        found.is_used = true;
        return is_good ? &found : nullptr;
      }
      known.push_back(m.key);
    }
  if (document_.is_complete) fail(expression, fmt::format("expression: unknown name {}{}", in_quotes(name), suggestion(name, known)));
  return nullptr;
}

void ValueReader::warn_of_unused_variables(Diagnostics& diagnostics) const {
  const JsonValue* variables = document_.root.find("variables");
  if (!variables || !variables->object()) return;
  std::vector<std::string_view> others;
  for (const JsonMember& m : *variables->object())
    if (const auto found = variables_.find(&m.value); found != variables_.end() && found->second.is_used) others.push_back(m.key);
  for (const JsonMember& m : *variables->object()) {
    const auto found = variables_.find(&m.value);
    if (!document_.sources.at(m.key_at.source).is_command_line || (found != variables_.end() && found->second.is_used)) continue;
    const std::string hint = others.empty() ? ", nor any other" : suggestion(m.key, others);
    diagnostics.warning(document_.where(m.key_at), fmt::format("no expression uses the variable {}{}", in_quotes(m.key), hint));
  }
}

bool ValueReader::read_formula(Animated<float>& out, const JsonValue& v, const ParameterRules& rules) {
  const JsonValue& text = *v.find("expression");
  if (!text.string()) return fail_type(text, "expression", "a string");
  try {
    Expression expression(*text.string());
    bool is_good = true;
    double cost = 1;
    for (const std::string& name : expression.names()) {
      const Variable* variable = named_variable(name, text);
      is_good &= variable != nullptr;
      if (!variable) continue;
      expression.bind(name, variable->value);
      if (!variable->value.is_constant()) cost += variable->cost;
    }
    if (!is_good) return false;
    if (cost > k_most_values)
      return fail(text, fmt::format("expression: it asks for more than {} values, by its variables", k_most_values));
    cost_ = cost;
    const bool is_constant = expression.is_constant();
    const auto formula = std::make_shared<Formula>(std::move(expression), frames_to_check());
    if (!use_checked<float>(out, formula, "expression", text, rules)) return false;
    if (is_constant) out = Animated<float>(out.at(0));
    return true;
  } catch (const Error& e) {
    problems_.add(e, where(text));
    return false;
  }
}

template <class T>
bool ValueReader::read_expression(Animated<T>& out, const JsonValue& v, const ParameterRules& rules) {
  const bool is_good = check_only(v, k_keys);
  if constexpr (std::is_same_v<T, float>) {
    return read_formula(out, v, rules) && is_good;
  } else {
    if (!rules.is_number_for_all) return fail(v, fmt::format("{}: an expression is one number; give one for each component", rules.name));
    Animated<float> all;
    if (!read_formula(all, v, rules) || !is_good) return false;
    out = all.is_constant() ? Animated<T>(T{Vec3(all.at(0))})
                            : Animated<T>(std::make_shared<Components<T>>(std::array<Animated<float>, 3>{all, all, all}));
    return true;
  }
}

template <class T>
bool ValueReader::read_components(Animated<T>& out, const JsonValue& v, const ParameterRules& rules) {
  const JsonValue::Array& list = *v.array();
  if (list.size() != 3) return fail(v, fmt::format("{}: expected three components, found {}", rules.name, count_of_values(list.size())));
  ParameterRules of_component{rules.name, {}};
  of_component.range = rules.range;
  std::array<Animated<float>, 3> parts;
  bool is_good = true;
  for (size_t i = 0; i < 3; ++i) is_good &= read(parts[i], list[i], of_component);
  if (!is_good) return false;
  const bool is_constant = std::all_of(parts.begin(), parts.end(), [](const auto& part) { return part.is_constant(); });
  if (!use_checked<T>(out, std::make_shared<Components<T>>(std::move(parts)), "vector", v, rules)) return false;
  if (is_constant) out = Animated<T>(out.at(0));
  return true;
}

template bool ValueReader::read_expression(Animated<float>&, const JsonValue&, const ParameterRules&);
template bool ValueReader::read_expression(Animated<Vec3>&, const JsonValue&, const ParameterRules&);
template bool ValueReader::read_expression(Animated<Colour>&, const JsonValue&, const ParameterRules&);
template bool ValueReader::read_components(Animated<Vec3>&, const JsonValue&, const ParameterRules&);
template bool ValueReader::read_components(Animated<Colour>&, const JsonValue&, const ParameterRules&);

} // namespace kelpie
