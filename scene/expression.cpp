#include "scene/expression.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>

#include <fmt/format.h>
#include <muParser.h>

#include "base/error.h"
#include "base/suggest.h"
#include "materials/patterns/noise.h"
#include "scene/document.h"

namespace kelpie {

namespace {

constexpr std::string_view k_frame = "frame";
constexpr size_t k_most_characters = 2000;

double mod(double a, double b) { return a - b * std::floor(a / b); }
double fract(double v) { return v - std::floor(v); }
double clamp(double v, double low, double high) { return std::min(std::max(v, low), high); }
double mix(double a, double b, double t) { return (1 - t) * a + t * b; }
double smoothstep(double from, double to, double v) {
  const double t = clamp((v - from) / (to - from), 0, 1);
  return t * t * (3 - 2 * t);
}
/// Smooth and random: a line through gradient noise, which is at least half as rough across as along the axes.
double noise(double v) { return double(gradient_noise(Vec3(float(v), 0.37f, 0.61f), 0x6b656c70).value); }

} // namespace

/// muParser's own functions, and ours.
struct FormulaParser : mu::Parser {
  FormulaParser() {
    DefineFun("floor", static_cast<double (*)(double)>(std::floor));
    DefineFun("ceil", static_cast<double (*)(double)>(std::ceil));
    DefineFun("fract", fract);
    DefineFun("mod", mod);
    DefineFun("round", static_cast<double (*)(double)>(std::round));
    DefineFun("pow", static_cast<double (*)(double, double)>(std::pow));
    DefineFun("clamp", static_cast<double (*)(double, double, double)>(clamp));
    DefineFun("mix", mix);
    DefineFun("smoothstep", smoothstep);
    DefineFun("noise", noise);
    DefineConst("pi", std::numbers::pi);
  }

  std::vector<std::string> functions() const {
    std::vector<std::string> names;
    for (const auto& [name, function] : GetFunDef()) names.push_back(name);
    return names;
  }
};

namespace {

/// muParser would read "frame = 3" as an order.
bool assigns(std::string_view text) {
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    const bool doubled = i + 1 < text.size() && text[i + 1] == '=';
    const bool compares = i > 0 && std::string_view("<>!").find(text[i - 1]) != std::string_view::npos;
    if (doubled) ++i;
    if (!doubled && !compares) return true;
  }
  return false;
}

/// The name that ends where a parenthesis was not expected: what was meant to be a function.
std::string_view name_before(std::string_view text, int end) {
  size_t begin = size_t(std::clamp(end, 0, int(text.size())));
  const size_t behind = begin;
  while (begin > 0 && (std::isalnum(static_cast<unsigned char>(text[begin - 1])) || text[begin - 1] == '_')) --begin;
  return text.substr(begin, behind - begin);
}

std::string explained(const mu::ParserError& e, std::string_view text, const FormulaParser& parser) {
  if (const std::string_view name = name_before(text, e.GetPos()); e.GetToken() == "(" && !name.empty()) {
    const std::vector<std::string> functions = parser.functions();
    const std::vector<std::string_view> known(functions.begin(), functions.end());
    return fmt::format("unknown function {}{}", in_quotes(name), suggestion(name, known));
  }
  switch (e.GetCode()) {
  case mu::ecUNEXPECTED_EOF: return "it ends too early";
  case mu::ecMISSING_PARENS: return "a ')' is missing";
  case mu::ecTOO_MANY_PARAMS:
  case mu::ecTOO_FEW_PARAMS:
    return fmt::format("{}() takes {} values", e.GetToken(), e.GetCode() == mu::ecTOO_FEW_PARAMS ? "more" : "fewer");
  case mu::ecMISSING_ELSE_CLAUSE: return "a '?' without its ':'";
  default:
    if (e.GetToken().empty() || e.GetPos() < 0) return e.GetMsg();
    return fmt::format("{} is not expected at character {}", in_quotes(e.GetToken()), e.GetPos() + 1);
  }
}

[[noreturn]] void fail(const std::string& what) { throw Error(ExitStatus::bad_data, "expression: " + what); }

} // namespace

struct Expression::Formula {
  mutable std::mutex mutex; ///< a parser has one set of variables
  FormulaParser parser;
  std::map<std::string, double> slots;
};

Expression::Expression(const std::string& text) : text_(text), formula_(std::make_unique<Formula>()) {
  if (text.find_first_not_of(" \t\n") == std::string::npos) fail("it is empty");
  if (text.size() > k_most_characters) fail(fmt::format("more than {} characters", k_most_characters));
  if (assigns(text)) fail("'=' is not expected: two values are compared by '=='");
  FormulaParser& parser = formula_->parser;
  try {
    parser.SetExpr(text);
    formula_->slots.try_emplace(std::string(k_frame), 0);
    for (const auto& [name, unused] : parser.GetUsedVar()) formula_->slots.try_emplace(name, 0);
    for (auto& [name, slot] : formula_->slots) parser.DefineVar(name, &slot);
    parser.Eval();
    if (parser.GetNumResults() != 1) fail(fmt::format("expected one value, found {}", parser.GetNumResults()));
  } catch (const mu::ParserError& e) {
    fail(explained(e, text, parser));
  }
}

Expression::Expression(Expression&&) noexcept = default;
Expression::~Expression() = default;

std::vector<std::string> Expression::names() const {
  std::vector<std::string> names;
  for (const auto& [name, slot] : formula_->slots)
    if (name != k_frame) names.push_back(name);
  return names;
}

void Expression::bind(const std::string& name, Animated<float> value) { values_.insert_or_assign(name, std::move(value)); }

bool Expression::is_constant() const {
  const auto& used = formula_->parser.GetUsedVar();
  return !used.count(std::string(k_frame)) &&
         std::all_of(values_.begin(), values_.end(), [](const auto& value) { return value.second.is_constant(); });
}

double Expression::at(double frame) const {
  std::vector<double> values; // in the order of the slots, which is that of values_, but for the frame
  for (const auto& [name, value] : values_) values.push_back(double(value.at(frame)));
  const std::lock_guard lock(formula_->mutex);
  auto next = values.begin();
  for (auto& [name, slot] : formula_->slots) slot = name == k_frame ? frame : *next++;
  return formula_->parser.Eval();
}

std::string problem_of_variable_name(std::string_view name) {
  const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; };
  const auto is_part = [&](char c) { return is_letter(c) || std::isdigit(static_cast<unsigned char>(c)); };
  if (name.empty() || !is_letter(name[0]) || !std::all_of(name.begin(), name.end(), is_part))
    return "is no name for a variable: letters, digits and '_' make one";
  if (name == k_frame) return "is the frame, in every expression";
  const FormulaParser parser;
  const std::string key(name);
  return parser.GetFunDef().count(key) || parser.GetConst().count(key) ? "is known to expressions already" : "";
}

} // namespace kelpie
