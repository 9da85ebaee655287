// The only includer of nlohmann's JSON library for reading: its lexer and grammar, our document.
#include <algorithm>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "scene/document.h"
#include "scene/token_tracker.h"

namespace kelpie {

namespace {

/// Hands out the characters and tells the tracker.
class TrackedIterator {
public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  TrackedIterator(const char* at, TokenTracker* tracker) : at_(at), tracker_(tracker) {}
  reference operator*() const { return *at_; }
  TrackedIterator& operator++() {
    tracker_->consume(static_cast<unsigned char>(*at_++));
    return *this;
  }
  friend bool operator!=(const TrackedIterator& a, const TrackedIterator& b) { return a.at_ != b.at_; }

private:
  const char* at_;
  TokenTracker* tracker_;
};

/// What the lexer complains about, and how we say it.
constexpr std::pair<std::string_view, std::string_view> k_lexer_errors[] = {
    {"missing closing quote", "the string is not closed"},
    {"control character U+000A", "the string is not closed on its line"},
    {"control character U+000D", "the string is not closed on its line"},
    {"control character", "a control character in a string must be escaped"},
    {"forbidden character after backslash", "unknown escape: \\ is followed by one of \" \\ / b f n r t u"},
    {"4 hex digits", "\\u is followed by four hexadecimal digits"},
    {"surrogate", "half a surrogate pair in a string"},
    {"ill-formed UTF-8", "the string is not UTF-8"},
    {"missing closing '*/'", "the comment is not closed"},
    {"invalid comment", "a comment begins with // or /*"},
    {"invalid number", "malformed number"},
    {"number overflow", "the number is too large"},
};

/// What the grammar waits for, by what the parser calls its context.
constexpr std::pair<std::string_view, std::string_view> k_expected[] = {
    {"object key", "a key in double quotes"},
    {"object separator", "':' behind the key"},
    {"object", "',' or '}'"},
    {"array", "',' or ']'"},
    {"value", "a value"},
};

bool contains(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

/// The word between `while parsing ` and ` - `.
std::string_view context_of(std::string_view what) {
  constexpr std::string_view k_before = "while parsing ";
  const size_t from = what.find(k_before), to = what.find(" - ");
  if (from == std::string_view::npos || to == std::string_view::npos) return {};
  return what.substr(from + k_before.size(), to - from - k_before.size());
}

class DocumentBuilder {
public:
  using Json = nlohmann::json;

  DocumentBuilder(Document& document, JsonValue& root, ProblemList& problems, const DocumentLimits& limits, const TokenTracker& tracker)
      : document_(document), root_(root), problems_(problems), limits_(limits), tracker_(tracker) {}

  // The interface of nlohmann's SAX.
  bool null() { return add(nullptr, tracker_.token()); }
  bool boolean(bool v) { return add(v, tracker_.token()); }
  bool number_integer(Json::number_integer_t v) { return add(static_cast<double>(v), tracker_.word()); }
  bool number_unsigned(Json::number_unsigned_t v) { return add(static_cast<double>(v), tracker_.word()); }
  bool number_float(Json::number_float_t v, const std::string&) { return add(v, tracker_.word()); }
  bool string(std::string& v) { return add(std::move(v), tracker_.token()); }
  bool binary(Json::binary_t&) { return false; }
  bool start_array(size_t) { return open(JsonValue::Array{}); }
  bool end_array() { return close(); }
  bool start_object(size_t) { return open(JsonValue::Object{}); }
  bool key(std::string& k) {
    count(tracker_.token());
    std::get<JsonValue::Object>(open_.back()->data).push_back({std::move(k), tracker_.token(), {}});
    return true;
  }
  bool end_object() {
    report_duplicates(std::get<JsonValue::Object>(open_.back()->data));
    return close();
  }
  [[noreturn]] bool parse_error(size_t, const std::string&, const nlohmann::detail::exception& e) { fail(e.what()); }

private:
  template <class T>
  bool add(T data, TextPosition at) {
    place({std::move(data), at});
    return true;
  }

  template <class T>
  bool open(T container) {
    if (open_.size() >= limits_.depth)
      throw error(tracker_.token(), fmt::format("more than {} lists and objects in one another", limits_.depth));
    open_.push_back(place({std::move(container), tracker_.token()}));
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  /// Puts the value where it belongs. Open containers stay where they are: what holds them only grows
  /// once they are closed.
  JsonValue* place(JsonValue v) {
    count(v.at);
    if (open_.empty()) {
      root_ = std::move(v);
      return &root_;
    }
    if (auto* elements = std::get_if<JsonValue::Array>(&open_.back()->data)) return &elements->emplace_back(std::move(v));
    JsonMember& member = std::get<JsonValue::Object>(open_.back()->data).back();
    member.value = std::move(v);
    return &member.value;
  }

  void count(TextPosition at) {
    if (++document_.values > limits_.values) throw error(at, fmt::format("more than {} values", limits_.values));
  }

  void report_duplicates(const JsonValue::Object& members) {
    std::vector<const JsonMember*> sorted;
    for (const JsonMember& m : members) sorted.push_back(&m);
    std::stable_sort(sorted.begin(), sorted.end(), [](const JsonMember* a, const JsonMember* b) { return a->key < b->key; });
    for (size_t i = 1; i < sorted.size(); ++i)
      if (sorted[i]->key == sorted[i - 1]->key)
        problems_.add(document_.where(sorted[i]->key_at),
                      fmt::format("duplicate key {} (also in line {})", in_quotes(sorted[i]->key), sorted[i - 1]->key_at.line));
  }

  Error error(TextPosition at, std::string message) const { return {ExitStatus::bad_data, std::move(message), document_.where(at)}; }

  [[noreturn]] void fail(std::string_view what) const {
    if (contains(what, "invalid literal")) throw error(tracker_.word(), "neither a value nor a key; strings stand in double quotes");
    for (const auto& [theirs, ours] : k_lexer_errors)
      if (contains(what, theirs)) {
        const bool is_inside_token = contains(what, "backslash") || contains(what, "hex") || contains(what, "UTF-8");
        throw error(is_inside_token ? tracker_.last() : contains(what, "number") ? tracker_.word() : tracker_.token(), std::string(ours));
      }
    if (contains(what, "unexpected end of input")) throw error(tracker_.next(), unexpected_end());
    throw error(contains(what, "unexpected number") ? tracker_.word() : tracker_.token(), unexpected(what));
  }

  std::string unexpected_end() const {
    if (open_.empty()) return "the file holds no scene";
    return fmt::format("the text ends where the '{}' of line {} is not closed yet", open_.back()->array() ? '[' : '{',
                       open_.back()->at.line);
  }

  std::string unexpected(std::string_view what) const {
    if (contains(what, "expected end of input")) return "text behind the end of the scene";
    if (tracker_.is_closing_behind_comma()) return "a comma before the closing bracket";
    const std::string_view context = context_of(what);
    for (const auto& [theirs, ours] : k_expected)
      if (context == theirs) return fmt::format("expected {}", ours);
    return "malformed JSON";
  }

  Document& document_;
  JsonValue& root_;
  ProblemList& problems_;
  const DocumentLimits& limits_;
  const TokenTracker& tracker_;
  std::vector<JsonValue*> open_;
};

} // namespace

JsonValue parse_source(std::string_view text, std::uint32_t source, Document& document, ProblemList& problems,
                       const DocumentLimits& limits) {
  const auto fail = [&](const char* message) { return Error(ExitStatus::bad_data, message, {document.sources.at(source).name}); };
  document.bytes += text.size();
  if (document.bytes > limits.bytes) throw fail("the file is too large for a scene");
  // The lexer takes a zero byte for the end of the text, whatever follows.
  if (text.find('\0') != std::string_view::npos) throw fail("the file holds zero bytes: it is no text");
  constexpr std::string_view k_utf8_bom = "\xEF\xBB\xBF";
  if (text.substr(0, k_utf8_bom.size()) == k_utf8_bom) text.remove_prefix(k_utf8_bom.size());

  JsonValue root;
  TokenTracker tracker(source);
  DocumentBuilder builder(document, root, problems, limits, tracker);
  const TrackedIterator begin(text.data(), &tracker), end(text.data() + text.size(), &tracker);
  nlohmann::json::sax_parse(begin, end, &builder, nlohmann::json::input_format_t::json, /*strict*/ true, /*ignore_comments*/ true);
  return root;
}

} // namespace kelpie
