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
  // Lengths make the text unambiguous without escapes.
  fmt::format_to(std::back_inserter(out), "{}:", s.size());
  out += s;
}

void append_canonical(const JsonValue& v, std::string& out) {
  if (const bool* flag = v.boolean()) {
    out += *flag ? 't' : 'f';
  } else if (const double* n = v.number()) {
    fmt::format_to(std::back_inserter(out), "{},", *n == 0 ? 0.0 : *n); // -0 is 0
  } else if (const std::string* s = v.string()) {
    append_string(*s, out);
  } else if (const JsonValue::Array* elements = v.array()) {
    out += '[';
    for (const JsonValue& e : *elements) append_canonical(e, out);
    out += ']';
  } else if (const JsonValue::Object* members = v.object()) {
    std::vector<const JsonMember*> sorted;
    for (const JsonMember& m : *members) sorted.push_back(&m);
    std::sort(sorted.begin(), sorted.end(), [](const JsonMember* a, const JsonMember* b) { return a->key < b->key; });
    out += '{';
    for (const JsonMember* m : sorted) append_string(m->key, out), append_canonical(m->value, out);
    out += '}';
  } else {
    out += 'n';
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
