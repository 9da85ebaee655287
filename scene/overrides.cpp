#include "scene/overrides.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "base/suggest.h"

namespace kelpie {

namespace {

void set_source(JsonValue& v, TextPosition at) {
  v.at = at;
  if (auto* elements = std::get_if<JsonValue::Array>(&v.data))
    for (JsonValue& e : *elements) set_source(e, at);
  if (auto* members = std::get_if<JsonValue::Object>(&v.data))
    for (JsonMember& m : *members) m.key_at = at, set_source(m.value, at);
}

std::vector<std::string> split(std::string_view path) {
  std::vector<std::string> steps;
  for (size_t from = 0;;) {
    const size_t dot = path.find('.', from);
    steps.emplace_back(path.substr(from, dot - from));
    if (dot == std::string_view::npos) return steps;
    from = dot + 1;
  }
}

std::optional<size_t> index_of(std::string_view step) {
  size_t i = 0;
  const auto [end, error] = std::from_chars(step.data(), step.data() + step.size(), i);
  if (error != std::errc() || end != step.data() + step.size()) return {};
  return i;
}

/// One assignment on its way through the document.
class Override {
public:
  Override(Document& document, TextPosition at, ProblemList& problems) : document_(document), at_(at), problems_(problems) {}

  void apply(std::string_view assignment) {
    const size_t equals = assignment.find('=');
    if (equals == 0 || equals == std::string_view::npos) return fail("expected path=value, such as shapes.drop.threshold=1.1");
    const std::string_view path = assignment.substr(0, equals);
    JsonValue* const target = find(path);
    if (!target) return;
    const size_t depth = size_t(std::count(path.begin(), path.end(), '.')) + 1;
    if (std::optional<JsonValue> value = parse(assignment.substr(equals + 1), DocumentLimits{}.depth - depth)) *target = std::move(*value);
  }

  void apply(std::string_view path, JsonValue value) {
    if (JsonValue* const target = find(path)) *target = std::move(value);
  }

private:
  /// Null after a problem.
  JsonValue* find(std::string_view path) {
    const std::vector<std::string> steps = split(path);
    if (steps.size() >= DocumentLimits{}.depth) {
      fail("the path is too long");
      return nullptr;
    }
    JsonValue* target = &document_.root;
    for (const std::string& step : steps) {
      target = descend(*target, step);
      if (!target) return nullptr;
      walked_ += walked_.empty() ? step : "." + step;
    }
    return target;
  }

  void fail(std::string message) { problems_.add(document_.where(at_), std::move(message)); }

  JsonValue* descend(JsonValue& parent, const std::string& step) {
    if (auto* members = std::get_if<JsonValue::Object>(&parent.data)) return &member(*members, step);
    if (auto* elements = std::get_if<JsonValue::Array>(&parent.data)) return element(*elements, step);
    fail(fmt::format("{} is {}: it has no \"{}\"", walked_, describe(parent), step));
    return nullptr;
  }

  JsonValue& member(JsonValue::Object& members, const std::string& key) {
    for (JsonMember& m : members)
      if (m.key == key) return m.value;
    // A new key, with its children: an empty object that is replaced if this is the last step.
    return members.emplace_back(JsonMember{key, at_, {JsonValue::Object{}, at_}}).value;
  }

  JsonValue* element(JsonValue::Array& elements, const std::string& step) {
    std::vector<std::string_view> names;
    for (JsonValue& e : elements) {
      const JsonValue* name = e.find("name");
      if (!name || !name->string()) continue;
      if (*name->string() == step) return &e;
      names.push_back(*name->string());
    }
    const std::optional<size_t> i = index_of(step);
    if (i && *i < elements.size()) return &elements[*i];
    if (i || names.empty())
      fail(fmt::format("{} has no element {}: there are {}, counted from 0", walked_, step, elements.size()));
    else
      fail(fmt::format("{} has no element \"{}\"{}", walked_, step, suggestion(step, names)));
    return nullptr;
  }

  std::optional<JsonValue> parse(std::string_view text, size_t depth) {
    DocumentLimits limits;
    limits.depth = depth;
    JsonValue value{std::string(text), {}};
    try {
      ProblemList duplicates;
      value = parse_document(text, {}, duplicates, limits).root;
      duplicates.throw_if_any();
    } catch (const Error& e) {
      // Words need no quotes; what begins like JSON was meant as JSON.
      if (!text.empty() && std::string_view("[{\"").find(text[0]) != std::string_view::npos) {
        fail(e.problems[0].message);
        return {};
      }
    }
    set_source(value, at_);
    return value;
  }

  Document& document_;
  TextPosition at_;
  ProblemList& problems_;
  std::string walked_;
};

} // namespace

void apply_overrides(Document& document, const std::vector<std::string>& assignments, ProblemList& problems) {
  for (const std::string& assignment : assignments) {
    const auto source = static_cast<std::uint32_t>(document.sources.size());
    document.sources.push_back({"--set " + assignment, {}, true});
    Override(document, {0, 0, source}, problems).apply(assignment);
  }
}

void apply_override(Document& document, std::string_view path, JsonValue value, TextPosition at, ProblemList& problems) {
  Override(document, at, problems).apply(path, std::move(value));
}

} // namespace kelpie
