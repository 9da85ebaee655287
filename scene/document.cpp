#include "scene/document.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/file_bytes.h"

namespace kelpie {

const JsonValue* JsonValue::find(std::string_view key) const {
  if (const Object* members = object())
    for (const JsonMember& m : *members)
      if (m.key == key) return &m.value;
  return nullptr;
}

std::string_view describe(const JsonValue& v) {
  if (const bool* b = v.boolean()) return *b ? "true" : "false";
  if (v.number()) return "a number";
  if (v.string()) return "a string";
  if (v.array()) return "a list";
  if (v.object()) return "an object";
  return "null";
}

std::string in_quotes(std::string_view s) {
  constexpr size_t k_longest = 64;
  size_t shown = std::min(s.size(), k_longest);
  while (shown > 0 && shown < s.size() && (s[shown] & 0xC0) == 0x80) --shown; // not in the middle of a character
  std::string out = "\"";
  for (const char c : s.substr(0, shown)) out += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
  return out + (shown < s.size() ? "…\"" : "\"");
}

namespace {

void append_string(std::string_view s, std::string& out) {
  out += '"';
  for (const char c : s) {
    if (static_cast<unsigned char>(c) < 0x20) {
      fmt::format_to(std::back_inserter(out), "\\u{:04x}", static_cast<int>(c));
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  out += '"';
}

void append_canonical(const JsonValue& v, std::string& out);

/// `append` each of some elements, between brackets.
template <class Elements, class Append>
void append_all(const Elements& elements, char opening, char closing, std::string& out, const Append& append) {
  out += opening;
  for (const auto& e : elements) {
    if (&e != &elements.front()) out += ',';
    append(e);
  }
  out += closing;
}

void append_canonical(const JsonValue& v, std::string& out) {
  if (const bool* flag = v.boolean()) {
    out += *flag ? "true" : "false";
  } else if (const double* n = v.number()) {
    fmt::format_to(std::back_inserter(out), "{}", *n == 0 ? 0.0 : *n); // -0 is 0
  } else if (const std::string* s = v.string()) {
    append_string(*s, out);
  } else if (const JsonValue::Array* elements = v.array()) {
    append_all(*elements, '[', ']', out, [&](const JsonValue& e) { append_canonical(e, out); });
  } else if (const JsonValue::Object* members = v.object()) {
    std::vector<const JsonMember*> sorted;
    for (const JsonMember& m : *members) sorted.push_back(&m);
    std::sort(sorted.begin(), sorted.end(), [](const JsonMember* a, const JsonMember* b) { return a->key < b->key; });
    append_all(sorted, '{', '}', out, [&](const JsonMember* m) {
      append_string(m->key, out), out += ':';
      append_canonical(m->value, out);
    });
  } else {
    out += "null";
  }
}

/// Reads at most one byte more than the limit, so that a pipe that never ends is refused too.
std::string read_at_most(const std::string& path, size_t limit, const std::string& what) {
  return read_file_bytes(path, {what, limit + 1});
}

} // namespace

std::string canonical_text(const JsonValue& v) {
  std::string out;
  append_canonical(v, out);
  return out;
}

SourcePosition Document::where(TextPosition p) const {
  return {sources.at(p.source).name, static_cast<int>(p.line), static_cast<int>(p.column)};
}

Document parse_document(std::string_view text, std::string file, ProblemList& problems, const DocumentLimits& limits) {
  Document document;
  document.sources.push_back({std::move(file)});
  document.root = parse_source(text, 0, document, problems, limits);
  return document;
}

Document read_document(const std::string& path, ProblemList& problems, const DocumentLimits& limits) {
  return parse_document(read_at_most(path, limits.bytes, "the scene"), path, problems, limits);
}

JsonValue read_source(const std::string& path, std::uint32_t source, Document& document, ProblemList& problems,
                      const DocumentLimits& limits) {
  return parse_source(read_at_most(path, limits.bytes - std::min(limits.bytes, document.bytes), "the file"), source, document, problems,
                      limits);
}

} // namespace kelpie
